"""The arm as an MJCF model, and its motion through the engine.

The integrator is the engine's semi-implicit Euler with implicit joint damping: the torque that an actuator reports is then
what acts. `implicitfast` also takes the servo's velocity gain implicitly, so that the arm feels a torque that differs from
the reported one by step x gain x acceleration: a rotor inertia that no robot has.
"""

from dataclasses import dataclass, field

import mujoco
import numpy as np
from mujoco import rollout

# The fastest servo (72 Hz) loses stability at steps of 2 ms to 4 ms.
STEP_S = 1e-3
# Compliant gears ring at up to some hundred rad/s; half the step keeps them stable and accurate.
FINE_STEP_S = 5e-4
# Dry friction of the engine is a constraint. With this time constant, twice the step and the least that the engine takes, it
# stops a joint within about a step; what the impedance lacks to 1 lets the joint creep.
FRICTION_SOLVER = 'solreffriction="0.002 1" solimpfriction="0.98 0.98 0.001"'


@dataclass
class Build:
    """What a model is compiled and driven with; effects change it."""

    robot: object
    coulomb_nm: np.ndarray
    viscous_nm_s: np.ndarray
    armature_kg_m2: np.ndarray
    gravity_m_s2: np.ndarray
    stiffness_nm_rad: np.ndarray
    rest_rad: np.ndarray
    compliant: dict = field(default_factory=dict)  # joint: (stiffness, damping, half the play or None)
    payload: tuple = None  # mass, centre of mass in the last link's frame
    swinging: tuple = None  # mass, length, damping
    tendon: tuple = None  # joint, partner, ratio, coulomb, viscous, inertia
    density_kg_m3: float = 0.0
    viscosity_pa_s: float = 0.0
    push: tuple = None  # link, force in the base frame, window
    laws: list = field(default_factory=list)

    @staticmethod
    def of(robot):
        n = robot.joints
        return Build(robot, robot.coulomb_nm.copy(), robot.viscous_nm_s.copy(), robot.armature_kg_m2.copy(),
                     robot.gravity_m_s2.copy(), np.zeros(n), np.zeros(n))

    @property
    def step_s(self):
        return FINE_STEP_S if self.compliant else STEP_S


def _numbers(values):
    return " ".join(f"{float(v):.17g}" for v in np.atleast_1d(values))


def mjcf(build, servo):
    """The model's text. `servo` holds per joint the gains of position and velocity, and the lag of the drives in s."""
    robot, n = build.robot, build.robot.joints
    lines = [
        "<mujoco><compiler angle='radian' autolimits='true' inertiafromgeom='false' balanceinertia='false'/>",
        f"<option timestep='{build.step_s}' integrator='Euler' gravity='{_numbers(build.gravity_m_s2)}' "
        f"density='{build.density_kg_m3}' viscosity='{build.viscosity_pa_s}'>",
        "<flag contact='disable'/></option><size memory='1M'/><worldbody>",
    ]
    for j in range(n):
        alpha, a = (robot.mdh[j - 1][0], robot.mdh[j - 1][1]) if j else (0.0, 0.0)
        d, c, s = robot.mdh[j][2], np.cos(alpha), np.sin(alpha)
        inertia = robot.inertia_kg_m2[j]
        lines.append(
            f"<body name='link{j}' pos='{_numbers([a, -s * d, c * d])}' "
            f"quat='{_numbers([np.cos(alpha / 2), np.sin(alpha / 2), 0, 0])}'>"
            f"<inertial pos='{_numbers(robot.com_m[j])}' mass='{_numbers(robot.mass_kg[j])}' fullinertia='"
            + _numbers([inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]])
            + f"'/><joint name='j{j}' axis='0 0 1' damping='{_numbers(build.viscous_nm_s[j])}' "
            f"frictionloss='{_numbers(build.coulomb_nm[j])}' armature='{_numbers(build.armature_kg_m2[j])}' "
            f"stiffness='{_numbers(build.stiffness_nm_rad[j])}' springref='{_numbers(build.rest_rad[j])}' "
            f"{FRICTION_SOLVER}/>")
        if j in build.compliant:
            stiffness, damping, gap = build.compliant[j]
            if gap is None:
                lines.append(f"<joint name='gear{j}' axis='0 0 1' stiffness='{stiffness}' damping='{damping}'/>")
            else:
                # The flanks are the joint's limits; they touch from the first overlap on, with full impedance.
                lines.append(
                    f"<joint name='gear{j}' axis='0 0 1' range='{-gap} {gap}' damping='{damping}' "
                    "solreflimit='0.0025 0.8' solimplimit='0.95 0.99 0.0002'/>")
    if build.payload:
        mass, com, size = build.payload
        lines.append(f"<body name='load'><inertial pos='{_numbers(com)}' mass='{mass}' diaginertia='"
                     f"{_numbers([0.4 * mass * size ** 2] * 3)}'/></body>")
    if build.swinging:
        mass, length, damping = build.swinging
        lines.append(
            f"<body name='pendulum' pos='0.03 0 0.06'><inertial pos='0 0 {length}' mass='{mass}' "
            f"diaginertia='{_numbers([1e-3 * mass] * 3)}'/><joint axis='1 0 0' damping='{damping}'/>"
            f"<joint axis='0 1 0' damping='{damping}'/></body>")
    lines += ["</body>" * n, "</worldbody>"]
    if build.tendon:
        joint, partner, ratio, coulomb, viscous, inertia = build.tendon
        lines.append(
            f"<tendon><fixed name='rotor' frictionloss='{coulomb}' damping='{viscous}' armature='{inertia}' "
            f"{FRICTION_SOLVER}><joint joint='j{joint}' coef='1'/><joint joint='j{partner}' coef='{ratio}'/>"
            "</fixed></tendon>")
    position_nm_rad, velocity_nm_s, lag_s = servo
    lines.append("<actuator>")
    for j in range(n):
        kp, kv = position_nm_rad[j], velocity_nm_s[j]
        lines.append(f"<general joint='j{j}' gainprm='{kp}' biastype='affine' biasprm='0 {-kp} {-kv}'/>")
    for j in range(n):
        lines.append(f"<general joint='j{j}' gainprm='1' dyntype='filterexact' dynprm='{lag_s}'/>")
    lines.append("</actuator><sensor>")
    for kind in ("jointpos", "jointvel", "jointactuatorfrc"):
        lines += [f"<{kind} joint='j{j}'/>" for j in range(n)]
    lines.append("</sensor></mujoco>")
    return "\n".join(lines)


