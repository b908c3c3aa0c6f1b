"""Time of inverse dynamics, forward dynamics and the mass matrix, sample by sample, against Pinocchio's in C++, in one run.

    pip install pin==4.1.0 cmeel-eigen
    python aurt-lab/peers/dynamics.py [--rounds 9] [--compiler g++]

A UR10e whose six links have the same body. Prints the ratio Pinocchio / ours: the median of the rounds and, in brackets, the
smallest and largest. What both compute is compared first.
"""

import argparse
import statistics
import subprocess
import tempfile

import pinocchio

from machine import build_ours, processor
from pinocchio_regressor import build_peer
from robots import ROBOTS

ALGORITHMS = {"inverse dynamics": "rnea", "forward dynamics": "aba", "mass matrix": "crba"}


def compare(rounds, compiler):
    """Prints the ratios of some rounds."""
    joints = ROBOTS["ur10e"]
    numbers = [str(value) for joint in joints for value in joint]
    times = {name: ([], []) for name in ALGORITHMS}
    with tempfile.TemporaryDirectory() as folder:
        peer, ours = build_peer(compiler, folder, "pinocchio_dynamics"), build_ours("aurt-rbd", "dynamics")
        for _ in range(rounds):
            command = [peer, str(len(joints)), *numbers, "2000"]
            output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.split()
            lines = subprocess.run([ours, "--bench", "--tsv"], check=True, stdout=subprocess.PIPE, text=True).stdout
            rows = [line.split("\t") for line in lines.splitlines()]
            own = {row[0]: [float(v) for v in row[1:]] for row in rows}
            results = [float(value) for value in output[len(ALGORITHMS):]]
            for column, name in enumerate(ALGORITHMS):
                for a, b in zip(own[name][1:], results[column :: len(ALGORITHMS)], strict=True):
                    assert abs(a - b) <= 1e-9 * max(1.0, abs(a)), (name, a, b)
                times[name][0].append(float(output[column]))
                times[name][1].append(own[name][0])
    print(f"dynamics of the UR10e: Pinocchio {pinocchio.__version__}, {compiler} -O3 -march=native; {rounds} rounds by turns, one core")
    for name, (theirs, own) in times.items():
        ratios = [a / b for a, b in zip(theirs, own)]
        print(
            f"{name:17} Pinocchio {statistics.median(theirs):7.0f} ns, ours {statistics.median(own):7.0f} ns, "
            f"{statistics.median(ratios):.1f} [{min(ratios):.1f}, {max(ratios):.1f}]"
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--compiler", default="g++")
    arguments = parser.parse_args()
    print(f"processor: {processor()}")
    compare(arguments.rounds, arguments.compiler)


if __name__ == "__main__":
    main()
