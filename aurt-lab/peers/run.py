"""All comparisons with other programs, one after the other, in one run.

    pip install pin==4.1.0 cmeel-eigen scipy figaroh
    python aurt-lab/peers/run.py [--rounds 7]

A comparison whose program is not installed says so and is left out.
"""

import argparse
import importlib
import sys

from machine import processor


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--compiler", default="g++")
    arguments = parser.parse_args()
    print(f"processor: {processor()}")
    comparisons = [
        ("least_squares", lambda m: m.compare(arguments.rounds, 300_000, 70)),
        ("pinocchio_regressor", lambda m: m.compare(arguments.rounds, arguments.compiler)),
        ("dynamics", lambda m: m.compare(arguments.rounds, arguments.compiler)),
        ("identification", lambda m: m.compare(min(arguments.rounds, 3))),
    ]
    for name, run in comparisons:
        try:
            module = importlib.import_module(name)
        except ImportError as error:
            print(f"{name}: left out, {error.name} is not installed")
            continue
        run(module)
        sys.stdout.flush()


if __name__ == "__main__":
    main()
