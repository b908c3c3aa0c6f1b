"""Trees: time to calibrate a humanoid's upper body against figaroh, and to diagnose two arms against one.

    pip install figaroh pin==4.1.0 example-robot-data==6.0.0
    cargo build --release -p aurt-cli
    python aurt-lab/peers/trees.py target/release/aurt [--seconds 60] [--skip-figaroh] [--skip-diagnosis]

Recordings are simulated with Pinocchio: sums of four sines a joint, viscous and Coulomb friction, noise of 0.3 % of each
joint's torque. The upper body is that of a Unitree G1 with hands: waist, arms and fingers, 31 joints at 500 Hz. Times
are processor time: of `aurt run`, from the table to the written model, and of figaroh from arrays, as in
`identification.py`. The two-armed robot is a Baxter, 5 recordings of 30 s at 100 Hz, 1.5 kg undeclared in the
left hand in the last two; its arms are diagnosed together and the left alone.
"""

import argparse
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy  # noqa: E402
import pinocchio  # noqa: E402

from machine import processor  # noqa: E402

EXPERIMENT = """schema = 1
[robot]
urdf = "{urdf}"
joints = {joints}
gravity_m_s2 = [0.0, 0.0, -9.81]
[joint_dynamics]
viscous = {{ model = "polynomial", powers = [1] }}
[recordings]
calibration = {calibration}
{more}"""


def urdf_of(path):
    """A URDF file of example-robot-data."""
    return str(pathlib.Path(pinocchio.__file__).parents[4] / "share/example-robot-data/robots" / path)


def part(urdf, kept):
    """Pinocchio's model of the joints whose names `kept` accepts, the others locked at zero."""
    model = pinocchio.buildModelFromUrdf(urdf)
    locked = [k for k in range(1, model.njoints) if not kept(model.names[k])]
    return pinocchio.buildReducedModel(model, locked, numpy.zeros(model.nq))


def recording(model, seconds, rate_hz, seed, loaded=None):
    """Stamps, positions and torques; `loaded` names a joint whose link carries 1.5 kg more."""
    model = model.copy()
    if loaded:
        load = pinocchio.Inertia(1.5, numpy.array([0.0, 0.0, 0.05]), 1e-3 * numpy.eye(3))
        model.appendBodyToJoint(model.getJointId(loaded), load, pinocchio.SE3.Identity())
    data, random = model.createData(), numpy.random.default_rng(seed)
    t = numpy.arange(int(seconds * rate_hz)) / rate_hz
    lower, upper = numpy.maximum(model.lowerPositionLimit, -2), numpy.minimum(model.upperPositionLimit, 2)
    series = numpy.zeros((3, len(t), model.nv))
    series[0] += (lower + upper) / 2
    for k in range(4):
        omega = 2 * numpy.pi * random.uniform(0.05, 0.7, model.nv)
        phase, size = random.uniform(0, 6.28, model.nv), (upper - lower) / 10 / (k + 1)
        angle = t[:, None] * omega + phase
        series += size * numpy.array([numpy.sin(angle), omega * numpy.cos(angle), -(omega**2) * numpy.sin(angle)])
    q, qd, qdd = series
    torque = numpy.array([pinocchio.rnea(model, data, *state) for state in zip(q, qd, qdd)])
    torque += 0.1 * qd + 0.2 * numpy.sign(qd)
    torque += random.normal(size=torque.shape) * 3e-3 * torque.std(axis=0)
    return t, q, torque


def table(path, names, t, q, torque):
    """Writes a recording with named columns."""
    header = ["time", *(f"{n}.position" for n in names), *(f"{n}.effort" for n in names)]
    rows = numpy.column_stack([t, q, torque])
    numpy.savetxt(path, rows, fmt="%.7g", delimiter=",", header=",".join(header), comments="")


def experiment(folder, name, urdf, joints, calibration, more=""):
    """Writes an experiment file."""
    text = EXPERIMENT.format(urdf=urdf, joints=list(joints), calibration=calibration, more=more)
    (folder / f"{name}.toml").write_text(text.replace("'", '"'))
    return folder / f"{name}.toml"


def run(*command):
    """Seconds of processor time that a command takes, and what it prints; its status may say that it found something."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode > 1:
        raise SystemExit(done.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def upper_body(aurt, folder, seconds, with_figaroh):
    """Calibration of 31 joints."""
    urdf = urdf_of("g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf")
    model = part(urdf, lambda n: not any(part in n for part in ("hip", "knee", "ankle")))
    names = list(model.names)[1:]
    t, q, torque = recording(model, seconds, 500, 1)
    table(folder / "upper.csv", names, t, q, torque)
    file = experiment(folder, "upper", urdf, names, ["upper.csv"])
    times = [run(aurt, "run", file, "--out", folder / f"upper_{k}")[0] for k in range(3)]
    print(f"{len(names)} joints, {seconds:.0f} s at 500 Hz: aurt run {min(times):.2f} s", flush=True)
    if with_figaroh:
        from identification import Robot, figaroh

        print(f"  figaroh {figaroh(Robot(model), q, torque):.1f} s", flush=True)


def two_arms(aurt, folder, rounds=5):
    """Diagnosis of 14 joints against 7."""
    urdf = urdf_of("baxter_description/urdf/baxter.urdf")
    both = part(urdf, lambda n: n[:5] in ("left_", "right") and n[-3:-1] in ("_s", "_e", "_w"))
    names = list(both.names)[1:]
    for k in range(5):
        table(folder / f"arms_{k}.csv", names, *recording(both, 30, 100, k, "left_w2" if k > 2 else None))
    recordings = [f"arms_{k}.csv" for k in range(5)]
    files = []
    for side in ("left", ""):
        joints = [n for n in names if n.startswith(side)]
        more = f"target = ['{recordings[3]}']\nvalidation = ['{recordings[4]}']\n[preprocess]\nf_dyn_hz = 2.5"
        files.append(experiment(folder, f"arms{side}", urdf, joints, recordings[:3], more))
    ratios = []
    for k in range(rounds):
        (one, verdict), (two, of_both) = (run(aurt, "diagnose", f, "--out", f"{f}_{k}") for f in files)
        ratios.append(two / one)
        print(f"aurt diagnose: 7 joints {one:.2f} s, {verdict.splitlines()[0]}; 14 joints {two:.2f} s, {of_both.splitlines()[0]}")
    print(f"  ratio {statistics.median(ratios):.1f} [{min(ratios):.1f}, {max(ratios):.1f}]")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("aurt")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--skip-figaroh", action="store_true")
    parser.add_argument("--skip-diagnosis", action="store_true")
    arguments = parser.parse_args()
    print(f"processor: {processor()}")
    with tempfile.TemporaryDirectory() as name:
        upper_body(arguments.aurt, pathlib.Path(name), arguments.seconds, not arguments.skip_figaroh)
        if not arguments.skip_diagnosis:
            two_arms(arguments.aurt, pathlib.Path(name))


if __name__ == "__main__":
    main()
