"""Commands and positions of robots without torques, and the score of simulated positions."""

from dataclasses import dataclass

import numpy as np

from cases import DriveCase, Part
from signals import table


@dataclass
class Motion:
    """A stretch of a recording, stamps from zero."""

    t: np.ndarray
    command: np.ndarray
    q: np.ndarray


def motion(case: DriveCase, part: Part) -> Motion:
    """Rows of a part as they were recorded."""
    _, numbers = table(part.file)
    t = numbers[:, 0] - numbers[0, 0]
    cut = (t >= part.begin_s) & (t <= part.end_s)
    t, numbers = t[cut], numbers[cut]
    return Motion(t - t[0], numbers[:, case.command], numbers[:, case.position])


def rollout_error(case: DriveCase, predictions: list[np.ndarray]) -> float:
    """Rms of simulated minus measured positions over all rows and joints, mrad; the command alone is the scale."""
    errors = [p - motion(case, part).q for part, p in zip(case.held_out, predictions, strict=True)]
    return float(1e3 * np.sqrt(np.mean(np.concatenate(errors) ** 2)))
