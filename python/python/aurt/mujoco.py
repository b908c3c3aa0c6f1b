"""What a calibrated model knows beyond a MuJoCo file, as MuJoCo's callback for passive forces.

    >>> import mujoco
    >>> import aurt
    >>> from aurt.mujoco import Passive
    >>> arm = mujoco.MjModel.from_xml_path("arm_calibrated.xml")
    >>> model = aurt.Model.load("rd_calibrated.json")
    >>> mujoco.set_mjcb_passive(Passive(model, arm))

Needs the package `mujoco`.
"""

import copy

import mujoco
import numpy

from ._aurt import Error, Model

__all__ = ["Passive"]


class Passive:
    """Adds what `model` has and the file lacks to `qfrc_passive`, Nm:

        -(τ_model(q, q̇, q̈) - τ_file(q, q̇, q̈) - frictionloss · sgn q̇),

    where τ_file is what `mj_inverse` of `arm` gives without constraints: bodies, armature, damping, springs. Load-dependent
    friction needs q̈, which in a simulation is that of the last step; `mj_inverse` uses its own. Below `rest_velocity_rad_s`
    (m/s of joints that slide) torques run linearly between their values at both ends.

    `arm` is the file that was corrected, alone; the model that is simulated may be another one, with objects and tools,
    in which the joints have the same names. Models without these joints are left as they are. A model whose friction
    remembers the motion advances when the time does and begins anew when it goes back.

    Load-dependent friction feels the arm's own motion, not contacts or what the arm carries in the scene. Masses of the
    file have to be right beforehand: what it lacks in inertia comes a step late and may shake a light joint.
    """

    def __init__(self, model, arm, *, joints=None, rest_velocity_rad_s=0.03):
        if not isinstance(model, Model):
            raise TypeError("model is no aurt.Model; aurt.Model.load reads one from an rd_calibrated.json")
        if model.unit != "Nm":
            raise Error(
                f"the model is in {model.unit}, and MuJoCo needs torques: calibrate with torque_constants_nm_per_a"
            )
        if not rest_velocity_rad_s > 0.0:
            raise Error(f"rest_velocity_rad_s is {rest_velocity_rad_s}; it must be above 0")
        one_axis = [int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)]
        if joints is None:
            joints = [arm.joint(j).name for j in range(arm.njnt) if arm.jnt_type[j] in one_axis]
        self._names = list(joints)
        if len(self._names) != model.joints:
            raise Error(
                f"{len(self._names)} joints ({', '.join(self._names)}) for a model with {model.joints}: "
                "name those of the chain with joints=[…]"
            )
        places = self._places(arm)
        if places is None or "" in self._names:
            raise Error(f"not every one of the joints {self._names} is in the model of MuJoCo")
        if any(arm.jnt_type[arm.joint(name).id] not in one_axis for name in self._names):
            raise Error(f"not every one of the joints {self._names} turns about or slides along one axis")
        self._arm_places = places
        self._model = model
        self._rest = float(rest_velocity_rad_s)
        self._bare = copy.copy(arm)
        self._bare.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
        self._scratch = mujoco.MjData(self._bare)
        self._busy = False
        self._predictor = model.predictor() if _remembers(model) else None
        self._time_s = None
        self._remembered = None

    def __call__(self, mj_model, data):
        if self._busy:
            return
        places = self._places(mj_model)
        if places is None:
            return
        positions, dofs = places
        # mj_inverse below calls this function again.
        self._busy = True
        try:
            lacking = self._lacking(
                data.time, data.qpos[positions], data.qvel[dofs], data.qacc[dofs], mj_model.dof_frictionloss[dofs]
            )
        finally:
            self._busy = False
        data.qfrc_passive[dofs] -= lacking

    def _places(self, mj_model):
        """Where positions and velocities of the joints are, or None where a joint is not there."""
        kind = mujoco.mjtObj.mjOBJ_JOINT
        ids = [mujoco.mj_name2id(mj_model, kind, name) for name in self._names]
        if min(ids) < 0:
            return None
        return mj_model.jnt_qposadr[ids], mj_model.jnt_dofadr[ids]

    def _lacking(self, time_s, q, dq, ddq, loss):
        """τ_model - τ_file - friction loss."""
        if self._predictor is not None:
            if self._time_s is not None and time_s == self._time_s:
                return self._remembered
            begins = self._time_s is None or time_s < self._time_s
            if begins:
                self._predictor.reset()
            step_s = self._bare.opt.timestep if begins else time_s - self._time_s
            level = loss * numpy.clip(dq / self._rest, -1.0, 1.0)
            self._remembered = self._predictor.torque(step_s, q, dq, ddq) - self._file(q, dq, ddq) - level
            self._time_s = time_s
            return self._remembered
        slow = numpy.abs(dq) < self._rest
        if not slow.any():
            return self._at(q, dq, ddq) - loss * numpy.sign(dq)
        below = self._at(q, numpy.where(slow, -self._rest, dq), ddq)
        above = self._at(q, numpy.where(slow, self._rest, dq), ddq)
        share = numpy.where(slow, 0.5 + 0.5 * dq / self._rest, 1.0)
        return below + share * (above - below) - loss * numpy.clip(dq / self._rest, -1.0, 1.0)

    def _at(self, q, dq, ddq):
        """τ_model - τ_file of one sample."""
        return self._model.torque(q, dq, ddq).ravel() - self._file(q, dq, ddq)

    def _file(self, q, dq, ddq):
        """Torques of the file without constraints."""
        positions, dofs = self._arm_places
        self._scratch.qpos[positions] = q
        self._scratch.qvel[dofs] = dq
        self._scratch.qacc[dofs] = ddq
        mujoco.mj_inverse(self._bare, self._scratch)
        return self._scratch.qfrc_inverse[dofs].copy()


def _remembers(model):
    """Whether friction of the model needs the times of samples."""
    zero = numpy.zeros((1, model.joints))
    try:
        model.torque(zero, zero, zero)
    except Error:
        return True
    return False
