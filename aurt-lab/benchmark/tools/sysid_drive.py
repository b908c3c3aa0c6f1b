"""mujoco.sysid on commands and positions: rollouts of the maker's MJCF, its own optimizer and bounds.

Per joint: gain, damping, armature, friction loss and command offset; for the whole robot a delay of the command, and for the
SO-101 the table under its fingertip. Firmware limits of speed and acceleration, break-away and load-dependent friction are
no words of MuJoCo's description.
"""

import contextlib
import importlib
import io
from dataclasses import dataclass

import numpy as np

from cases import DriveCase
from result import Result, package_version
from rollouts import Motion, motion
from signals import Skipped, data_folder

NAME, CASES = "mujoco.sysid", DriveCase
TIP_M, STOP_RAD, ITERATIONS = (-0.0079, 0.0, -0.0981), -1.03, 15


def version() -> str:
    """Version of the package; the toolbox needs its extra `sysid`."""
    found = package_version("mujoco")
    if not hasattr(importlib.import_module("mujoco.sysid"), "optimize"):
        raise Skipped("mujoco is installed without its extra sysid")
    return found


@dataclass(frozen=True)
class Setting:
    """What differs between the robots."""

    joints: tuple[str, ...]
    timestep_s: float
    gain: tuple[float, float, float] | None
    fixed_gain: float
    fixed_damping: float
    floor: bool
    # Damping, armature, friction loss, delay.
    start: tuple[float, float, float, float]


LEGS = tuple(f"{leg}_{part}_joint" for leg in ("FL", "FR", "RL", "RR") for part in ("hip", "thigh", "calf"))
SETTINGS = {
    "so101": Setting(
        ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll"),
        0.01, (10.0, 1.0, 100.0), 0.0, 0.0, True, (0.5, 0.005, 0.06, 0.035),
    ),
    "go2": Setting(LEGS, 0.005, None, 20.0, 1.5, False, (0.5, 0.01, 0.15, 0.02)),
}


def description(case: DriveCase, setting: Setting):
    """The maker's file without meshes, freejoint and jaw, with one position actuator and sensor per joint."""
    import mujoco

    path = data_folder() / case.description
    if not path.is_file():
        raise Skipped(f"{case.description} is absent")
    spec = mujoco.MjSpec.from_file(str(path))
    for geom in list(spec.geoms):
        spec.delete(geom)
    for group in (spec.meshes, spec.actuators, spec.sensors, spec.keys):
        for element in list(group):
            spec.delete(element)
    for joint in list(spec.joints):
        if joint.name not in setting.joints:
            spec.delete(joint)
    for name in setting.joints:
        actuator = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.set_to_position(kp=setting.gain[0] if setting.gain else setting.fixed_gain, kv=setting.fixed_damping)
        spec.add_sensor(name=name, type=mujoco.mjtSensor.mjSENS_JOINTPOS, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=name)
    if setting.floor:
        spec.worldbody.add_geom(name="table", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1, 1, 0.1], pos=[0, 0, -0.045])
        tip = spec.body("gripper").add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.001, 0, 0], pos=TIP_M)
        tip.mass = 0.0
        spec.joint("wrist_roll").range[0] = STOP_RAD
    spec.option.timestep = setting.timestep_s
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    return spec


def parameters(setting: Setting):
    """Start, bounds and meaning of every parameter."""
    from mujoco import sysid

    found = sysid.ParameterDict()

    def add(name, start, low, high, modifier=None):
        found.add(sysid.Parameter(name, start, low, high, modifier=modifier))

    def set_gain(name):
        def apply(spec, p):
            actuator = spec.actuator(name)
            actuator.gainprm[0], actuator.biasprm[1] = p.value[0], -p.value[0]

        return apply

    def set_offset(name):
        def apply(spec, p):
            actuator = spec.actuator(name)
            actuator.biasprm[0] = actuator.gainprm[0] * p.value[0]

        return apply

    def set_joint(name, attribute):
        def apply(spec, p):
            value = p.value[0]
            setattr(spec.joint(name), attribute, [value, 0, 0] if attribute == "damping" else value)

        return apply

    damping, armature, frictionloss, delay = setting.start
    for name in setting.joints:
        if setting.gain:
            add(f"{name} gain", *setting.gain, set_gain(name))
        add(f"{name} damping", damping, 0.0, 5.0, set_joint(name, "damping"))
        add(f"{name} armature", armature, 1e-4, 0.2, set_joint(name, "armature"))
        add(f"{name} frictionloss", frictionloss, 0.0, 2.0, set_joint(name, "frictionloss"))
        add(f"{name} offset", 0.0, -0.2, 0.2, set_offset(name))
    add("delay", delay, 0.0, 0.1)
    if setting.floor:
        add("table", -0.045, -0.1, 0.0, lambda spec, p: spec.geom("table").pos.__setitem__(2, p.value[0]))
    return found


def sequences(spec, motions: list[Motion]) -> list:
    """Motions as sysid wants them."""
    from mujoco import sysid

    model = spec.compile()
    names = [f"motion {k}" for k in range(len(motions))]
    starts = [sysid.create_initial_state(model, m.q[0], np.zeros(model.nv)) for m in motions]
    controls = [sysid.TimeSeries(m.t, m.command) for m in motions]
    measured = [sysid.TimeSeries.from_names(m.t, m.q, model) for m in motions]
    return [sysid.ModelSequences("robot", spec, names, starts, controls, measured)]


def delayed(params, predicted, measured, model, return_all, **_):
    """Differences of positions; a delay of the command is one of the response. The sum has the scale of the score."""
    from mujoco import sysid

    t = measured.times - params["delay"].value[0]
    q = np.column_stack([np.interp(t, predicted.times, column) for column in predicted.data.T])
    q = np.nan_to_num(q, nan=1e3, posinf=1e3, neginf=-1e3)
    return q - measured.data, sysid.TimeSeries(measured.times, q, measured.signal_mapping), measured


def optimized(start, residual, iterations: int):
    """Best parameters by the toolbox's own optimizer, which reports every step to standard output."""
    from mujoco import sysid

    with contextlib.redirect_stdout(io.StringIO()):
        best, _ = sysid.optimize(start, residual, optimizer="mujoco", verbose=False, max_iters=iterations)
    return best


def solve(case: DriveCase) -> Result:
    """Held-out rollouts of the optimized description."""
    from mujoco import sysid

    setting = SETTINGS[case.name]
    spec = description(case, setting)
    motions = [motion(case, part) for part in case.calibration]
    fitted = sysid.build_residual_fn(models_sequences=sequences(spec, motions), modify_residual=delayed, n_threads=1)
    start = parameters(setting).move_off_bounds()
    best = optimized(start, fitted, ITERATIONS)
    held_out = [motion(case, part) for part in case.held_out]
    judged = sysid.build_residual_fn(models_sequences=sequences(spec, held_out), modify_residual=delayed, n_threads=1)
    _, predictions, _ = judged(best.as_vector(), best)
    return Result({}, [p[0].data for p in predictions])