@dataclass
class Trace:
    """What happened, on the engine's steps: (samples, n) each."""

    time_s: np.ndarray
    q_rad: np.ndarray
    v_rad_s: np.ndarray
    a_rad_s2: np.ndarray
    torque_nm: np.ndarray


class Divergence(Exception):
    """The controller could not hold the arm."""


def run(build, servo, motion):
    """Moves the arm along a motion; the trace of what it did. Raises Divergence."""
    model = mujoco.MjModel.from_xml_string(mjcf(build, servo))
    data = mujoco.MjData(model)
    n, h = build.robot.joints, model.opt.timestep
    steps = int(round(motion.duration_s / h))
    control = motion.control(np.arange(steps) * h, servo)
    address = [model.joint(f"j{j}").qposadr[0] for j in range(n)]
    data.qpos[address] = motion.q_rad[0]
    data.act[:] = control[0, n:]
    if build.laws:
        sensors = _stepped(model, data, build, control)
    else:
        sensors = _rolled(model, data, build, control)
    q, v, u = sensors[:, :n], sensors[:, n : 2 * n], sensors[:, 2 * n :]
    # Servos follow within some hundredths of a radian; what is further away is no recording.
    if not np.isfinite(sensors).all() or np.abs(q - motion.at(np.arange(steps) * h)).max() > 0.5:
        raise Divergence(f"{build.robot.name} leaves its path")
    every = int(round(STEP_S / h))
    a = np.vstack([np.diff(v, axis=0) / h, np.zeros((1, n))])
    kept = slice(0, steps - 1, every)
    return Trace(np.arange(steps)[kept] * h, q[kept], v[kept], a[kept], u[kept])


def _rolled(model, data, build, control):
    """All steps within the engine."""
    mujoco.mj_forward(model, data)
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    state = np.zeros(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, state, kind)
    spec = mujoco.mjtState.mjSTATE_CTRL
    if build.push:
        link, force, window = build.push
        pushed = np.zeros((len(control), model.nbody, 6))
        pushed[:, model.body(f"link{link}").id, :3] = _share(np.arange(len(control)) * model.opt.timestep, window)[
            :, None] * np.asarray(force)
        control = np.hstack([control, pushed.reshape(len(control), -1)])
        spec = mujoco.mjtState.mjSTATE_CTRL | mujoco.mjtState.mjSTATE_XFRC_APPLIED
    _, sensors = rollout.rollout(model, data, state[None], control[None], control_spec=int(spec))
    return sensors[0]


def _share(t, window):
    """A push that grows and fades within a twelfth of its window."""
    edge = (window[1] - window[0]) / 12
    return np.clip((t - window[0]) / edge, 0, 1) * np.clip((window[1] - t) / edge, 0, 1)


def _stepped(model, data, build, control):
    """Step after step, with laws of friction and torque between the steps."""
    n, h = build.robot.joints, model.opt.timestep
    dofs = [int(model.joint(f"j{j}").dofadr[0]) for j in range(n)]
    sensors = np.empty((len(control), 3 * n))
    laws = [law.begin(model, h) for law in build.laws]
    wants_load = any(law.wants_load for law in laws)
    load = np.zeros(model.nv)
    step, ctrl, sensed = mujoco.mj_step, data.ctrl, data.sensordata
    q, v, applied, loss = data.qpos, data.qvel, data.qfrc_applied, model.dof_frictionloss
    if model.nq != model.nv or dofs != list(range(n)):
        raise ValueError("laws between the steps need a rigid arm")
    mujoco.mj_forward(model, data)
    pushed, shares = None, None
    if build.push:
        link, force, window = build.push
        pushed, force = data.xfrc_applied[model.body(f"link{link}").id, :3], np.asarray(force)
        shares = _share(np.arange(len(control)) * h, window)
    for k in range(len(control)):
        ctrl[:] = control[k]
        if pushed is not None:
            pushed[:] = shares[k] * force
        for law in laws:
            law.act(k * h, q, v, load, loss, applied)
        step(model, data)
        sensors[k] = sensed
        if wants_load:
            load = (data.qfrc_actuator + data.qfrc_passive + data.qfrc_constraint + applied
                    - build.armature_kg_m2 * data.qacc)
    return sensors
