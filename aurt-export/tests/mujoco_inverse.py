"""Largest difference of mj_inverse of a model file from stored torques, relative to the largest torque of each joint.

Usage: mujoco_inverse.py MODEL.xml STATES.json [JOINT ...], where a state is [q, qd, qdd, torque] of the joints that are named,
or of all; others stay at zero. Passive forces and friction loss are taken off the model, since the torques are those of
bodies and rotors alone.
"""

import json
import sys

import mujoco
import numpy as np

model = mujoco.MjModel.from_xml_path(sys.argv[1])
model.dof_damping[:] = 0.0
model.dof_frictionloss[:] = 0.0
model.jnt_stiffness[:] = 0.0
data = mujoco.MjData(model)
with open(sys.argv[2]) as file:
    states = np.array(json.load(file))
names = sys.argv[3:] or [model.joint(j).name for j in range(model.njnt)]
at = [model.joint(name).dofadr[0] for name in names]
difference = []
for state in states:
    full = np.zeros((3, model.nv))
    full[:, at] = state[:3]
    data.qpos, data.qvel, data.qacc = full
    mujoco.mj_inverse(model, data)
    difference.append(np.abs(data.qfrc_inverse[at] - state[3]))
print(repr(float(np.max(np.max(difference, axis=0) / np.max(np.abs(states[:, 3]), axis=0)))))
