"""Serial chains of MJCF files, and all joints at once: torques, joints and limits against MuJoCo's inverse dynamics of the same file.

    pip install mujoco==4.0.0
    cargo build --release -p aurt-rbd --example chains
    python aurt-lab/mujoco/mjcf/compare.py target/release/examples/chains FILE...
    python aurt-lab/mujoco/mjcf/compare.py --reference arm.json arm.xml TIP   # torques that the tests of aurt-rbd keep

Prints one row per file: chains read, joints, the largest difference of a torque over 100 random states of all chains (of each state
relative to its largest torque). Ours is that of the rigid bodies with the file's armature and damping; MuJoCo's is that of mj_inverse without
constraints and springs, with all joints beside the chain at zero. Friction loss and limits are compared as numbers.
Exit status 1 if a difference exceeds 1e-9 or a number differs.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import mujoco
import numpy as np

TOLERANCE = 1e-9
STATES = 100
GRAVITY_M_S2 = [0.0, 0.0, -9.81]


def load(file):
    """The model, without what is compared as numbers."""
    model = mujoco.MjModel.from_xml_path(str(file))
    model.opt.gravity = GRAVITY_M_S2
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    model.opt.density = model.opt.viscosity = 0.0
    model.jnt_stiffness[:] = 0.0
    model.body_gravcomp[:] = 0.0
    return model


def inverse(model, data, joints, q, qd, qdd):
    """The torques of some joints; all others rest at zero."""
    data.qpos[:] = 0.0
    for joint in range(model.njnt):
        kind = model.jnt_type[joint]
        if kind in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
            at = model.jnt_qposadr[joint] + (3 if kind == mujoco.mjtJoint.mjJNT_FREE else 0)
            data.qpos[at] = 1.0
    data.qvel[:], data.qacc[:] = 0.0, 0.0
    data.qpos[model.jnt_qposadr[joints]] = q
    data.qvel[model.jnt_dofadr[joints]] = qd
    data.qacc[model.jnt_dofadr[joints]] = qdd
    mujoco.mj_inverse(model, data)
    return data.qfrc_inverse[model.jnt_dofadr[joints]].copy()


def compare_chain(model, chain, folder):
    """The largest relative difference of a torque, and what differs in numbers."""
    n = len(chain["joints"])
    data = mujoco.MjData(model)
    joints = np.array([model.joint(name).id for name in chain["joints"]])
    dofs = model.jnt_dofadr[joints]
    other = []
    for what, theirs in [("armature", model.dof_armature), ("damping", model.dof_damping), ("friction", model.dof_frictionloss)]:
        if not np.allclose(chain[what], np.ravel(theirs[dofs]), rtol=1e-15, atol=0.0):
            other.append(what)
    for joint, limits in zip(joints, chain["limits"]):
        theirs = model.jnt_range[joint] if model.jnt_limited[joint] else None
        same = (limits is None) == (theirs is None) and (limits is None or np.allclose(limits, theirs, rtol=1e-12))
        other += [] if same else [f"range of {model.joint(joint).name}"]
    numbers = np.fromfile(folder / f"{chain['number']}.f64").reshape(STATES, 5 * n + 11 * n * n)
    worst = 0.0
    for row in numbers:
        q, qd, qdd, torque = row[: 4 * n].reshape(4, n)
        ours = torque + np.array(chain["armature"]) * qdd + np.array(chain["damping"]) * qd
        theirs = inverse(model, data, joints, q, qd, qdd)
        worst = max(worst, np.abs(ours - theirs).max() / np.abs(theirs).max())
    return worst, other


def reference(out, file, tip):
    """Some states and MuJoCo's torques without armature and damping, for a test without MuJoCo."""
    model = load(file)
    model.dof_armature[:], model.dof_damping[:] = 0.0, 0.0
    data = mujoco.MjData(model)
    body, joints = model.body(tip).id, []
    while body:
        first, count = model.body_jntadr[body], model.body_jntnum[body]
        joints = list(range(first, first + count)) + joints
        body = model.body_parentid[body]
    random = np.random.default_rng(1)
    states = []
    for _ in range(8):
        q, qd, qdd = (reach * random.uniform(-1, 1, len(joints)) for reach in (2.0, 2.0, 6.0))
        torque = inverse(model, data, np.array(joints), q, qd, qdd)
        states.append({"q": q.tolist(), "qd": qd.tolist(), "qdd": qdd.tolist(), "torque": torque.tolist()})
    names = [model.joint(joint).name for joint in joints]
    pathlib.Path(out).write_text(json.dumps({"mujoco": mujoco.__version__, "joints": names, "states": states}, indent=1) + "\n")


def main():
    if sys.argv[1] == "--reference":
        return reference(*sys.argv[2:])
    failures, compared = 0, 0
    print("| file | chains | refused | joints | torque | other |\n|---|---|---|---|---|---|")
    written = sys.argv[1] == "--written"
    program, *files = sys.argv[2:] if written else sys.argv[1:]
    for file in map(pathlib.Path, files):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(program if written else scratch)
            if written:
                found = json.loads((folder / "chains.json").read_text())
            else:
                run = subprocess.run([program, folder, file], capture_output=True, text=True, check=True)
                found = json.loads(run.stdout)
            if "refused" in found:
                print(f"| {file.name} | – | all | | | {found['refused']} |", flush=True)
                continue
            read = [chain for chain in found["chains"] if "number" in chain]
            refused = [chain["refused"] for chain in found["chains"] if "refused" in chain]
            model = load(file)
            worst, other = 0.0, []
            for chain in read:
                difference, differing = compare_chain(model, chain, folder)
                worst = max(worst, difference)
                other += [f"{chain['tip'] or 'all joints'}: {what}" for what in differing]
            failures += worst > TOLERANCE or bool(other)
            compared += len(read)
            joints = ", ".join(str(len(chain["joints"])) for chain in read)
            print(f"| {file.name} | {len(read)} | {len(refused)} | {joints} | {worst:.0e} | {'; '.join(other + refused)} |", flush=True)
    print(f"\n{compared} chains compared")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
