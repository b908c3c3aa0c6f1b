"""FMUs of a calibrated model in FMPy, against what `aurt predict` and `aurt simulate` say.

    python fmpy_check.py AURT MODEL RECORDING

AURT is the program, MODEL an `rd_calibrated.json`, RECORDING a motion that the model can follow. Units of both kinds
are exported, validated and simulated; the status is 1 if one of them fails. Needs `fmpy`.
"""

import csv
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import fmpy
import numpy as np
from fmpy.validation import validate_fmu

# Relative to the largest torque, and rad: recordings have nine decimals, from which free motions drift apart.
TORQUE_LIMIT, POSITION_LIMIT_RAD = 1e-9, 1e-6
# Torques alone drive a model for this long; its controller has moved it for the rest.
FREE_S = 1.0


def aurt(program, *arguments):
    """Runs the program, which has to succeed."""
    subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True)


def stored_predictions(program, model, folder):
    """Times, motion and torques that `aurt export c` stores: what `aurt predict` gives for these samples."""
    aurt(program, "export", "c", model, "--name", "machine", "--out", folder / "c")
    text = (folder / "c" / "main.c").read_text()

    def table(name):
        body = re.search(rf"static const double {name}\[STATES\]\[\d+\] = {{\n(.*?)\n}};", text, re.S).group(1)
        return np.array([[float(v.strip(" ()")) for v in row.strip(" {},").split(",")] for row in body.split("\n")])

    return table("t")[:, 0], table("q"), table("qd"), table("qdd"), table("torque")


def signals(columns):
    """Inputs as FMPy takes them."""
    names = list(columns)
    array = np.zeros(len(columns["time"]), dtype=[(name, np.float64) for name in names])
    for name in names:
        array[name] = columns[name]
    return array


def check_inverse(unit, stored):
    """The largest difference of torques, relative to the largest. An output belongs to the inputs of the last step."""
    time_s, q, qd, qdd, torque = stored
    columns = {"time": time_s}
    for name, values in (("q", q), ("dq", qd), ("ddq", qdd)):
        columns |= {f"{name}[{j}]": values[:, j] for j in range(values.shape[1])}
    step = time_s[1] - time_s[0]
    result = fmpy.simulate_fmu(unit, start_time=time_s[0], stop_time=time_s[-1], output_interval=step,
                               input=signals(columns))
    found = np.column_stack([result[name] for name in result.dtype.names[1:]])
    assert len(found) == len(torque), (len(found), len(torque))
    return np.abs(found[1:] - torque[:-1]).max() / np.abs(torque).max()


def read(path):
    """Columns of a CSV file."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    values = np.array(rows[1:], dtype=float)
    return {name: values[:, k] for k, name in enumerate(rows[0])}


def check_forward(unit, moved):
    """The largest distance from the motion of `aurt simulate` during the free time."""
    joints = sum(name.startswith("q_") for name in moved)
    time_s = moved["time"]
    free = time_s <= time_s[0] + FREE_S
    columns = {"time": time_s}
    start = {}
    for j in range(joints):
        torque = moved[f"torque_{j}"]
        columns[f"tau[{j}]"] = torque
        columns[f"tau_rate[{j}]"] = np.append(np.diff(torque) / np.diff(time_s), 0.0)
        start |= {f"q_start[{j}]": moved[f"q_{j}"][0], f"dq_start[{j}]": moved[f"qd_{j}"][0]}
    step = time_s[1] - time_s[0]
    result = fmpy.simulate_fmu(unit, start_time=time_s[0], stop_time=time_s[free][-1], output_interval=step,
                               input=signals({k: v[free] for k, v in columns.items()}), start_values=start)
    return max(np.abs(result[f"q[{j}]"] - moved[f"q_{j}"][free]).max() for j in range(joints))


def seconds(unit, moved):
    """Processor time of the steps of a second of motion, without what FMPy does between them."""
    description = fmpy.read_model_description(unit)
    joints = sum(name.startswith("q_") for name in moved)
    unpacked = fmpy.extract(unit)
    by_name = {v.name: v.valueReference for v in description.modelVariables}
    slave = fmpy.instantiate_fmu(unpacked, description, "CoSimulation")
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    set_values = slave.setReal
    start = [by_name[f"q_start[{j}]"] for j in range(joints)]
    set_values(start, [moved[f"q_{j}"][0] for j in range(joints)])
    slave.exitInitializationMode()
    torques = [by_name[f"tau[{j}]"] for j in range(joints)]
    time_s, taken = moved["time"], 0.0
    for n in range(len(time_s) - 1):
        set_values(torques, [moved[f"torque_{j}"][n] for j in range(joints)])
        began = time.process_time()
        slave.doStep(time_s[n] - time_s[0], time_s[n + 1] - time_s[n])
        taken += time.process_time() - began
    slave.terminate()
    slave.freeInstance()
    return taken / (time_s[-1] - time_s[0])


def main(program, model, recording):
    """All units; whether all are right."""
    good = True
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        stored = stored_predictions(program, model, folder)
        aurt(program, "simulate", "--model", model, "--motion", recording, "--out", folder / "followed.csv")
        aurt(program, "simulate", "--model", model, "--torques", folder / "followed.csv", "--out",
             folder / "moved.csv")
        moved = read(folder / "moved.csv")
        for kind in ("inverse", "forward"):
            out = folder / kind
            aurt(program, "export", "fmu", model, "--kind", kind, "--name", "machine", "--out", out)
            unit = str(out / "machine.fmu")
            problems = validate_fmu(unit)
            if kind == "inverse":
                away, limit, what = check_inverse(unit, stored), TORQUE_LIMIT, "of the largest torque"
            else:
                away, limit, what = check_forward(unit, moved), POSITION_LIMIT_RAD, f"rad in {FREE_S:g} s"
            passed = not problems and away <= limit
            good &= passed
            print(f"{kind}: {len(problems)} problems, largest difference {away:.2e} {what}: "
                  f"{'passed' if passed else 'FAILED'}", *problems, sep="\n  " if problems else " ")
            if kind == "forward":
                print(f"forward: 10 s of motion take {10.0 * seconds(unit, moved):.3f} s of processor time")
    return good


if __name__ == "__main__":
    sys.exit(0 if main(*sys.argv[1:4]) else 1)
