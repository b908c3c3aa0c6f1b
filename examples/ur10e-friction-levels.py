#!/usr/bin/env python3
"""By how much friction differs between recordings of a UR10e that nobody has touched, each calibrated alone.

    AURT_DATA=/path/to/recordings python3 examples/ur10e-friction-levels.py

Python's standard library suffices.
"""

import argparse
import csv
import math
import pathlib
import re
import statistics
import subprocess
import tempfile

JOINTS = 6
RECORDINGS = ["unloaded_50s", "excitation_50s", "excitation_30s", "excitation_20s", "point_to_point"]
SPEEDS_RAD_S = [0.3, 1.0]
ROTORS = '[[arm_terms]]\nmodel = "rotor_inertia"\njoints = [2, 3, 4, 5]\n'


def calibrated(aurt, experiment, recording, folder):
    text = re.sub(r"(?m)^validation .*\n", "", experiment)
    only = f'calibration = ["${{AURT_DATA}}/ur10e/{recording}.csv"]'
    (folder / "one.toml").write_text(re.sub(r"(?m)^calibration .*", lambda _: only, text) + ROTORS)
    subprocess.run([aurt, "run", folder / "one.toml", "--out", folder / recording, "--quiet"], check=True, stdout=subprocess.DEVNULL)
    with open(folder / recording / "calibrated_parameters.csv", newline="") as rows:
        return {row["name"]: float(row["value"]) for row in csv.DictReader(rows)}


arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("--aurt", default="target/release/aurt")
aurt = arguments.parse_args().aurt
experiment = (pathlib.Path(__file__).parent / "diagnose_ur10e_structure.toml").read_text()
with tempfile.TemporaryDirectory() as scratch:
    found = [calibrated(aurt, experiment, recording, pathlib.Path(scratch)) for recording in RECORDINGS]
for speed in SPEEDS_RAD_S:
    shares = []
    for joint in range(JOINTS):
        levels = [own[f"F_C0_{joint}"] + own[f"F_v1_{joint}"] * speed for own in found]
        shares.append(statistics.stdev(levels) / statistics.mean(levels))
    of_all = math.sqrt(statistics.mean(share * share for share in shares))
    joints = ", ".join(f"{100 * share:.1f}" for share in shares)
    print(f"{speed} rad/s: standard deviation of friction {joints} % on joints 0 to 5, root mean square {100 * of_all:.1f} %")
