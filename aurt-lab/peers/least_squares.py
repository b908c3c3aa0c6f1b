"""Processor time of least squares on a tall matrix against LAPACK's dgels, in the same run.

    pip install scipy
    python aurt-lab/peers/least_squares.py [--rounds 7] [--rows 300000] [--columns 70]

Builds our benchmark (`cargo bench`), and lets it and SciPy's dgels (OpenBLAS, one thread) solve the same problem by
turns. Prints per instruction set the ratio LAPACK / ours, the median of the rounds with [smallest, largest], and the
largest difference of the solutions as a share of the largest coefficient. What counts is the time that the processor
spent on either side; making the matrix does not count, and dgels overwrites a copy that was made before.
"""

import argparse
import collections
import os
import statistics
import subprocess
import time

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy  # noqa: E402
import scipy  # noqa: E402
from scipy.linalg import lapack  # noqa: E402

from machine import build_ours, processor  # noqa: E402


def problem(rows, columns):
    """The matrix and right-hand side of the benchmark `least_squares`."""
    places = numpy.arange(rows) + 1.0
    matrix = numpy.empty((rows, columns + 1), order="F")
    for k in range(columns + 1):
        matrix[:, k] = (places * (0.7548776662466927 + 0.0131 * k)) % 1.0 - 0.5
    return matrix[:, :columns], matrix[:, columns]


def dgels(matrix, right):
    """Seconds of processor time, and the solution."""
    a, b = matrix.copy(order="F"), right.copy()
    start = time.process_time()
    _, solution, info = lapack.dgels(a, b, overwrite_a=1, overwrite_b=1)
    seconds = time.process_time() - start
    assert info == 0
    return seconds, solution[: matrix.shape[1]]


def compare(rounds, rows, columns):
    """Prints the ratios of some rounds."""
    ours = build_ours("aurt-calibration", "least_squares")
    matrix, right = problem(rows, columns)
    theirs, times, ratios, errors = [], collections.defaultdict(list), collections.defaultdict(list), {}
    for _ in range(rounds):
        seconds, expected = dgels(matrix, right)
        theirs.append(1e3 * seconds)
        command = [ours, "--tsv", "--rounds", "1", "--rows", str(rows), "--columns", str(columns)]
        output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
        for line in output.splitlines():
            level, milliseconds, _, _, solution = line.split("\t")
            solution = numpy.array([float(x) for x in solution.split()])
            times[level].append(float(milliseconds))
            ratios[level].append(theirs[-1] / float(milliseconds))
            error = numpy.abs(solution - expected).max() / numpy.abs(expected).max()
            errors[level] = max(error, errors.get(level, 0.0))
    print(f"least squares {rows} x {columns}: dgels of SciPy {scipy.__version__}, one thread, {rounds} rounds by turns")
    print(f"LAPACK    {statistics.median(theirs):8.1f} ms [{min(theirs):.1f}, {max(theirs):.1f}]")
    for level, ratio in ratios.items():
        spread = f"[{min(ratio):.1f}, {max(ratio):.1f}]"
        print(
            f"{level:9} {statistics.median(times[level]):8.1f} ms {statistics.median(ratio):6.1f} x {spread}"
            f"  difference {errors[level]:.1e}"
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--rows", type=int, default=300_000)
    parser.add_argument("--columns", type=int, default=70)
    arguments = parser.parse_args()
    print(f"processor: {processor()}")
    compare(arguments.rounds, arguments.rows, arguments.columns)


if __name__ == "__main__":
    main()
