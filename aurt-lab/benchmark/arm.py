"""The chain of a table of modified Denavit-Hartenberg parameters as a Pinocchio model, and its regressor; AURT takes no part."""

import csv
import math

import numpy as np

from cases import ArmCase
from signals import Rows, Skipped, data_folder

SINGLE_DRIVES = {"emps": "prismatic", "shaft": "revolute"}


def joint_rows(case: ArmCase) -> list[dict[str, float | str]]:
    """Per joint: alpha and a that lead to it, its d, theta and type."""
    if case.mdh in SINGLE_DRIVES:
        lines = [{"type": SINGLE_DRIVES[case.mdh], "alpha": "0", "a": "0", "d": "0"}]
    else:
        path = data_folder() / case.mdh
        if not path.is_file():
            raise Skipped(f"{case.mdh} is absent")
        with path.open() as file:
            lines = list(csv.DictReader(file))
    found, alpha, a = [], 0.0, 0.0
    for line in lines:
        kind = line.get("type", "revolute")
        values = {key: _number(text) for key, text in line.items() if key != "type"}
        found.append({"alpha": alpha, "a": a, "d": values["d"], "theta": values.get("theta", 0.0), "type": kind})
        alpha, a = values["alpha"], values["a"]
    return found


def _number(text: str) -> float:
    """A number, or a multiple of pi such as `-pi/2`."""
    head, _, divisor = text.strip().partition("/")
    factor = float(divisor) if divisor else 1.0
    if "pi" not in head:
        return float(head) / factor
    multiple = head.replace("pi", "").replace("*", "")
    return float(multiple + "1" if multiple in ("", "-", "+") else multiple) * math.pi / factor


def pinocchio_model(case: ArmCase):
    """Pinocchio's model; inertias are random, since only its regressor is used."""
    try:
        import pinocchio
    except ImportError as error:
        raise Skipped("the package pin is not installed") from error
    pinocchio.seed(1)
    model, parent, turn = pinocchio.Model(), 0, np.eye(3)
    model.gravity.linear = np.array(case.gravity)
    for number, row in enumerate(joint_rows(case)):
        about_x = pinocchio.AngleAxis(row["alpha"], np.array([1.0, 0.0, 0.0])).toRotationMatrix()
        origin = np.array([row["a"], 0.0, 0.0]) + about_x @ np.array([0.0, 0.0, row["d"]])
        turn = pinocchio.AngleAxis(row["theta"], np.array([0.0, 0.0, 1.0])).toRotationMatrix()
        joint = pinocchio.JointModelPZ() if row["type"] == "prismatic" else pinocchio.JointModelRZ()
        parent = model.addJoint(parent, joint, pinocchio.SE3(about_x @ turn, origin), f"joint_{number}")
        model.appendBodyToJoint(parent, pinocchio.Inertia.Random(), pinocchio.SE3.Identity())
    return model


def rigid_body_regressor(case: ArmCase, recording: Rows) -> np.ndarray:
    """Torques per inertial parameter, [joint, row, 10 × link], m first in each link."""
    import pinocchio

    model = pinocchio_model(case)
    data = model.createData()
    states = zip(recording.q, recording.qd, recording.qdd, strict=True)
    stacked = [pinocchio.computeJointTorqueRegressor(model, data, *state).copy() for state in states]
    return np.array(stacked).reshape(-1, case.joints, 10 * case.joints).transpose(1, 0, 2)
