"""What MuJoCo has no words for, written by `aurt export mjcf`: call `Drives.step` with the commands before each `mj_step`.

The firmware's reference follows the command within its limits, and dry friction is F_C + F_L |load| + F_S exp(-(v/v_S)^2).
"""

import math

import mujoco
import numpy as np

# The first kind of constraint that is a contact.
CONTACT = int(mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS)
JOINTS = []


class Drives:
    def __init__(self, model, data, command):
        """At rest under `command`."""
        self.reference = np.array(command, dtype=float)
        self.rate = np.zeros(len(JOINTS))
        for k, value in enumerate(self.reference):
            samples = int(model.actuator_history[k, 0])
            if samples:
                mujoco.mj_initCtrlHistory(model, data, k, None, np.full((samples, 1), value))

    def step(self, model, data, command):
        """Sets `data.ctrl` and the friction of the joints for the next step."""
        h = model.opt.timestep
        contacts = [e for e in range(data.nefc) if data.efc_type[e] >= CONTACT]
        forces = np.zeros(data.nefc)
        forces[contacts] = data.efc_force[contacts]
        load = data.qfrc_bias.copy()
        if contacts:
            of_contacts = np.zeros(model.nv)
            mujoco.mj_mulJacTVec(model, data, of_contacts, forces)
            load -= of_contacts
        for k, joint in enumerate(JOINTS):
            left, limit, speed = command[k] - self.reference[k], joint["acceleration"], joint["speed"] or math.inf
            if limit is not None:
                half = 0.5 * limit * h
                braking = min(math.sqrt(half * half + 2 * limit * abs(left)) - half, speed)
                aim = left / h if braking * h > abs(left) else math.copysign(braking, left)
                self.rate[k] += min(max(aim - self.rate[k], -limit * h), limit * h)
            else:
                self.rate[k] = min(max(left / h, -speed), speed)
            self.reference[k] += self.rate[k] * h
            friction = joint["coulomb"] + joint["per_load"] * abs(load[k])
            if joint["excess"]:
                friction += joint["excess"] * math.exp(-((data.qvel[k] / joint["stribeck"]) ** 2))
            model.dof_frictionloss[k] = friction
        data.ctrl[: len(JOINTS)] = self.reference
