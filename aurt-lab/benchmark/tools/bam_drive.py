"""BAM on the SO-101, whose servos it has a model of: its `MujocoController` on the maker's MJCF.

Rows of the calibration are too many for a controller in Python: the loss of `bam.fit` is that of eight stretches of five
seconds, one of each motion, and its optimizer starts anew from BAM's published set. All five servos share the parameters.
"""

import numpy as np

from cases import DriveCase
from result import Result
from rollouts import Motion, motion
from signals import Skipped
from tools.bam_tool import SEED, best, version as version
from tools.sysid_drive import SETTINGS, description

NAME, CASES = "BAM", DriveCase
MODELS, TRIALS, STRETCH_S = ("m1", "m4"), 200, 5.0
PUBLISHED = {"motor_name": "feetech_sts3215_7_4V", "model": "m1"}
VOLTS, FIRMWARE_GAIN = 12.0, 16


def stretch(m: Motion, number: int) -> Motion:
    """Five seconds of a motion, later ones in later motions."""
    begin = (number + 0.5) / 8 * max(0.0, m.t[-1] - STRETCH_S)
    cut = (m.t >= begin) & (m.t < begin + STRETCH_S)
    return Motion(m.t[cut] - m.t[cut][0], m.command[cut], m.q[cut])


def servo(name: str):
    """A friction model on the servo, with BAM's published numbers where it has them."""
    from bam.actuators import actuators
    from bam.model import load_model, models

    model = models[name]()
    model.set_actuator(actuators["sts3215"]())
    model.load_parameters_from_dict(load_model(**PUBLISHED).get_parameter_values())
    model.actuator.vin, model.actuator.kp = VOLTS, FIRMWARE_GAIN
    model.q_offset.value, model.q_offset.optimize = 0.0, False
    return model


def simulated(spec, names: tuple[str, ...], model, m: Motion) -> np.ndarray:
    """Positions from commands."""
    import mujoco
    from bam.mujoco import MujocoController

    robot = spec.compile()
    data = mujoco.MjData(robot)
    data.qpos[:] = m.q[0]
    mujoco.mj_forward(robot, data)
    controller = MujocoController(model, list(names), robot, data)
    model.actuator.q_target_smooth = m.command[0].copy()
    found = np.empty_like(m.q)
    for row, (t, command) in enumerate(zip(m.t, m.command, strict=True)):
        while data.time < t - 1e-9:
            controller.update()
            mujoco.mj_step(robot, data)
        controller.q_target[:] = command
        found[row] = data.qpos
    return np.nan_to_num(found, nan=10.0, posinf=10.0, neginf=-10.0)


def fit(name: str, spec, names: tuple[str, ...], motions: list[Motion]) -> tuple[float, object]:
    """Mean absolute error and model."""
    import optuna

    def error(model) -> float:
        return float(np.mean([np.abs(simulated(spec, names, model, m) - m.q).mean() for m in motions]))

    start = {key: p.value for key, p in servo(name).get_parameters().items() if p.optimize}
    sampler = optuna.samplers.CmaEsSampler(x0=start, seed=SEED)
    return best(lambda: servo(name), error, sampler, TRIALS)


def solve(case: DriveCase) -> Result:
    """Held-out rollouts of the friction model that fits best."""
    import mujoco

    if case.name != "so101":
        raise Skipped("BAM has no model of its actuators that was identified")
    setting = SETTINGS[case.name]
    spec = description(case, setting)
    for name in setting.joints:
        actuator = spec.actuator(name)
        actuator.set_to_motor()
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    # MuJoCo's reset of a simulation that diverges would set its time to zero again, without end.
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    motions = [stretch(motion(case, part), k) for k, part in enumerate(case.calibration)]
    _, model = min((fit(name, spec, setting.joints, motions) for name in MODELS), key=lambda found: found[0])
    held_out = [motion(case, part) for part in case.held_out]
    return Result({}, [simulated(spec, setting.joints, model, m) for m in held_out])
