"""Reference values for the rigid-body dynamics, from Pinocchio (Carpentier et al., SII 2019).

    pip install pin==4.1.0 && python make_reference.py    # writes reference.json beside this file

Each robot is built joint by joint from its modified Denavit-Hartenberg parameters, read as the original AURT
reads them: row j holds the d of joint j and the alpha, a that lead to joint j + 1. The placement of a joint is
Rot_x(alpha) Trans_x(a) Trans_z(d); the joint turns about z. So Pinocchio's joint frames are the link frames of
the crate, and forces, regressor and accelerations compare entry by entry.

Pinocchio's ten dynamic parameters of a link are m, m c, and the inertia about the joint frame's origin in the
order XX XY YY XZ YZ ZZ; `TO_PINOCCHIO` maps the crate's order XX XY XZ YY YZ ZZ mX mY mZ m to it.
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

PI = np.pi
ROBOTS = {
    "two_link": {
        "mdh": [[0, 1.0, 0], [0, 0.8, 0.1]],
        "gravity_m_s2": [0.0, -9.81, 0.0],
    },
    "ur5e": {
        "mdh": [
            [PI / 2, 0, 0.1625],
            [0, -0.425, 0],
            [0, -0.3922, 0],
            [PI / 2, 0, 0.1333],
            [-PI / 2, 0, 0.0997],
            [0, 0, 0.0996],
        ],
        "gravity_m_s2": [0.0, 6.937, -6.937],
    },
    "ur10e": {
        "mdh": [
            [PI / 2, 0, 0.1807],
            [0, -0.6127, 0],
            [0, -0.57155, 0],
            [PI / 2, 0, 0.17415],
            [-PI / 2, 0, 0.11985],
            [0, 0, 0.11655],
        ],
        "gravity_m_s2": [0.0, 0.0, -9.81],
    },
    "tx40": {
        "mdh": [
            [-PI / 2, 0, 0.32],
            [0, 0.225, 0],
            [PI / 2, 0, 0.035],
            [-PI / 2, 0, 0.225],
            [PI / 2, 0, 0],
            [0, 0, 0],
        ],
        "gravity_m_s2": [0.0, 0.0, -9.81],
    },
    "panda": {
        "mdh": [
            [-PI / 2, 0, 0.333],
            [PI / 2, 0, 0],
            [PI / 2, 0.0825, 0.316],
            [-PI / 2, -0.0825, 0],
            [PI / 2, 0, 0.384],
            [PI / 2, 0.088, 0],
            [0, 0, 0.107],
        ],
        "gravity_m_s2": [0.0, 0.0, -9.81],
    },
}
TO_PINOCCHIO = [9, 6, 7, 8, 0, 1, 3, 2, 4, 5]
STATES = 3


def random_body(rng):
    """Ten parameters {XX XY XZ YY YZ ZZ mX mY mZ m} of eight random point masses."""
    mass = rng.uniform(0.1, 1.0, 8)
    point = rng.uniform(-0.2, 0.2, (8, 3))
    inertia = sum(m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p in zip(mass, point))
    first = mass @ point
    return [*inertia[np.triu_indices(3)], *first, mass.sum()]


def build(robot, standard, rotor_inertia):
    """The robot as a Pinocchio model."""
    model = pin.Model()
    model.gravity.linear = np.array(robot["gravity_m_s2"])
    parent, alpha, a = 0, 0.0, 0.0
    for j, (next_alpha, next_a, d) in enumerate(robot["mdh"]):
        rotation = pin.utils.rotate("x", alpha)
        placement = pin.SE3(rotation, np.array([a, 0, 0]) + rotation @ np.array([0, 0, d]))
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"joint_{j}")
        dynamic = np.array(standard[10 * j : 10 * j + 10])[TO_PINOCCHIO]
        model.appendBodyToJoint(parent, pin.Inertia.FromDynamicParameters(dynamic), pin.SE3.Identity())
        alpha, a = next_alpha, next_a
    model.armature = np.array(rotor_inertia)
    return model


def values(robot, rng):
    joints = len(robot["mdh"])
    standard = np.concatenate([random_body(rng) for _ in range(joints)])
    rotor_inertia = rng.uniform(0.0, 0.3, joints)
    plain = build(robot, standard, np.zeros(joints))
    with_rotors = build(robot, standard, rotor_inertia)
    states = []
    for _ in range(STATES):
        q, qd, qdd = rng.uniform(-3, 3, joints), rng.uniform(-2, 2, joints), rng.uniform(-8, 8, joints)
        tau = rng.uniform(-60, 60, joints)
        point = rng.uniform(-0.3, 0.3, 3)

        data = plain.createData()
        torque = pin.rnea(plain, data, q, qd, qdd).copy()
        regressor = pin.computeJointTorqueRegressor(plain, data, q, qd, qdd).copy()
        in_order = np.empty_like(regressor)
        for j in range(joints):
            for k, p in enumerate(TO_PINOCCHIO):
                in_order[:, 10 * j + p] = regressor[:, 10 * j + k]
        assert np.allclose(in_order @ standard, torque, atol=1e-10)

        data = with_rotors.createData()
        mass = pin.crba(with_rotors, data, q).copy()
        mass = np.triu(mass) + np.triu(mass, 1).T
        pin.computeAllTerms(with_rotors, data, q, qd)
        bias = data.nle.copy()
        acceleration = pin.aba(with_rotors, data, q, qd, tau).copy()
        kinetic = float(0.5 * qd @ mass @ qd)
        potential = pin.computePotentialEnergy(with_rotors, data, q)

        pin.computeJointJacobians(with_rotors, data, q)
        frame = data.oMi[joints]
        jacobian = pin.getJointJacobian(with_rotors, data, joints, pin.ReferenceFrame.LOCAL).copy()
        linear = jacobian[:3] - pin.skew(point) @ jacobian[3:]
        jacobian = np.vstack([frame.rotation @ linear, frame.rotation @ jacobian[3:]])
        states.append(
            {
                "q_rad": list(q),
                "qd_rad_s": list(qd),
                "qdd_rad_s2": list(qdd),
                "torque_nm": list(torque),
                "regressor": list(in_order.ravel()),
                "applied_torque_nm": list(tau),
                "mass_matrix_kg_m2": list(mass.ravel()),
                "bias_torque_nm": list(bias),
                "forward_dynamics_rad_s2": list(acceleration),
                "kinetic_energy_j": kinetic,
                "potential_energy_j": float(potential),
                "point_m": list(point),
                "point_in_base_m": list(frame.act(point)),
                "jacobian": list(jacobian.ravel()),
            }
        )
    return {
        **robot,
        "standard_parameters": list(standard),
        "rotor_inertia_kg_m2": list(rotor_inertia),
        "states": states,
    }


def rounded(value):
    """15 significant digits, so that the file is the same wherever it is made."""
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    if isinstance(value, list):
        return [rounded(v) for v in value]
    return float(f"{float(value):.15g}")


def main():
    rng = np.random.default_rng(20240607)
    robots = {name: rounded(values(robot, rng)) for name, robot in ROBOTS.items()}
    document = {"made_by": "make_reference.py", "pinocchio": pin.__version__, "robots": robots}
    path = pathlib.Path(__file__).with_name("reference.json")
    path.write_text(json.dumps(document, separators=(",", ":")).replace('"q_rad"', '\n"q_rad"') + "\n")
    print(f"{path.name}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
