"""Time of our regressor kernel against Pinocchio's in C++, in the same run.

    pip install pin==4.1.0 cmeel-eigen
    python aurt-lab/peers/pinocchio_regressor.py [--rounds 9] [--compiler g++]

Builds `pinocchio_regressor.cpp` against the headers that PyPI's `pin` carries (-O3 -march=native) and the
kernel's benchmark (`cargo bench`), runs them by turns, and prints per robot, instruction set and case the ratio
Pinocchio / ours: the median of the rounds and, in brackets, the smallest and largest. Each figure of a round is
the fastest of several hundred short repetitions, so that a busy machine disturbs both sides little.
"""

import argparse
import collections
import pathlib
import statistics
import subprocess
import sys
import tempfile

import pinocchio

from machine import build_ours, processor
from robots import ROBOTS

HERE = pathlib.Path(__file__).resolve().parent


def build_peer(compiler, folder, name="pinocchio_regressor"):
    """The C++ program, built against the headers of the installed `pin`."""
    include = next(p / "include" for p in pathlib.Path(pinocchio.__file__).parents if p.name == "cmeel.prefix")
    if not (include / "eigen3").is_dir():
        sys.exit("Eigen's headers are missing: pip install cmeel-eigen")
    program = pathlib.Path(folder) / name
    flags = ["-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-w"]
    # Pinocchio's list of joint types is longer than Boost's defaults; these are the values of its own CMake files.
    flags += ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30"]
    flags += ["-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_FUSION_INVOKE_MAX_ARITY=12"]
    source = HERE / f"{name}.cpp"
    command = [compiler, *flags, "-isystem", include, "-isystem", include / "eigen3", source, "-o", program]
    subprocess.run([str(part) for part in command], check=True)
    return program


def compare(rounds, compiler):
    """Prints the ratios of some rounds."""
    theirs = collections.defaultdict(list)
    ratios = collections.defaultdict(list)
    times = collections.defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        peer, ours = build_peer(compiler, folder), build_ours("aurt-rbd", "regressor")
        for _ in range(rounds):
            for robot, joints in ROBOTS.items():
                numbers = [str(value) for joint in joints for value in joint]
                output = subprocess.run(
                    [peer, str(len(joints)), *numbers, "400"], check=True, stdout=subprocess.PIPE, text=True
                ).stdout
                theirs[robot].append(float(output))
            lines = subprocess.run([ours, "--bench", "--tsv"], check=True, stdout=subprocess.PIPE, text=True).stdout
            for line in lines.splitlines():
                robot, level, case, nanoseconds = line.split("\t")
                times[robot, level, case].append(float(nanoseconds))
                ratios[robot, level, case].append(theirs[robot][-1] / float(nanoseconds))
    version = subprocess.run([compiler, "--version"], stdout=subprocess.PIPE, text=True).stdout
    print(f"regressor: Pinocchio {pinocchio.__version__}, {version.splitlines()[0]}, -O3 -march=native")
    print(f"{rounds} rounds by turns, one core; ns per evaluation, ratio with [smallest, largest]")
    for robot, values in theirs.items():
        print(f"{robot:6} Pinocchio                {statistics.median(values):8.1f}")
        for (of, level, case), ratio in ratios.items():
            if of == robot:
                ns = statistics.median(times[of, level, case])
                spread = f"[{min(ratio):.1f}, {max(ratio):.1f}]"
                print(f"{robot:6} {level:9} {case:14} {ns:8.1f} {statistics.median(ratio):6.1f} x {spread}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--compiler", default="g++")
    arguments = parser.parse_args()
    print(f"processor: {processor()}")
    compare(arguments.rounds, arguments.compiler)


if __name__ == "__main__":
    main()
