"""A picture of a forward FMU in FMPy: where measured torques take the model, beside where they took the machine.

    python fmpy_picture.py UNIT.fmu MODEL RECORDING JOINT PICTURE.svg [SECONDS]

UNIT is what `aurt export fmu --kind forward` makes of MODEL, an `rd_calibrated.json`; RECORDING is a CSV file with `actual_q_0` …
and `actual_current_0` …, as the demo's. There is no controller: positions drift apart, the more the longer. Prints the largest
distance of each joint. Needs `fmpy`.
"""

import csv
import json
import sys

import fmpy
import numpy as np

WIDTH, HEIGHT, LEFT, TOP, BOTTOM = 720, 300, 56, 44, 40


def read(path):
    """Columns of a CSV file."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    values = np.array(rows[1:], dtype=float)
    return {name: values[:, k] for k, name in enumerate(rows[0])}


def simulated(unit, model, recording, seconds):
    """Times, measured positions and those of the unit, joint by joint."""
    with open(model) as file:
        constants = json.load(file)["instrument"]["torque_constants_nm_per_a"]
    time_s = recording["timestamp"]
    kept = time_s <= time_s[0] + seconds
    joints = len(constants)
    names = ["time"] + [f"{what}[{j}]" for what in ("tau", "tau_rate") for j in range(joints)]
    inputs = np.zeros(kept.sum(), dtype=[(name, np.float64) for name in names])
    inputs["time"] = time_s[kept]
    start = {}
    for j, constant in enumerate(constants):
        torque = constant * recording[f"actual_current_{j}"][kept]
        inputs[f"tau[{j}]"] = torque
        inputs[f"tau_rate[{j}]"] = np.append(np.diff(torque) / np.diff(time_s[kept]), 0.0)
        q = recording[f"actual_q_{j}"][kept]
        # The machine may move already: its velocity is the slope of the first 50 ms.
        few = time_s[kept] <= time_s[0] + 0.05
        start |= {f"q_start[{j}]": q[0], f"dq_start[{j}]": np.polyfit(time_s[kept][few] - time_s[0], q[few], 2)[1]}
    result = fmpy.simulate_fmu(unit, start_time=time_s[0], stop_time=time_s[kept][-1],
                               output_interval=time_s[1] - time_s[0], input=inputs, start_values=start)
    measured = np.array([recording[f"actual_q_{j}"][kept] for j in range(joints)])
    return time_s[kept] - time_s[0], measured, np.array([result[f"q[{j}]"] for j in range(joints)])


def ticks(low, high):
    """Round numbers between two."""
    step = 10.0 ** np.floor(np.log10((high - low) / 2.0))
    step *= next(f for f in (1, 2, 5, 10) if (high - low) / (f * step) <= 6)
    return step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)


def picture(time_s, measured, found, title):
    """Both lines as SVG."""
    low, high = min(measured.min(), found.min()), max(measured.max(), found.max())
    x = lambda t: LEFT + (WIDTH - LEFT - 16) * t / time_s[-1]
    y = lambda q: HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * (q - low) / (high - low)
    text = "font:12px system-ui,'DejaVu Sans',Helvetica,Arial,sans-serif;fill:#222"
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}">',
             f"<style>text{{{text}}}.grid{{stroke:#d8d8d8}}.line{{fill:none;stroke-width:1.4}}</style>",
             '<rect width="100%" height="100%" fill="#fff"/>',
             f'<text x="8" y="17" font-weight="600">{title}</text>']
    for value in ticks(0.0, time_s[-1]):
        parts.append(f'<path class="grid" d="M{x(value):.1f} {TOP}V{HEIGHT - BOTTOM}"/>'
                     f'<text x="{x(value):.1f}" y="{HEIGHT - 22}" text-anchor="middle">{value:g}</text>')
    for value in ticks(low, high):
        parts.append(f'<path class="grid" d="M{LEFT} {y(value):.1f}H{WIDTH - 16}"/>'
                     f'<text x="{LEFT - 6}" y="{y(value) + 4:.1f}" text-anchor="end">{value:g}</text>')
    parts.append(f'<text x="{WIDTH / 2}" y="{HEIGHT - 6}" text-anchor="middle">time, s</text>')
    for k, (name, values, style) in enumerate((("measured position, rad", measured, "stroke:#333"),
                                               ("forward unit, driven by the measured currents", found,
                                                "stroke:#0072b2;stroke-dasharray:5 3"))):
        points = "L".join(f"{x(t):.1f} {y(q):.1f}" for t, q in zip(time_s, values))
        parts.append(f'<path class="line" style="{style}" d="M{points}"/>')
        parts.append(f'<path class="line" style="{style}" d="M{8 + 200 * k} 32h24"/>'
                     f'<text x="{38 + 200 * k}" y="36">{name}</text>')
    return "\n".join(parts + ["</svg>"]) + "\n"


def main(unit, model, recording, joint, path, seconds="2"):
    """Draws one joint and prints the distance of all."""
    time_s, measured, found = simulated(unit, model, read(recording), float(seconds))
    for j, distance in enumerate(np.abs(found - measured).max(axis=1)):
        print(f"joint {j}: at most {distance:.4f} rad away, of {np.ptp(measured[j]):.4f} rad that it moves")
    joint = int(joint)
    with open(path, "w") as file:
        file.write(picture(time_s, measured[joint], found[joint], f"joint {joint}, {seconds} s without a controller"))


if __name__ == "__main__":
    main(*sys.argv[1:])
