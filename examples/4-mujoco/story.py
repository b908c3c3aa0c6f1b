"""From "my simulator is wrong" to "it is right": a MuJoCo file is asked what it lacks, corrected, and asked again.

    python story.py [--aurt AURT] [--out DIR]

AURT is the program (default `aurt`). The machine is the simulated UR10e of `aurt demo`, whose recordings are made first;
`arm.xml` beside this script is the user's file. Needs `mujoco` and `numpy`; the last column of the table needs the Python
package `aurt` too. The status is 1 if the corrected file is not twice as good on every joint of the recording that was
held out.
"""

import argparse
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np

HERE = Path(__file__).resolve().parent
JOINTS = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
TORQUE_CONSTANTS = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
FITTED, HELD_OUT = "exciting_motion", "other_motion"
# Samples of 8 ms on either side, and the order, of the polynomials that smooth positions; errors are smoothed over more.
HALF_WIDTH, HALF_WIDTH_OF_ERRORS, ORDER = 8, 16, 4
# Slower joints may stand, and dry friction of a joint that stands has no sign that a recording could show.
MOVING_RAD_S = 0.03

EXPERIMENT = """schema = 1

[robot]
mjcf = "{mjcf}"
gravity_m_s2 = [0.0, 0.0, -9.81]
torque_constants_nm_per_a = {constants}

[joint_dynamics]                       # what MuJoCo has words for: frictionloss and damping …
coulomb = {{ model = "constant" }}
hysteresis = {{ model = "sign" }}
viscous = {{ model = "polynomial", powers = [1] }}

[[arm_terms]]                          # … and armature; on the first two joints the links take it up
model = "rotor_inertia"
joints = [2, 3, 4, 5]

[recordings]
calibration = ["machine/{fitted}.csv"]
{others}

[preprocess]
f_dyn_hz = 5.0

[calibration]
estimator = "consistent"
"""


def aurt(program, *arguments):
    """Runs the program; 1 says that a diagnosis found something."""
    try:
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    except OSError as failure:
        sys.exit(f"{program} cannot be run: {failure.strerror}; name the program with --aurt")
    if done.returncode > 1:
        sys.exit(f"aurt {' '.join(map(str, arguments))}:\n{done.stderr}")
    return done.stdout


def recording(path):
    """Stamps, positions and torques of a recording in currents."""
    table = np.genfromtxt(path, delimiter=",", names=True)

    def of(prefix):
        return np.column_stack([table[f"{prefix}_{j}"] for j in range(len(JOINTS))])

    return table["timestamp"], of("actual_q"), of("actual_current") * TORQUE_CONSTANTS


def smoothed(series, step_s=1.0, derivative=0, half=HALF_WIDTH):
    """A derivative of polynomials that are fitted to the neighbours of every sample (Savitzky and Golay 1964)."""
    ends = np.pad(series, ((half, half), (0, 0)), mode="reflect", reflect_type="odd")
    offsets = np.arange(-half, half + 1) * step_s
    factor = [1.0, 1.0, 2.0][derivative]
    weights = factor * np.linalg.pinv(np.vander(offsets, ORDER + 1, increasing=True))[derivative]
    windows = np.lib.stride_tricks.sliding_window_view(ends, 2 * half + 1, axis=0)
    return windows @ weights


def prediction(model, t, q, callback=None):
    """MuJoCo's torques along a measured motion: mj_inverse of positions, velocities and accelerations."""
    step_s = (t[-1] - t[0]) / (len(t) - 1)
    motion = [smoothed(q, step_s, derivative) for derivative in (0, 1, 2)]
    at = [model.joint(name).dofadr[0] for name in JOINTS]
    data = mujoco.MjData(model)
    torque = np.empty_like(q)
    mujoco.set_mjcb_passive(callback)
    try:
        for k in range(len(t)):
            data.time = t[k]
            data.qpos[at], data.qvel[at], data.qacc[at] = (values[k] for values in motion)
            mujoco.mj_inverse(model, data)
            torque[k] = data.qfrc_inverse[at]
    finally:
        mujoco.set_mjcb_passive(None)
    return torque


def experiment(folder, name, mjcf, others):
    """Writes an experiment's file; its path."""
    path = folder / name
    path.write_text(EXPERIMENT.format(mjcf=mjcf, constants=TORQUE_CONSTANTS, fitted=FITTED, others=others))
    return path


