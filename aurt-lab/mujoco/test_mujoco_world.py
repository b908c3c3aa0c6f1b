"""Checks of the world `mujoco`: `python3 -m pytest proof`."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from mujoco_lab import arm, case, effect, laws, motions, requests, rigid_body, robots, structure  # noqa: E402

REFERENCE = HERE.parent.parent / "aurt-rbd/tests/reference/reference.json"
SHORT = {"duration_s": 8.0, "rate_hz": 500.0}


def engine_of(robot):
    """The arm as the engine has it, without friction or rotors."""
    ones = np.ones(robot.joints)
    model = mujoco.MjModel.from_xml_string(arm.mjcf(arm.Build.of(robot), (ones, ones, 1e-3)))
    model.dof_frictionloss[:] = model.dof_damping[:] = model.dof_armature[:] = 0
    return model, mujoco.MjData(model)


def engine_torque(robot, q, v, a):
    model, data = engine_of(robot)
    torques = []
    for data.qpos[:], data.qvel[:], data.qacc[:] in zip(q, v, a):
        mujoco.mj_inverse(model, data)
        torques.append(data.qfrc_inverse.copy())
    return np.array(torques)


@pytest.mark.parametrize("name", robots.NAMES)
def test_frames_are_those_of_the_table(name):
    """Products of plain rotations and shifts along the table's rows, against the engine's bodies."""
    robot = robots.draw(name, np.random.default_rng(3), True)
    model, data = engine_of(robot)
    for q in np.random.default_rng(4).uniform(-3, 3, (5, robot.joints)):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        rotation, origin = rigid_body.link_frames(robot.mdh, q[None])
        ours = np.eye(4)
        for j, (_, _, d) in enumerate(robot.mdh):
            alpha, a = robot.mdh[j - 1][:2] if j else (0.0, 0.0)
            c, s = np.cos(alpha), np.sin(alpha)
            about_x = np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]])
            along_x, along_z, about_z = np.eye(4), np.eye(4), np.eye(4)
            along_x[0, 3], along_z[2, 3] = a, d
            about_z[:2, :2] = [[np.cos(q[j]), -np.sin(q[j])], [np.sin(q[j]), np.cos(q[j])]]
            ours = ours @ about_x @ along_x @ about_z @ along_z
            body = data.body(f"link{j}")
            for found in (body.xpos, origin[0, j]):
                assert np.abs(found - ours[:3, 3]).max() < 1e-12
            for found in (body.xmat.reshape(3, 3), rotation[0, j]):
                assert np.abs(found - ours[:3, :3]).max() < 1e-12


@pytest.mark.parametrize("name", robots.NAMES)
def test_engine_and_regressor_agree(name):
    robot = robots.draw(name, np.random.default_rng(5), False)
    q, v, a = np.random.default_rng(6).uniform(-3, 3, (3, 30, robot.joints))
    theirs, standard = engine_torque(robot, q, v, a), robot.standard_parameters()
    for ours in (rigid_body.torque(robot.mdh, robot.gravity_m_s2, standard, q, v, a),
                 rigid_body.regressor(robot.mdh, robot.gravity_m_s2, q, v, a) @ standard):
        assert np.abs(ours - theirs).max() < 1e-9


@pytest.mark.parametrize("name", ("ur5e", "ur10e", "tx40", "panda"))
def test_engine_agrees_with_the_reference_of_the_crates(name):
    """The torques to which `aurt-rbd` is held (aurt-rbd/tests/reference.rs), with the same inertias."""
    stored = json.loads(REFERENCE.read_text())["robots"][name]
    standard = np.array(stored["standard_parameters"]).reshape(-1, 10)
    mass, com = standard[:, 9], standard[:, 6:9] / standard[:, 9:]
    inertia = []
    for (xx, xy, xz, yy, yz, zz, *_), m, c in zip(standard, mass, com):
        inertia.append(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) - m * (c @ c * np.eye(3) - np.outer(c, c)))
    robot = robots.draw(name, np.random.default_rng(0), False)
    robot.mdh, robot.gravity_m_s2 = np.array(stored["mdh"]), np.array(stored["gravity_m_s2"])
    robot.mass_kg, robot.com_m, robot.inertia_kg_m2 = mass, com, np.array(inertia)
    q, v, a = (np.array([state[key] for state in stored["states"]]) for key in ("q_rad", "qd_rad_s", "qdd_rad_s2"))
    torque = np.array([state["torque_nm"] for state in stored["states"]])
    expected = torque - np.array(stored["rotor_inertia_kg_m2"]) * a
    found = engine_torque(robot, q, v, a)
    either = min(np.abs(found - expected).max(), np.abs(found - torque).max())
    assert either < 1e-9 * np.abs(torque).max()


def test_what_the_experiment_has_explains_an_arm_without_effects():
    """Noise-free, the structure leaves a small part of the noise while joints move: the world adds nothing of its own."""
    robot = robots.draw("ur5e", np.random.default_rng(1), True)
    random = np.random.default_rng(2)
    servo, known = motions.servo(robot, random)
    held = structure.Structure.of(robot, [])
    samples = []
    for sort in (motions.waves, motions.slow):
        motion = sort(robot, 10.0, random)
        motions.feed_forward(robot, motion, known)
        trace = arm.run(arm.Build.of(robot), servo, motion)
        samples.append(structure.NoiseFree(held, trace, case.sensing.Instrument.of(robot)))
    fit = held.fit([s.parts() for s in samples])
    assert max(np.sqrt(s.left_over(fit)).max() for s in samples) < 0.1


def test_laws_dissipate():
    """Over a closed loop friction takes energy, and no element passes its level."""
    for law in (laws.Dahl(0, 2.0, 0.01, 1.3), laws.Bristles(0, [1.0, 0.5, 0.5], [0.01, 0.004, 0.03])):
        law.begin(None, 1e-3)
        applied, work, last = np.zeros(1), 0.0, 0.0
        for t in np.arange(0, 4, 1e-3):
            q = 0.1 * np.sin(2 * np.pi * t)
            law.act(t, [q], [0.0], None, None, applied)
            work += -applied[0] * (q - last)
            last = q
            assert abs(applied[0]) <= 2.0 + 1e-9
        assert 1.0 < work < 2.0 * 0.1 * 4 * 4


def request(effects, strength="strong", robot="ur5e"):
    kind = "null" if not effects else "single"
    return requests.Request("case_0001", kind, effects, strength, robot)


def test_a_case_tells_nothing_of_its_truth():
    """Neither names nor sizes nor the seed stand in what a diagnosis sees."""
    files, sealed = case.make(request(["spring"], robot="tx40"), SHORT, 1, 0)
    truth = json.loads(sealed)
    assert sorted(files) == ["experiment.toml", "mdh.csv", *(f"recording_{k}.csv" for k in range(1, 6))]
    told = files["experiment.toml"] + files["mdh.csv"] + "".join(f.split("\n")[0] for f in files.values())
    for word in (*requests.KINDS, "strong", "null", "single", "seed", "noise", str(truth["seed"]), truth["world"]):
        # The experiment's own terms have names of the vocabulary, in every case.
        if word not in ("coulomb", "viscous", "rotor_inertia"):
            assert word not in told
    assert truth["world"] == "mujoco" and truth["effects"][0]["in_vocabulary"]


def test_an_effect_has_the_strength_that_was_asked_for():
    for name in ("current_offset", "spring"):
        _, sealed = case.make(request([name]), SHORT, 3, 0)
        found = json.loads(sealed)["effects"][0]
        assert 3 / 1.3 < max(found["achieved"][j] for j in found["joints"]) < 3 * 1.3


def test_what_is_concealed_is_not_declared():
    files, sealed = case.make(request(["coulomb"]), SHORT, 2, 0)
    joint = json.loads(sealed)["effects"][0]["joints"][0]
    override = files["experiment.toml"].split(f"joints = [{joint}]")[1]
    assert override.strip().startswith('coulomb = { model = "absent" }')


def test_every_effect_of_the_vocabulary_is_there_or_is_not_offered():
    assert len(requests.VOCABULARY) >= 18 and len(requests.UNKNOWN_EFFECTS) >= 4
    for kind in requests.KINDS.values():
        assert kind.family in "FVHLIPDCXQ" and kind.presence in ("structural", "later", "either")
        changed = kind.install is not effect.Effect.install or kind.sense is not effect.Effect.sense
        assert changed, kind.identifier


def called(plan, *options):
    return subprocess.run([sys.executable, HERE / "mujoco_world.py", "--plan", plan, *options],
                          capture_output=True, text=True, check=False)


def test_the_same_call_gives_the_same_bytes_however_the_work_is_divided(tmp_path):
    plan = tmp_path / "plan.json"
    plan.write_text(json.dumps({"recordings": SHORT, "nulls": {"robots": ["ur5e"], "count": 1},
                                "singles": {"robots": ["tx40"], "effects": ["stribeck"], "strengths": ["medium"]}}))
    listed = json.loads(called(plan, "--seed", "5", "--list").stdout)
    assert [r["name"] for r in listed] == ["case_0001", "case_0002"]
    for out, calls in (("a", [("0", "2")]), ("b", [("1", "1"), ("0", "1")])):
        for index, count in calls:
            done = called(plan, "--seed", "5", "--index", index, "--count", count, "--cases", tmp_path / out / "cases",
                          "--sealed", tmp_path / out / "sealed")
            assert done.returncode == 0, done.stderr
    files = sorted(p.relative_to(tmp_path / "a") for p in (tmp_path / "a").rglob("*") if p.is_file())
    assert len(files) == 2 * 8
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes(), file


def test_what_cannot_be_is_refused_with_status_2(tmp_path):
    plan = tmp_path / "plan.json"
    plan.write_text(json.dumps({"nulls": {"robots": ["kr300"], "count": 1}}))
    done = called(plan, "--seed", "1", "--list")
    assert done.returncode == 2 and "kr300" in done.stderr and "panda" in done.stderr
    plan.write_text(json.dumps({"nulls": {"count": 1}}))
    done = called(plan, "--seed", "1", "--index", "1", "--cases", tmp_path, "--sealed", tmp_path)
    assert done.returncode == 2 and "the plan has 1" in done.stderr
    done = called(tmp_path / "none.json", "--seed", "1", "--list")
    assert done.returncode == 2 and "cannot be read" in done.stderr
