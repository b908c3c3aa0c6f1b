"""Recordings as rows on a uniform grid, filtered alike for every tool, and the one score of all predictions.

Positions pass a Butterworth filter of fourth order forward and backward at 5 f_dyn, as in the AURT paper; velocity and acceleration
are differences of the result. Measured and predicted torques are compared behind the same filter at 2 f_dyn, on every
row at which the joint moves.
"""

import csv
import os
import pathlib
from dataclasses import dataclass

import numpy as np
from scipy import interpolate, io, signal

from cases import ArmCase, Part

MOVING_RAD_S = 0.03


class Skipped(Exception):
    """A case, or a tool on a case, that cannot run; the message says why."""


def data_folder() -> pathlib.Path:
    """The folder of the recordings."""
    folder = os.environ.get("AURT_DATA")
    if not folder:
        raise Skipped("AURT_DATA is not set")
    return pathlib.Path(folder).resolve()


def table(file: str) -> tuple[list[str], np.ndarray]:
    """Column names and numbers of a text table."""
    path = data_folder() / file
    if not path.is_file():
        raise Skipped(f"{file} is absent")
    with path.open() as lines:
        names = next(csv.reader([lines.readline()]))
        numbers = np.loadtxt(lines, delimiter=",", ndmin=2)
    return names, numbers


def columns(case: ArmCase, file: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stamps, positions and measurements of a recording."""
    if file.endswith(".mat"):
        path = data_folder() / file
        if not path.is_file():
            raise Skipped(f"{file} is absent")
        arrays = io.loadmat(path)
        t, q, measured = (np.asarray(arrays[name], float) for name in case.columns)
        return t.ravel(), q, measured
    if file.startswith("dyno/"):
        return bench_losses(file)
    names, numbers = table(file)
    n = case.joints
    measured = [k for k, name in enumerate(names) if "current_" in name or "torque_" in name]
    return numbers[:, 0], numbers[:, 1 : 1 + n], numbers[:, measured[:n]]


def bench_losses(file: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stamps, positions and torque that drive 1 loses: by its current, less what the torque sensor passes on."""
    path = data_folder() / file
    if not path.is_file():
        raise Skipped(f"{file} is absent")
    with path.open() as lines:
        found = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    names = ("time [s]", "a1 position [rad]", "a1 torque [Nm]", "trd605 torque [Nm]")
    t, q, motor, sensor = np.array([[float(row[name]) for name in names] for row in found]).T
    return t, q[:, None], (motor - sensor)[:, None]


def lowpass(values: np.ndarray, cutoff_hz: float, rate_hz: float) -> np.ndarray:
    """Butterworth filter of fourth order, forward and backward."""
    return signal.sosfiltfilt(signal.butter(4, cutoff_hz, fs=rate_hz, output="sos"), values, axis=0)


@dataclass
class Rows:
    """A part of a recording on its uniform grid; `inside` excludes rows within 1/f_dyn of its ends."""

    part: Part
    rate_hz: float
    t: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    torque: np.ndarray
    filtered: np.ndarray
    inside: np.ndarray


def rows(case: ArmCase, part: Part) -> Rows:
    """Rows of a part; torques are in Nm (N)."""
    stamps, position, measured = columns(case, part.file)
    stamps = stamps - stamps[0]
    stamps, first = np.unique(stamps, return_index=True)
    position, measured = position[first], measured[first]
    t = np.arange(0.0, stamps[-1], 1 / case.rate_hz)
    q = lowpass(interpolate.CubicSpline(stamps, position)(t), 5 * case.f_dyn_hz, case.rate_hz)
    torque = interpolate.interp1d(stamps, measured, axis=0)(t) * np.array(case.nm_per_unit)
    qd = np.gradient(q, 1 / case.rate_hz, axis=0)
    qdd = np.zeros_like(q)
    qdd[1:-1] = (q[2:] - 2 * q[1:-1] + q[:-2]) * case.rate_hz**2
    filtered = lowpass(torque, 2 * case.f_dyn_hz, case.rate_hz)
    # Rest before and after the motion carries no information.
    moves = np.flatnonzero((np.abs(qd) > MOVING_RAD_S).any(axis=1))
    margin = 1 / case.f_dyn_hz
    begin, end = max(part.begin_s, 0.0), min(part.end_s, t[-1])
    cut = (t >= max(begin, t[moves[0]] - margin)) & (t <= min(end, t[moves[-1]] + margin))
    inside = (t > begin + margin) & (t < end - margin)
    arrays = [a[cut] for a in (t, q, qd, qdd, torque, filtered, inside)]
    return Rows(part, case.rate_hz, *arrays)


def decimation(case: ArmCase) -> int:
    """Rows of the grid per row of the fit: the rate of the fit is 5 f_dyn."""
    return max(1, round(case.rate_hz / (5 * case.f_dyn_hz)))


def held_out_error(case: ArmCase, predictions: list[np.ndarray]) -> float:
    """Rms error over rms measurement while moving, in %, mean of the joints; predictions are on the grid of `rows`."""
    squares, errors = np.zeros(case.joints), np.zeros(case.joints)
    for part, predicted in zip(case.held_out, predictions, strict=True):
        recording = rows(case, part)
        smooth = lowpass(predicted, 2 * case.f_dyn_hz, case.rate_hz)
        kept = (np.abs(recording.qd) > MOVING_RAD_S) & recording.inside[:, None]
        squares += (kept * recording.filtered**2).sum(axis=0)
        errors += (kept * (recording.filtered - smooth) ** 2).sum(axis=0)
    return float(100 * np.sqrt(errors / squares).mean())
