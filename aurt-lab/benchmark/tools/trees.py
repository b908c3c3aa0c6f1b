"""Boosted trees: torque of each joint from positions, velocities, accelerations and their past; no physics.

The grid of settings is searched inside the calibration parts, on four blocks of contiguous time.
"""

import warnings

import numpy as np

from cases import ArmCase, Part
from result import Result, package_version
from signals import Rows, Skipped, decimation, rows

NAME, CASES = "trees", ArmCase
PAST_S = (0.1, 0.3)
# Leaves of a tree, least rows of a leaf.
GRID = ((8, 20), (8, 60), (31, 20), (31, 60))
BLOCKS = 4


def version() -> str:
    """Package that grows them."""
    return package_version("scikit-learn", "sklearn.ensemble")


def features(case: ArmCase, recording: Rows) -> np.ndarray:
    """One row per sample: q, q̇, q̈ of all joints, q̇ some time ago, and whether the load is on."""
    past = []
    for seconds in PAST_S:
        lag = round(seconds * case.rate_hz)
        past.append(np.concatenate([np.repeat(recording.qd[:1], lag, axis=0), recording.qd])[: len(recording.qd)])
    load = np.full((len(recording.t), 1), float(recording.part.loaded))
    return np.hstack([recording.q, recording.qd, recording.qdd, *past, load])


def training(case: ArmCase, part: Part) -> tuple[np.ndarray, np.ndarray]:
    """Features and measurement of a part, decimated."""
    recording = rows(case, part)
    kept = np.flatnonzero(recording.inside)[:: decimation(case)]
    return features(case, recording)[kept], recording.filtered[kept]


def grow(x: np.ndarray, y: np.ndarray, setting: tuple[int, int]):
    """One set of trees."""
    try:
        from sklearn.ensemble import HistGradientBoostingRegressor
    except ImportError as error:
        raise Skipped("the package scikit-learn is not installed") from error
    leaves, least = setting
    trees = HistGradientBoostingRegressor(
        learning_rate=0.1, max_leaf_nodes=leaves, min_samples_leaf=least, max_iter=100, early_stopping=False, random_state=1
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return trees.fit(x, y)


def best_setting(x: np.ndarray, y: np.ndarray) -> tuple[int, int]:
    """The setting with the least error on blocks that it was not fitted to."""
    block = np.arange(len(y)) * BLOCKS // len(y)

    def error(setting: tuple[int, int]) -> float:
        fits = ((k, grow(x[block != k], y[block != k], setting)) for k in range(BLOCKS))
        return sum(((y[block == k] - trees.predict(x[block == k])) ** 2).sum() for k, trees in fits)

    return min(GRID, key=error)


def solve(case: ArmCase) -> Result:
    """Predictions; trees have no parameters to compare."""
    parts = [training(case, part) for part in case.calibration]
    x, y = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    trees = [grow(x, column, best_setting(x, column)) for column in y.T]
    held_out = [features(case, rows(case, part)) for part in case.held_out]
    return Result({}, [np.column_stack([t.predict(f) for t in trees]) for f in held_out])
