"""Errors on recordings that were held out: figaroh, the original AURT and ours, one model, one preprocessing.

    pip install figaroh==1.0.2 pin==4.1.0
    AURT_DATA=/path/to/recordings python aurt-lab/peers/accuracy.py --aurt target/release/aurt

A UR10e at 500 Hz in A (docs/real-recordings.md), calibrated on `calibration.csv`, judged on the two others while the joint
moves. The model is what figaroh has: rigid bodies, Coulomb and viscous friction ({1}, no load dependence). Positions and
measurements are filtered and decimated as the original does (f_dyn = 10 Hz, SciPy), ours by itself. figaroh's regressor and
double QR decomposition solve by least squares; for the second row each joint's equations were divided by the deviation of
its residual, as its weighted solver would weight them (that one takes a matrix of all rows by all rows). The original's errors
are those of its own classes, run once (`original_aurt_results_moving.json`).
"""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import numpy
from figaroh.tools.qrdecomposition import QRDecomposer
from figaroh.tools.regressor import RegressorBuilder, RegressorConfig, eliminate_non_dynaffect
from scipy import signal

from identification import Robot
from robots import ROBOTS, build_model

JOINTS, RATE_HZ, F_DYN_HZ, DECIMATION, MOVING_RAD_S = 6, 500.0, 10.0, 10, 0.03
HELD_OUT = ("validation_8harm", "validation_point_to_point")
ESTIMATORS = ("ols", "wls", "irls", "consistent", "essential")


class Rows:
    """A recording as rows: figaroh's regressor, the measurement, and where each joint moves."""

    def __init__(self, path, builder, trimmed):
        table = numpy.loadtxt(path, skiprows=1)
        position, current = table[:, 1 : 1 + JOINTS], table[:, 1 + JOINTS : 1 + 2 * JOINTS]
        lowpass = signal.butter(4, 5 * F_DYN_HZ, fs=RATE_HZ, output="sos")
        parallel = signal.butter(4, 2 * F_DYN_HZ, fs=RATE_HZ, output="sos")
        q = signal.sosfiltfilt(lowpass, position, axis=0)
        velocity = numpy.gradient(q, 1 / RATE_HZ, axis=0)[1:-1]
        acceleration = (q[2:] - 2 * q[1:-1] + q[:-2]) * RATE_HZ**2
        q, current = q[1:-1], signal.sosfiltfilt(parallel, current, axis=0)[1:-1]
        cut = slice(None)
        if trimmed:
            moves = numpy.flatnonzero((numpy.abs(velocity) > MOVING_RAD_S).any(axis=1))
            cut = slice(moves[0], moves[-1])
        q, velocity, acceleration, current = q[cut], velocity[cut], acceleration[cut], current[cut]
        matrix = builder.build_basic_regressor(q, velocity, acceleration, {"act_idxv": list(range(JOINTS))})
        columns = matrix.shape[1]
        matrix = signal.sosfiltfilt(parallel, matrix.reshape(JOINTS, -1, columns), axis=1)[:, ::DECIMATION]
        self.matrix = matrix
        self.measured = current.T[:, ::DECIMATION]
        self.moving = numpy.abs(velocity.T[:, ::DECIMATION]) > MOVING_RAD_S


def solve(rows, names, weights):
    """Coefficients of all columns, zero where a column is none of the base."""
    matrix = (rows.matrix * weights[:, None, None]).reshape(-1, rows.matrix.shape[2])
    kept_matrix, kept = eliminate_non_dynaffect(matrix, names, tol_e=1e-6)
    right = (rows.measured * weights[:, None]).reshape(-1)
    base, _, expressions, solution = QRDecomposer().double_decomposition(right, kept_matrix, kept)
    coefficients = numpy.zeros(matrix.shape[1])
    for expression, value in zip(expressions, solution):
        coefficients[int(expression.split(" ")[0].split("*")[-1])] = value
    # The base columns are columns of the matrix; what is regrouped into them is zero.
    error = numpy.abs(matrix @ coefficients - base @ solution).max() / numpy.abs(right).max()
    assert error < 1e-6, f"figaroh's expressions are not understood: {error}"
    return coefficients


