"""Reference values for chains of URDF files, from Pinocchio.

    pip install pin==4.1.0 && python make_reference.py    # writes reference.json beside this file

The chain goes from `world` to `wrist` of gantry.urdf; the fingers are locked at zero.
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).parent
JOINTS = ["slide", "shoulder", "elbow", "extension"]
STATES = 4

model = pin.buildModelFromUrdf(str(HERE / "gantry.urdf"))
locked = [k for k, name in enumerate(model.names) if k > 0 and name not in JOINTS]
model = pin.buildReducedModel(model, locked, pin.neutral(model))
data = model.createData()
assert list(model.names)[1:] == JOINTS
rng = np.random.default_rng(7)


def configuration(q):
    return np.array([q[0], q[1], np.cos(q[2]), np.sin(q[2]), q[3]])


stack = []
for _ in range(100):
    q, v, a = rng.uniform(-2, 2, (3, 4))
    stack.append(pin.computeJointTorqueRegressor(model, data, configuration(q), v, a))
stack = np.vstack(stack)
stack = stack[:, np.linalg.norm(stack, axis=0) > 1e-9]
values = np.linalg.svd(stack / np.linalg.norm(stack, axis=0), compute_uv=False)

states = []
for _ in range(STATES):
    q, v, a = rng.uniform(-2, 2, (3, 4))
    states.append(
        {
            "q": list(q),
            "qd": list(v),
            "qdd": list(a),
            "torque": list(pin.rnea(model, data, configuration(q), v, a)),
            "mass_matrix": list(np.triu(pin.crba(model, data, configuration(q))).ravel()),
        }
    )
reference = {"base_parameters": int((values > 1e-9).sum()), "states": states}
(HERE / "reference.json").write_text(json.dumps(reference, indent=1) + "\n")
