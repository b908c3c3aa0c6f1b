#!/usr/bin/env python3
"""Changes that are added to a real recording: linear viscous friction on one joint, an encoder that shows too much, and a delay of
all measurements.

    AURT_DATA=/path/to/recordings python3 examples/ur10e-added-changes.py --out added

writes the altered recordings and their experiments into a folder and prints what `aurt diagnose` says has changed.
Python's standard library suffices.
"""

import argparse
import csv
import json
import os
import pathlib
import subprocess

JOINTS = 6
TORQUE_CONSTANTS_NM_PER_A = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
VISCOUS_NM_S = {0: 8.0, 1: 8.0, 2: 6.0, 4: 1.5}
DELAYS_S = [0.020, 0.040]
OFFSETS_RAD = {1: 0.02, 2: -0.03, 3: 0.1, 4: 0.2}


def columns(header, name):
    return [header.index(f"actual_{name}_{joint}") for joint in range(JOINTS)]


def with_friction(header, rows, joint, viscous_nm_s):
    velocity, current = columns(header, "qd")[joint], columns(header, "current")[joint]
    for row in rows:
        row[current] += viscous_nm_s * row[velocity] / TORQUE_CONSTANTS_NM_PER_A[joint]


def shifted(header, rows, joint, offset_rad):
    position = columns(header, "q")[joint]
    for row in rows:
        row[position] += offset_rad


def delayed(header, rows, delay_s):
    """Measurements of `delay_s` before, between rows by straight lines."""
    stamps = [row[0] for row in rows]
    for column in columns(header, "current"):
        before = [row[column] for row in rows]
        k = 0
        for row in rows:
            wanted = max(row[0] - delay_s, stamps[0])
            while k + 2 < len(stamps) and stamps[k + 1] <= wanted:
                k += 1
            share = (wanted - stamps[k]) / (stamps[k + 1] - stamps[k])
            row[column] = before[k] * (1 - share) + before[k + 1] * share


def main():
    parser = argparse.ArgumentParser(description=" ".join(__doc__.splitlines()[:2]))
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--aurt", default="target/release/aurt")
    arguments = parser.parse_args()
    arguments.out.mkdir(exist_ok=True)
    here = pathlib.Path(__file__).parent
    question = (here / "diagnose_ur10e_unchanged.toml").read_text()
    with open(pathlib.Path(os.environ["AURT_DATA"]) / "ur10e" / "excitation_50s.csv", newline="") as file:
        header, *recorded = csv.reader(file)
    changes = [(f"viscous_{joint}", with_friction, (joint, size)) for joint, size in VISCOUS_NM_S.items()]
    changes += [(f"delay_{1000 * size:.0f}_ms", delayed, (size,)) for size in DELAYS_S]
    changes += [(f"offset_{joint}", shifted, (joint, size)) for joint, size in OFFSETS_RAD.items()]
    for name, change, sizes in changes:
        rows = [[float(cell) for cell in row] for row in recorded]
        change(header, rows, *sizes)
        with open(arguments.out / f"{name}.csv", "w", newline="") as file:
            csv.writer(file).writerows([header, *rows])
        lines = [line for line in question.splitlines() if not line.startswith("validation")]
        lines = [f'target = ["{name}.csv"]' if line.startswith("target") else line for line in lines]
        experiment = arguments.out / f"{name}.toml"
        experiment.write_text("\n".join(lines) + "\n")
        command = [arguments.aurt, "--json", "diagnose", experiment, "--out", arguments.out / name]
        said = json.loads(subprocess.run(command, capture_output=True, text=True).stdout)
        print(f"{name}: {said['verdict']}")
        for effect in said["effects"]:
            if len(effect["present_in"]) == 1:
                parameters = ", ".join(f"{n} {p['value']:.4g} ± {p['std']:.2g}" for n, p in effect["parameters"].items())
                others = "".join(f" or {a['effect']}" for a in effect.get("alternatives", []))
                print(f"  {effect['effect']}{others} on {effect['joints']}: {parameters}")


if __name__ == "__main__":
    main()
