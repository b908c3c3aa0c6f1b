"""AURT without being told of load or coupling: `aurt diagnose` on the calibration parts, then `aurt run` of the improved experiment."""

import dataclasses
import json
import re

from cases import ArmCase
from result import Result
from tools.aurt import call, coefficients, predictions, recordings, robot, scratch_folder, terms
from tools.aurt import version as version

NAME, CASES = "AURT diagnose", ArmCase


def claimed(case: ArmCase, verdict: dict) -> dict[str, float]:
    """Estimates of what is known; a load that is not claimed counts as none, a coupling that is not claimed as absent."""
    values = {"load_kg": 0.0} if case.load_link is not None else {}
    for effect in verdict["effects"]:
        parameters = {name: parameter["value"] for name, parameter in effect["parameters"].items()}
        if effect["effect"] == "payload" and case.load_link is not None:
            values["load_kg"] = parameters["mass_kg"]
        if effect["effect"] == "joint_coupling_friction" and case.coupling and case.coupling[0] in effect["joints"]:
            values |= {
                "coupling_kg_m2": parameters["inertia_kg_m2"],
                "coupling_viscous": parameters["viscous_nm_s"],
                "coupling_coulomb": parameters["coulomb_nm"],
            }
    return values


def first(value: float | list) -> float:
    """The number of a parameter, which may be one per joint."""
    return value if isinstance(value, (int, float)) else next(v for v in value if v is not None)


def solve(case: ArmCase) -> Result:
    """Claims, and predictions of the improved model."""
    blind = dataclasses.replace(case, load_link=None, coupling=None)
    known = tuple(part for part in case.calibration if not part.loaded)
    changed = tuple(part for part in case.calibration if part.loaded)
    roles = {"calibration": known} | ({"target": changed} if changed else {})
    with scratch_folder() as scratch:
        file, out = scratch / "experiment.toml", scratch / "diagnosis"
        file.write_text(robot(case, scratch) + recordings(case, scratch, **roles) + terms(blind))
        call("diagnose", "--quiet", file, "--out", out)
        verdict = json.loads((out / "verdict.json").read_text())
        improved = out / "improved.toml"
        held_out = recordings(case, scratch, validation=case.held_out).partition("\n")[2]
        improved.write_text(re.sub(r"^\[recordings\]\n", f"[recordings]\n{held_out}", improved.read_text(), flags=re.M))
        call("run", "--quiet", improved, "--out", scratch / "out")
        values = {name: first(value) for name, value in claimed(case, verdict).items()}
        values = coefficients(case, scratch / "out") | values
        return Result(values, predictions(case, scratch / "out"))
