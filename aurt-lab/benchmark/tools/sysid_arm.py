"""mujoco.sysid on an arm whose torques are measured: its parameters, bounds and optimizer on the residual of `mj_inverse`.

Rollouts driven by measured torques diverge within tenths of a second, so the residual is that of inverse dynamics, each joint over
its own rms. Per link ten inertial parameters as a pseudo-inertia; per joint damping, friction loss and armature; a load is a body on the
last link of a second description with the same parameters, a coupled wrist a fixed tendon. Start and bounds suit torques to USUAL_NM;
those of larger arms are solved in a larger unit, since masses and friction are linear in the torque.
"""

import numpy as np

from arm import joint_rows
from cases import ArmCase
from result import Result
from signals import MOVING_RAD_S, Rows, decimation, rows
from tools.sysid_drive import optimized

ITERATIONS, USUAL_NM = 30, 100.0


def quaternion(alpha: float, theta: float) -> np.ndarray:
    """A turn about x, then about the new z."""
    import mujoco

    about_x, about_z, both = np.zeros(4), np.zeros(4), np.zeros(4)
    mujoco.mju_axisAngle2Quat(about_x, [1.0, 0.0, 0.0], alpha)
    mujoco.mju_axisAngle2Quat(about_z, [0.0, 0.0, 1.0], theta)
    mujoco.mju_mulQuat(both, about_x, about_z)
    return both


def description(case: ArmCase, loaded: bool):
    """The chain, with links of some inertia."""
    import mujoco

    spec = mujoco.MjSpec()
    spec.option.gravity = case.gravity
    spec.compiler.balanceinertia = True
    body = spec.worldbody
    for j, row in enumerate(joint_rows(case)):
        turn = quaternion(row["alpha"], 0.0)
        origin = np.zeros(3)
        mujoco.mju_rotVecQuat(origin, [0.0, 0.0, row["d"]], turn)
        origin[0] += row["a"]
        body = body.add_body(name=f"link_{j}", pos=origin, quat=quaternion(row["alpha"], row["theta"]))
        inertia(body, 20.0 / (1 + j))
        kind = mujoco.mjtJoint.mjJNT_SLIDE if row["type"] == "prismatic" else mujoco.mjtJoint.mjJNT_HINGE
        body.add_joint(name=f"q_{j}", type=kind, axis=[0, 0, 1])
    if case.load_link is not None and loaded:
        inertia(spec.body(f"link_{case.load_link}").add_body(name="load"), 1.0)
    if case.coupling:
        tendon = spec.add_tendon(name="coupling")
        for joint in case.coupling:
            tendon.wrap_joint(f"q_{joint}", 1.0)
    return spec


def inertia(body, mass_kg: float) -> None:
    """A body of some size."""
    body.mass, body.ipos, body.inertia, body.explicitinertial = mass_kg, [0.01, 0.01, 0.01], [0.01 * mass_kg] * 3, True


