"""AURT on commands and positions: `aurt run` of the experiment in `examples`, whose split is that of the case."""

import pathlib

import numpy as np

from cases import DriveCase
from result import Result
from rollouts import motion
from tools.aurt import call, scratch_folder, version as version

NAME, CASES = "AURT", DriveCase
EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / "examples"


def solve(case: DriveCase) -> Result:
    """Held-out rollouts; those of parts of one file are numbered."""
    motions = [motion(case, part) for part in case.held_out]
    with scratch_folder() as scratch:
        call("run", "--quiet", EXAMPLES / case.experiment, "--out", scratch)
        predictions = []
        for part, held_out in zip(case.held_out, motions, strict=True):
            stem = pathlib.Path(part.file).stem
            numbered = scratch / f"rollout_{stem}_1.csv"
            file = numbered if numbered.exists() else scratch / f"rollout_{stem}.csv"
            numbers = np.loadtxt(file, delimiter=",", skiprows=1)
            joints = held_out.q.shape[1]
            stamps = numbers[:, 0] - numbers[0, 0]
            predictions.append(np.column_stack([np.interp(held_out.t, stamps, c) for c in numbers[:, 1 : 1 + joints].T]))
        return Result({}, predictions)
