"""Weighted least squares as in the AURT paper: rigid bodies, Coulomb and viscous friction; NumPy on Pinocchio's regressor."""

import numpy as np

from arm import rigid_body_regressor
from cases import ArmCase, Part
from result import Result, package_version
from signals import Rows, decimation, lowpass, rows

NAME, CASES = "WLS", ArmCase


def version() -> str:
    """Packages that compute it."""
    return f"{package_version('numpy')}, {package_version('pin', 'pinocchio')}"


def layout(case: ArmCase) -> dict[str, int]:
    """First column of each block behind the links' inertial parameters."""
    n, blocks, column = case.joints, {}, 10 * case.joints
    sizes = {"viscous": n, "coulomb": n, "coupling": 3 * bool(case.coupling)}
    sizes |= {"offset": n * case.offset, "load": 10 * (case.load_link is not None)}
    for name, size in sizes.items():
        if size:
            blocks[name] = column
            column += size
    return blocks | {"all": column}


def regressor(case: ArmCase, recording: Rows) -> np.ndarray:
    """All columns at all rows, [joint, row, column], unfiltered."""
    blocks, n = layout(case), case.joints
    bodies = rigid_body_regressor(case, recording)
    matrix = np.zeros((n, len(recording.t), blocks["all"]))
    matrix[:, :, : 10 * n] = bodies
    for j in range(n):
        matrix[j, :, blocks["viscous"] + j] = recording.qd[:, j]
        matrix[j, :, blocks["coulomb"] + j] = np.sign(recording.qd[:, j])
        if case.offset:
            matrix[j, :, blocks["offset"] + j] = 1.0
    if case.coupling:
        matrix[:, :, blocks["coupling"] : blocks["coupling"] + 3] = coupling_columns(case, recording)
    if case.load_link is not None and recording.part.loaded:
        first = 10 * case.load_link
        matrix[:, :, blocks["load"] : blocks["load"] + 10] = bodies[:, :, first : first + 10]
    return matrix


def coupling_columns(case: ArmCase, recording: Rows) -> np.ndarray:
    """Inertia, viscous and Coulomb friction of a motor that turns with the sum of two joints, as both joints feel them."""
    both = list(case.coupling)
    qd, qdd = recording.qd[:, both].sum(axis=1), recording.qdd[:, both].sum(axis=1)
    block = np.zeros((case.joints, len(recording.t), 3))
    block[both] = np.column_stack([qdd, qd, np.sign(qd)])
    return block


def filtered(case: ArmCase, part: Part) -> tuple[np.ndarray, np.ndarray]:
    """Regressor and measurement of a part behind the parallel filter, decimated."""
    recording = rows(case, part)
    matrix = regressor(case, recording)
    smooth = np.array([lowpass(block, 2 * case.f_dyn_hz, case.rate_hz) for block in matrix])
    kept = np.flatnonzero(recording.inside)[:: decimation(case)]
    return smooth[:, kept], recording.filtered[kept].T


def fit(case: ArmCase) -> np.ndarray:
    """Coefficients of smallest norm, rows of each joint weighted by the variance of a first fit."""
    parts = [filtered(case, part) for part in case.calibration]
    matrix = np.concatenate([m for m, _ in parts], axis=1)
    measured = np.concatenate([y for _, y in parts], axis=1)
    weights = np.ones(case.joints)
    for _ in range(2):
        weighted = (matrix * weights[:, None, None]).reshape(-1, matrix.shape[2])
        scale = np.linalg.norm(weighted, axis=0)
        scale[scale == 0] = 1.0
        solution = np.linalg.lstsq(weighted / scale, (measured * weights[:, None]).ravel(), rcond=1e-8)[0] / scale
        weights = 1 / (measured - matrix @ solution).std(axis=1)
    return solution


def solve(case: ArmCase) -> Result:
    """Estimates and predictions."""
    return solve_with(case, fit(case))


def solve_with(case: ArmCase, coefficients: np.ndarray) -> Result:
    """The same from coefficients."""
    blocks = layout(case)
    values = {}
    if "load" in blocks:
        values["load_kg"] = coefficients[blocks["load"]]
    if "coupling" in blocks:
        names = ("coupling_kg_m2", "coupling_viscous", "coupling_coulomb")
        values |= dict(zip(names, coefficients[blocks["coupling"] : blocks["coupling"] + 3], strict=True))
    if case.name == "emps":
        values = {"mass_kg": coefficients[0], "viscous": coefficients[blocks["viscous"]]}
        values |= {"coulomb": coefficients[blocks["coulomb"]], "offset": coefficients[blocks["offset"]]}
    predictions = [(regressor(case, rows(case, part)) @ coefficients).T for part in case.held_out]
    return Result(values, predictions)
