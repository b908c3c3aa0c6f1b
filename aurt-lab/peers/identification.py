"""Processor time of an identification end to end against figaroh, in the same run.

    pip install figaroh pin==4.1.0
    python aurt-lab/peers/identification.py [--rounds 3] [--samples 29000]

Both sides filter the positions of six joints over 58 s at 500 Hz, evaluate the regressor of rigid bodies and friction at
every sample, filter and decimate it by ten in parallel with the measurement, find base parameters and solve; figaroh by
its own `RegressorBuilder` (viscous and Coulomb friction), `eliminate_non_dynaffect` and `QRDecomposer`, with SciPy's
filters that it uses itself; ours by the benchmark `identification` (friction of the paper: nine columns a joint, and WLS;
base parameters are the model's and known). Ratios figaroh / ours, median with [smallest, largest]. The original AURT's times,
as measured once for docs/real-recordings.md, are put beside them; the original is not run here.
"""

import argparse
import os
import statistics
import subprocess
import time

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy  # noqa: E402
import pinocchio  # noqa: E402
from figaroh.tools.qrdecomposition import QRDecomposer  # noqa: E402
from figaroh.tools.regressor import RegressorBuilder, RegressorConfig, eliminate_non_dynaffect  # noqa: E402
from scipy import signal  # noqa: E402

from machine import build_ours, processor  # noqa: E402
from robots import ROBOTS, build_model  # noqa: E402

RATE_HZ = 500.0
DECIMATION = 10
# The original: compile-rbd for six joints, and a first calibration, in seconds (docs/real-recordings.md).
ORIGINAL_COMPILE_S = 800.0
ORIGINAL_CALIBRATE_S = (126.0, 317.0)
STAGE = "from parsed arrays, τ_J literal"


class Robot:
    """What figaroh's builder asks of a robot."""

    def __init__(self, model):
        self.model = model
        self.data = model.createData()


def recording(joints, samples):
    """Positions and torques of some motion."""
    t = numpy.arange(samples) / RATE_HZ
    q = numpy.zeros((samples, joints))
    tau = numpy.zeros((samples, joints))
    for j in range(joints):
        for k in range(4):
            omega = 2 * numpy.pi * (0.07 + 0.19 * k + 0.013 * j)
            q[:, j] += 0.5 / (k + 1) * numpy.sin(omega * t + j + 1.7 * k)
            tau[:, j] += 5 * numpy.cos(omega * t + j + 1.7 * k)
    return q, tau


def figaroh(robot, q, tau):
    """Seconds of processor time of one identification."""
    start = time.process_time()
    filtered = signal.sosfiltfilt(signal.butter(4, 50.0, fs=RATE_HZ, output="sos"), q, axis=0)
    velocity = numpy.gradient(filtered, 1 / RATE_HZ, axis=0)
    acceleration = numpy.gradient(velocity, 1 / RATE_HZ, axis=0)
    builder = RegressorBuilder(robot, RegressorConfig(has_friction=True))
    actuated = {"act_idxv": list(range(q.shape[1]))}
    matrix = builder.build_basic_regressor(filtered, velocity, acceleration, actuated)
    names = {str(k): 0.0 for k in range(matrix.shape[1])}
    matrix, kept = eliminate_non_dynaffect(matrix, names, tol_e=1e-3)
    joints, samples = q.shape[1], q.shape[0]
    rows = [
        numpy.column_stack(
            [signal.decimate(column, DECIMATION, zero_phase=True) for column in matrix[j * samples : (j + 1) * samples].T]
        )
        for j in range(joints)
    ]
    right = numpy.concatenate([signal.decimate(tau[:, j], DECIMATION, zero_phase=True) for j in range(joints)])
    QRDecomposer().double_decomposition(right, numpy.vstack(rows), kept)
    return time.process_time() - start


def compare(rounds, samples=29_000):
    """Prints the ratios of some rounds."""
    ours = build_ours("aurt-calibration", "identification")
    robot = Robot(build_model(ROBOTS["ur10e"]))
    q, tau = recording(6, samples)
    theirs, times, ratios = [], [], []
    for _ in range(rounds):
        theirs.append(1e3 * figaroh(robot, q, tau))
        command = [ours, "--tsv", "--rounds", "3", "--samples", str(samples)]
        lines = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
        times.append(next(float(line.split("\t")[1]) for line in lines if line.startswith(STAGE)))
        ratios.append(theirs[-1] / times[-1])
    own = statistics.median(times)
    print(f"identification, 6 joints, {samples} samples, from arrays, one thread, {rounds} rounds by turns")
    print(f"figaroh   {statistics.median(theirs):8.1f} ms [{min(theirs):.1f}, {max(theirs):.1f}]")
    spread = f"[{min(ratios):.0f}, {max(ratios):.0f}]"
    print(f"ours      {own:8.1f} ms {statistics.median(ratios):6.0f} x {spread}")
    low, high = ORIGINAL_CALIBRATE_S
    print(
        f"original AURT, not in this run: compile-rbd {ORIGINAL_COMPILE_S:.0f} s, first calibration {low:.0f} to {high:.0f} s:"
        f" {1e3 * low / own:.0f} to {1e3 * high / own:.0f} x without its compilation"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--samples", type=int, default=29_000)
    arguments = parser.parse_args()
    print(f"processor: {processor()}")
    compare(arguments.rounds, arguments.samples)


if __name__ == "__main__":
    main()
