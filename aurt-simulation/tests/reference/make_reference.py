"""Reference values for the simulated robots, from Pinocchio (Carpentier et al., SII 2019).

    pip install pin==4.1.0
    cargo run -p aurt-simulation --example robots | python make_reference.py    # writes reference.json beside this

Bodies come as mass, centre of mass and inertia {XX XY XZ YY YZ ZZ} about it, in the link's frame; Pinocchio turns
them into the inertia about the frame's origin and computes torques. Geometry is read as in the crate: row j holds
the d of joint j and the alpha, a that lead to joint j + 1.
"""

import json
import pathlib
import sys

import numpy as np
import pinocchio as pin

STATES = 4
# Pinocchio: m, m c, XX XY YY XZ YZ ZZ; the crate: XX XY XZ YY YZ ZZ mX mY mZ m.
FROM_PINOCCHIO = [4, 5, 7, 6, 8, 9, 1, 2, 3, 0]


def values(robot, rng):
    model = pin.Model()
    model.gravity.linear = np.array(robot["gravity_m_s2"])
    parent, alpha, a = 0, 0.0, 0.0
    standard = []
    for j, ((next_alpha, next_a, d), body) in enumerate(zip(robot["mdh"], robot["bodies"])):
        rotation = pin.utils.rotate("x", alpha)
        placement = pin.SE3(rotation, np.array([a, 0, 0]) + rotation @ np.array([0, 0, d]))
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"joint_{j}")
        xx, xy, xz, yy, yz, zz = body["inertia_at_com_kg_m2"]
        at_com = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        inertia = pin.Inertia(body["mass_kg"], np.array(body["com_m"]), at_com)
        standard += [float(v) for v in inertia.toDynamicParameters()[FROM_PINOCCHIO]]
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
        alpha, a = next_alpha, next_a
    rotors = np.array(robot["rotor_inertia_kg_m2"])
    data = model.createData()
    joints = len(robot["bodies"])
    states = []
    for _ in range(STATES):
        q, qd, qdd = rng.uniform(-3, 3, joints), rng.uniform(-2, 2, joints), rng.uniform(-8, 8, joints)
        torque = pin.rnea(model, data, q, qd, qdd) + rotors * qdd
        states.append({"q_rad": list(q), "qd_rad_s": list(qd), "qdd_rad_s2": list(qdd), "torque_nm": list(torque)})
    return {**robot, "standard_parameters": standard, "states": states}


def rounded(value):
    """15 significant digits, so that the file is the same wherever it is made."""
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    if isinstance(value, list):
        return [rounded(v) for v in value]
    return float(f"{float(value):.15g}")


def main():
    robots = json.load(sys.stdin)
    rng = np.random.default_rng(20261120)
    document = {"pinocchio": pin.__version__, "robots": {}}
    for name in sorted(robots):
        document["robots"][name] = rounded(values(robots[name], rng))
    path = pathlib.Path(__file__).with_name("reference.json")
    path.write_text(json.dumps(document, indent=1) + "\n")


main()