def figaroh(folder):
    """Errors by row of the table and recording, joint by joint."""
    builder = RegressorBuilder(Robot(build_model(ROBOTS["ur10e"])), RegressorConfig(has_friction=True))
    fitted = Rows(folder / "calibration.csv", builder, True)
    names = {str(k): 0.0 for k in range(fitted.matrix.shape[2])}
    held_out = {name: Rows(folder / f"{name}.csv", builder, False) for name in HELD_OUT}

    def errors(weights):
        coefficients = solve(fitted, names, weights)
        left = fitted.measured - fitted.matrix @ coefficients
        found = {}
        for name, rows in held_out.items():
            residual = rows.measured - rows.matrix @ coefficients
            found[name] = [(residual[j, rows.moving[j]] ** 2).mean() for j in range(JOINTS)]
        return found, left.std(axis=1)

    plain, deviations = errors(numpy.ones(JOINTS))
    weighted, _ = errors(1 / deviations)
    return {"figaroh, least squares": plain, "figaroh, rows weighted": weighted}


def ours(aurt, data, folder):
    """The same by our estimators."""
    found = {}
    for estimator in ESTIMATORS:
        with tempfile.TemporaryDirectory() as scratch:
            experiment = pathlib.Path(scratch) / "experiment.toml"
            validation = ", ".join(f'"{folder}/{name}.csv"' for name in HELD_OUT)
            experiment.write_text(
                f'schema = 1\n[robot]\nmdh = "{data}/ur10e/mdh.csv"\ngravity_m_s2 = [0.0, 0.0, -9.81]\n'
                '[joint_dynamics]\ncoulomb = { model = "constant" }\nviscous = { model = "polynomial", powers = [1] }\n'
                f'[recordings]\ncalibration = ["{folder}/calibration.csv"]\nvalidation = [{validation}]\n'
                f'[preprocess]\nf_dyn_hz = {F_DYN_HZ}\n[calibration]\nestimator = "{estimator}"\n'
            )
            out = pathlib.Path(scratch) / "out"
            run = subprocess.run([aurt, "run", "-q", experiment, "--out", out], capture_output=True, text=True)
            if run.returncode > 1:
                print(f'"{estimator}" refuses: {run.stderr.strip().splitlines()[-1]}')
                continue
            recordings = json.loads((out / "metrics.json").read_text())["recordings"]
            found[f'`"{estimator}"`'] = {
                pathlib.Path(r["file"]).stem: r["moving"]["mse"] for r in recordings if r["role"] == "validation"
            }
    return found


def original(folder):
    """What the original tool's classes gave."""
    results = json.loads((folder / "original_aurt_results_moving.json").read_text())["none [1]"]
    return {"original AURT": {name: results[f"{name}_moving"]["mse"] for name in HELD_OUT}}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--aurt", required=True, help="the program")
    arguments = parser.parse_args()
    data = pathlib.Path(os.environ["AURT_DATA"]).resolve()
    folder = data / "ur10e_500hz"
    rows = original(folder) | figaroh(folder) | ours(arguments.aurt, data, folder)
    reference = rows['`"wls"`']
    print("held-out mean squared error while moving, % of the difference from `\"wls\"`, geometric mean and joint by joint")
    for name in HELD_OUT:
        for row, errors in rows.items():
            ratios = numpy.array(errors[name]) / numpy.array(reference[name])
            cells = " | ".join(f"{100 * (r - 1):+.1f}" for r in [numpy.exp(numpy.log(ratios).mean()), *ratios])
            print(f"| {name} | {row} | {cells} |")


if __name__ == "__main__":
    main()