def question(program, folder, stage, torques, t):
    """Asks what MuJoCo's prediction lacks, and prints the answer."""
    header = ",".join(["timestamp", *(f"predicted_torque_{j}" for j in range(len(JOINTS)))])
    np.savetxt(folder / f"{stage}.csv", np.column_stack([t, torques]), delimiter=",", header=header, comments="", fmt="%.9g")
    path = experiment(folder, f"{stage}.toml", "arm.xml", f'simulated = ["{stage}.csv"]')
    # The torque constants are the maker's: dry friction that a simulator lacks looks like wrong ones to whoever doubts them.
    said = aurt(program, "diagnose", path, "--without", "torque_constant", "--out", folder / f"{stage}_diagnosis")
    print(said.split("\n\n")[0].rstrip())


def error(t, q, measured, predicted):
    """Root mean square of the error over that of the measurement while a joint moves, in percent, both smoothed alike."""
    moving = np.abs(smoothed(q, (t[-1] - t[0]) / (len(t) - 1), 1)) > MOVING_RAD_S
    apart, whole = (smoothed(x, half=HALF_WIDTH_OF_ERRORS) for x in (measured - predicted, measured))
    return 100.0 * np.sqrt(np.sum(moving * apart**2, axis=0) / np.sum(moving * whole**2, axis=0))


def main():
    parser = argparse.ArgumentParser(description="A MuJoCo file, asked, corrected, and asked again.")
    parser.add_argument("--aurt", default="aurt", help="the program")
    parser.add_argument("--out", type=Path, default=Path("mujoco_story"), help="folder for all files")
    options = parser.parse_args()
    program, out = options.aurt, options.out
    out.mkdir(parents=True, exist_ok=True)
    (out / "arm.xml").write_text((HERE / "arm.xml").read_text())

    print("== The machine is recorded")
    aurt(program, "demo", "--out", out / "machine")
    t, q, _ = recording(out / "machine" / f"{FITTED}.csv")
    t_held, q_held, measured = recording(out / "machine" / f"{HELD_OUT}.csv")
    columns = {}

    def judged(title, stage, model, callback=None):
        columns[title] = error(t_held, q_held, measured, prediction(model, t_held, q_held, callback))
        question(program, out, stage, prediction(model, t, q, callback), t)

    print("\n== What does the file lack?")
    judged("as it was", "before", mujoco.MjModel.from_xml_path(str(out / "arm.xml")))

    print("\n== It is corrected")
    path = experiment(out, "calibrate.toml", "arm.xml", f'validation = ["machine/{HELD_OUT}.csv"]')
    aurt(program, "run", path, "--out", out / "model")
    print(aurt(program, "export", "mjcf", out / "model" / "rd_calibrated.json", "--into", out / "arm.xml", "--out",
               out / "corrected").strip())

    print("\n== What does it lack now?")
    corrected = mujoco.MjModel.from_xml_path(str(out / "corrected" / "arm_calibrated.xml"))
    judged("corrected", "after", corrected)

    print("\n== And without the transition of its dry friction?")
    # Friction loss looks at q̈ + 2/(0.95 T) q̇ with the time constant T, 20 ms by default, and so turns 9.5 ms ahead of the
    # velocity. MuJoCo takes no T below twice the time step, which inverse dynamics do not need otherwise.
    corrected.opt.timestep = 5e-5
    corrected.dof_solref[:, 0] = 1e-4
    corrected.dof_solimp[:, :2] = 0.99
    judged("without transition", "without_transition", corrected)

    try:
        from aurt import Model
        from aurt.mujoco import Passive
    except ImportError:
        print("\nskipped: the package aurt is not installed (pip install ./python), so there is no callback")
    else:
        print("\n== And with the callback?")
        # The model with what a diagnosis of the calibrated structure found.
        aurt(program, "diagnose", path, "--out", out / "model_diagnosis")
        model = Model.load(out / "model_diagnosis" / "rd_improved.json")
        judged("with callback", "callback", corrected, Passive(model, corrected, joints=JOINTS))

    print(f"\n== Error on {HELD_OUT}.csv, which was held out, % of the torque while the joint moves")
    print("| joint | " + " | ".join(columns) + " |")
    print("|---" * (len(columns) + 1) + "|")
    for j, name in enumerate(JOINTS):
        print(f"| {name} | " + " | ".join(f"{column[j]:.1f}" for column in columns.values()) + " |")
    if not np.all(columns["without transition"] < 0.5 * columns["as it was"]):
        sys.exit("the corrected file is not twice as good on every joint")


if __name__ == "__main__":
    main()