def write_inertia(body, theta: np.ndarray) -> None:
    """The toolbox's pseudo-inertia; its own `apply_body_inertia` fails with mujoco 4.0.0, which refuses an `iquat` of NaN."""
    from mujoco.sysid._src.model_modifier import pi_from_theta

    pi = pi_from_theta(theta)
    body.mass, body.ipos = pi[0], pi[1:4] / pi[0]
    x, y, z = body.ipos
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    about_com = pi[4:].reshape(3, 3) + pi[0] * cross @ cross
    body.inertia, body.iquat = np.zeros(3), [1.0, 0.0, 0.0, 0.0]
    body.fullinertia = [about_com[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def parameters(case: ArmCase, spec):
    """Start and bounds of everything; what a description lacks is left alone."""
    from mujoco import sysid

    model, found = spec.compile(), sysid.ParameterDict()
    bodies = [f"link_{j}" for j in range(case.joints)] + ["load"] * (case.load_link is not None)
    for body in bodies:

        def apply(spec, p, body=body):
            if spec.body(body) is not None:
                write_inertia(spec.body(body), p.value)

        wide = {"mass_bound_mult": np.array([0.005, 50.0]), "ipos_bound_off": np.array([-1.0, 1.0])}
        wide |= {"stretch_bound_mult": np.array([0.005, 200.0]), "shear_bound_off": np.array([-2.0, 2.0])}
        found.add(sysid.body_inertia_param(spec, model, body, sysid.InertiaType.Pseudo, modifier=apply, **wide))
    places = [(f"q_{j}", "joint") for j in range(case.joints)] + [("coupling", "tendon")] * bool(case.coupling)
    for name, kind in places:
        for attribute, start, high in (("damping", 1.0, 500.0), ("frictionloss", 1.0, 500.0), ("armature", 0.01, 50.0)):

            def write(spec, p, name=name, kind=kind, attribute=attribute):
                value = p.value[0]
                setattr(getattr(spec, kind)(name), attribute, [value, 0, 0] if attribute == "damping" else value)

            found.add(sysid.Parameter(f"{name} {attribute}", start, 0.0, high, modifier=write))
    return found


def torques(model, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
    """Inverse dynamics, row by row."""
    import mujoco

    data, found = mujoco.MjData(model), np.empty_like(q)
    for row, (data.qpos[:], data.qvel[:], data.qacc[:]) in enumerate(zip(q, qd, qdd, strict=True)):
        mujoco.mj_inverse(model, data)
        found[row] = data.qfrc_inverse
    return found


def solve(case: ArmCase) -> Result:
    """Estimates and predictions."""
    from mujoco import sysid

    specs = {loaded: description(case, loaded) for loaded in (False, True)}
    parts = [rows(case, part) for part in case.calibration]
    chosen = [np.flatnonzero(r.inside)[:: decimation(case)] for r in parts]
    scale = np.concatenate([r.filtered[k] for r, k in zip(parts, chosen, strict=True)]).std(axis=0)
    unit = max(1.0, scale.max() / USUAL_NM)

    def residual(x, params):
        columns = []
        for column in x.reshape(len(x), -1).T:
            params.update_from_vector(column)
            models = {loaded: sysid.apply_param_modifiers(params, spec) for loaded, spec in specs.items()}
            left = [difference(models[r.part.loaded], r, k, unit, scale) for r, k in zip(parts, chosen, strict=True)]
            columns.append(np.concatenate(left).ravel())
        found = np.array(columns).T
        return [found if x.ndim > 1 else found[:, 0]], None, None

    start = parameters(case, specs[True]).move_off_bounds()
    best = optimized(start, residual, ITERATIONS)
    models = {loaded: sysid.apply_param_modifiers(best, spec) for loaded, spec in specs.items()}
    held_out = [rows(case, part) for part in case.held_out]
    predictions = [unit * torques(models[r.part.loaded], r.q, r.qd, r.qdd) for r in held_out]
    found = {name: unit * value for name, value in values(case, best, models[True]).items()}
    return Result(found, predictions)


def difference(model, recording: Rows, chosen: np.ndarray, unit: float, scale: np.ndarray) -> np.ndarray:
    """Predicted less measured torques of moving joints over their scale; both are smooth at 2 f_dyn."""
    q, qd, qdd = recording.q[chosen], recording.qd[chosen], recording.qdd[chosen]
    moving = np.abs(qd) > MOVING_RAD_S
    return moving * (unit * torques(model, q, qd, qdd) - recording.filtered[chosen]) / scale


def values(case: ArmCase, best, model) -> dict[str, float]:
    """Estimates of what is known."""
    if case.load_link is not None:
        return {"load_kg": float(model.body("load").mass[0])}
    if case.coupling:
        words = {"coupling_kg_m2": "armature", "coupling_viscous": "damping", "coupling_coulomb": "frictionloss"}
        return {name: float(best[f"coupling {word}"].value[0]) for name, word in words.items()}
    return {}
