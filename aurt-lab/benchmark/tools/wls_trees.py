"""Physics first, trees on what it leaves: weighted least squares, then boosted trees on its residual."""

import numpy as np

from cases import ArmCase
from result import Result
from signals import decimation, lowpass, rows
from tools import trees, wls

NAME, CASES = "WLS + trees", ArmCase


def version() -> str:
    """Packages of both."""
    return f"{wls.version()}, {trees.version()}"


def solve(case: ArmCase) -> Result:
    """Estimates of the first step, predictions of both."""
    coefficients = wls.fit(case)
    xs, ys = [], []
    for part in case.calibration:
        recording = rows(case, part)
        kept = np.flatnonzero(recording.inside)[:: decimation(case)]
        modelled = lowpass((wls.regressor(case, recording) @ coefficients).T, 2 * case.f_dyn_hz, case.rate_hz)
        xs.append(trees.features(case, recording)[kept])
        ys.append((recording.filtered - modelled)[kept])
    x, y = np.concatenate(xs), np.concatenate(ys)
    grown = [trees.grow(x, column, trees.best_setting(x, column)) for column in y.T]
    physics = wls.solve_with(case, coefficients)
    for k, part in enumerate(case.held_out):
        held_out = trees.features(case, rows(case, part))
        physics.predictions[k] = physics.predictions[k] + np.column_stack([t.predict(held_out) for t in grown])
    return physics
