"""How time and memory grow with samples and joints.

    python aurt-lab/scaling.py [--samples 100000 1000000 10000000] [--joints 2 4 6] [--skip-long]

Runs the benchmarks `long` (recordings longer than memory, from the file; each size in a process of its own) and
`identification` (in memory). Prints the exponent by which processor time grows from one size to the next: 1 is linear.
Ten million samples of six joints are a table of 1.1 GB, and as much again in the folder for temporary files.
"""

import argparse
import math
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))

from machine import build_ours, processor  # noqa: E402


def run(program, *options):
    """What a benchmark prints."""
    return subprocess.run([program, *map(str, options)], check=True, stdout=subprocess.PIPE, text=True).stdout


def exponent(before, after):
    """The exponent of growth between two (size, time)."""
    return math.log(after[1] / before[1]) / math.log(after[0] / before[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, nargs="+", default=[100_000, 1_000_000, 10_000_000])
    parser.add_argument("--joints", type=int, nargs="+", default=[2, 4, 6])
    parser.add_argument("--skip-long", action="store_true")
    arguments = parser.parse_args()
    print(f"processor: {processor()}")
    if not arguments.skip_long:
        program = build_ours("aurt-calibration", "long")
        before = None
        for samples in arguments.samples:
            line = run(program, "--samples", samples, "--threads", 1).strip()
            here = (samples, float(re.search(r"total ([\d.]+) s", line)[1]))
            growth = f"; exponent {exponent(before, here):.3f}" if before else ""
            print(f"{line}{growth}", flush=True)
            before = here
    program = build_ours("aurt-calibration", "identification")
    before = None
    for joints in arguments.joints:
        lines = run(program, "--tsv", "--joints", joints, "--rounds", 9).splitlines()
        milliseconds = next(float(l.split("\t")[1]) for l in lines if l.startswith("from parsed arrays, τ_J literal"))
        here = (joints, milliseconds)
        growth = f"; exponent {exponent(before, here):.2f}" if before else ""
        print(f"{joints} joints, 29000 samples, from arrays: {milliseconds:.1f} ms{growth}", flush=True)
        before = here


if __name__ == "__main__":
    main()
