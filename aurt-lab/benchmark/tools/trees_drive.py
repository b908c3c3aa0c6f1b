"""Boosted trees on the history of the command: position minus command of each joint, from commands alone.

The grid of settings is searched inside the calibration parts: motions, or four blocks of time of one motion.
"""

import numpy as np

from cases import DriveCase
from result import Result
from rollouts import Motion, motion
from tools.trees import best_setting, grow, version as version

NAME, CASES = "trees", DriveCase
PAST_S = (0.02, 0.04, 0.06, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.2)
MOST_ROWS = 6_000


def features(m: Motion, joint: int) -> np.ndarray:
    """Commands of all joints now, and the differences of this joint's command to earlier ones."""
    own = m.command[:, joint]
    earlier = [own - np.interp(m.t - seconds, m.t, own) for seconds in PAST_S]
    return np.column_stack([m.command, *earlier])


def predictor(motions: list[Motion], joint: int):
    """Trees of one joint."""
    x = np.concatenate([features(m, joint) for m in motions])
    y = np.concatenate([(m.q - m.command)[:, joint] for m in motions])
    thin = slice(None, None, max(1, len(y) // MOST_ROWS))
    return grow(x[thin], y[thin], best_setting(x[thin], y[thin]))


def solve(case: DriveCase) -> Result:
    """Held-out positions."""
    motions = [motion(case, part) for part in case.calibration]
    trees = [predictor(motions, joint) for joint in range(motions[0].q.shape[1])]
    held_out = [motion(case, part) for part in case.held_out]
    found = [np.column_stack([t.predict(features(m, j)) for j, t in enumerate(trees)]) for m in held_out]
    return Result({}, [m.command + predicted for m, predicted in zip(held_out, found, strict=True)])
