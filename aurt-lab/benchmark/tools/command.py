"""The command itself: positions that follow without delay or error. What every tool must beat."""

from cases import DriveCase
from result import Result
from rollouts import motion

NAME, CASES = "command itself", DriveCase


def version() -> str:
    """Nothing is installed."""
    return "–"


def solve(case: DriveCase) -> Result:
    """Commands of the held-out parts."""
    return Result({}, [motion(case, part).command for part in case.held_out])
