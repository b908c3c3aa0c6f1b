"""What the command line has: exports, the check of a setup, tracking, gains."""

import numpy
import pandas
import pytest

import aurt
from conftest import TWO_LINK, motion
from test_experiment import EXPERIMENT

DRIVES = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
LOAD = {"name": "payload", "link": 5, "mass_kg": 2.0, "com_m": [0.02, -0.03, 0.08], "edges_m": [0.1, 0.1, 0.1]}


def write(recording, path, **more):
    """A recording as a table by its usual names."""
    columns = {"time": recording.t}
    measured, kind = (recording.tau, "torque") if recording.current is None else (recording.current, "current")
    for joint in range(recording.joints):
        columns[f"q_{joint}"], columns[f"{kind}_{joint}"] = recording.q[:, joint], measured[:, joint]
    pandas.DataFrame({**columns, **more}).to_csv(path, index=False)


@pytest.fixture(scope="module")
def experiment(tmp_path_factory, monday, tuesday):
    """The file of an experiment, with its recordings."""
    folder = tmp_path_factory.mktemp("commands")
    write(monday, folder / "monday.csv")
    write(tuesday, folder / "tuesday.csv")
    (folder / "mdh.csv").write_text(TWO_LINK)
    terms = '[[arm_terms]]\nmodel = "rotor_inertia"\njoints = [1]\n'
    (folder / "experiment.toml").write_text(EXPERIMENT + terms)
    return folder / "experiment.toml"


def test_a_model_is_exported_to_every_target(two_link, monday, tmp_path):
    model = aurt.calibrate(two_link.model(arm_terms=["rotor_inertia"]), monday, estimator="consistent")
    for target in ("c", "rust", "mjcf", "urdf", "sdf"):
        exported = model.export(target, tmp_path / target, name="arm")
        assert exported.files and all(path.is_file() and path.parent.is_relative_to(tmp_path / target) for path in exported.files)
        assert any("monday" in path.read_text() for path in exported.files), target
    for kind in ("inverse", "forward"):
        exported = model.export("fmu", tmp_path / kind, name="arm", kind=kind)
        assert [path.suffix for path in exported.files] == [".fmu"]
    assert any("friction" in lost for lost in model.export("urdf", tmp_path / "again").lost) or exported.lost is not None
    with pytest.raises(aurt.Error, match="exists"):
        model.export("fmu", tmp_path / "forward", name="arm", kind="inverse")


def test_exports_of_a_saved_model_are_the_same(model, tmp_path):
    model.save(tmp_path / "rd_calibrated.json")
    loaded = aurt.Model.load(tmp_path / "rd_calibrated.json")
    files = [one.export("c", tmp_path / name).files for name, one in (("a", model), ("b", loaded))]
    assert [path.read_bytes() for path in files[0]] == [path.read_bytes() for path in files[1]]


def test_a_file_of_the_user_is_corrected(tmp_path):
    path = tmp_path / "arm.urdf"
    link = '<link name="{}"><inertial><origin xyz="0.5 0 0"/><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    joint = '<joint name="{}" type="revolute"><parent link="{}"/><child link="{}"/><origin xyz="{} 0 0"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="3" effort="90"/></joint>'
    path.write_text(
        f'<robot name="arm"><link name="base"/>{link.format("upper")}{link.format("fore")}'
        f'{joint.format("one", "base", "upper", 0)}{joint.format("two", "upper", "fore", 1)}</robot>'
    )
    robot = aurt.Robot.from_urdf(path)
    t = numpy.arange(0.0, 12.0, 0.004)
    phase = numpy.outer(t, [3.1, 5.3]) + [0.3, 1.0]
    q, dq, ddq = numpy.sin(phase), [3.1, 5.3] * numpy.cos(phase), [-9.61, -28.09] * numpy.sin(phase)
    tau = robot.torque(q, dq, ddq) + numpy.random.default_rng(1).normal(0.0, 0.05, q.shape) + 0.4 * numpy.sign(dq)
    recording = aurt.Recording(t, q, tau=tau, joint_names=["one", "two"])
    model = aurt.calibrate(robot, recording, estimator="consistent")
    exported = model.export("urdf", tmp_path / "out", into=path)
    assert [file.name for file in exported.files] == ["arm_calibrated.urdf"] and exported.changed
    again = aurt.Robot.from_urdf(exported.files[0])
    rest = numpy.zeros_like(q)
    assert numpy.allclose(again.torque(q, rest, rest), model.gravity(q), rtol=0, atol=1e-6)
    with pytest.raises(aurt.Error, match="none.urdf"):
        model.export("urdf", tmp_path / "out", into=tmp_path / "none.urdf")


def test_exports_that_cannot_be_are_refused(model, tmp_path):
    for arguments, said in (
        ({"target": "cpp"}, "target is `cpp`; it must be one of"),
        ({"target": "c", "kind": "inverse"}, "kind is of the target"),
        ({"target": "fmu"}, 'needs kind="inverse"'),
        ({"target": "c", "into": "robot.urdf"}, "into is of the targets"),
        ({"target": "urdf", "base": "world"}, "the file `into`"),
        ({"target": "urdf"}, "consistent"),
        ({"target": "c", "out": tmp_path / "no" / "folder"}, "not an existing folder"),
    ):
        with pytest.raises(aurt.Error) as caught:
            model.export(**{"out": tmp_path / "out", **arguments})
        assert said in str(caught.value), caught.value
    assert not (tmp_path / "out").exists()


def test_a_right_setup_is_ready(two_link, monday, tuesday):
    checkup = aurt.check([monday, tuesday], robot=two_link)
    assert not checkup.mistakes.size and "monday" in str(checkup) and 1.0 < checkup.suitable_f_dyn_hz < 30.0
    assert len(checkup.reports()) == 2 and checkup.reports()[0].html.lower().startswith("<!doctype html>")
    document = checkup.to_dict()
    assert document["setup"]["before"]["error"] < 0.3 and document["together"]["excitation"]["rank"] > 5
    assert checkup.found == bool(checkup.findings)


def test_degrees_are_told(two_link, monday):
    wrong = aurt.Recording(monday.t, numpy.degrees(monday.q), tau=monday.tau, name="degrees")
    checkup = aurt.check(wrong, robot=two_link)
    assert checkup.found and any("degrees" in finding for finding in checkup.findings), checkup.findings
    assert "degrees" in " ".join(checkup.mistakes["sentence"])
    assert aurt.check(monday).to_dict()["findings"] is not None and "setup" not in aurt.check(monday).to_dict()
    with pytest.raises(aurt.Error, match="no recording"):
        aurt.check([])
    with pytest.raises(aurt.Error, match="f_dyn_hz"):
        aurt.check(monday, f_dyn_hz=0.0)
    with pytest.raises(aurt.Error, match="joints"):
        aurt.check(monday, robot=aurt.Robot.by_name("ur10e"))


def test_the_setup_of_an_experiment_is_checked(experiment):
    checkup = aurt.check_experiment(experiment)
    assert len(checkup.reports()) == 2 and "mistakes" in checkup.to_dict()["setup"]


def test_a_machine_is_followed(experiment, monday, tuesday):
    model = aurt.calibrate_experiment(experiment)
    later = [aurt.simulate("two_link", motion=motion(15.0), seed=seed).named(f"day {seed}") for seed in (5, 6)]
    settings = {"window_s": 1.0, "false_alarm_h": 100.0}
    same = aurt.track(experiment, model, later, **settings)
    assert not same.changed and len(same.alarms) == 0 and len(same.to_dict()["recordings"]) == 2
    rubbing = aurt.simulate(
        "two_link", motion=motion(15.0), seed=7, effects=[{"name": "viscous", "joints": [0], "viscous_nm_s": [6.0]}]
    ).named("rubbing")
    changed = aurt.track(experiment, model, [*later, rubbing], **settings)
    assert changed.changed and set(changed.alarms["certain_recording"]) == {"rubbing"}, str(changed)
    assert list(changed.drift["recording"].unique()) == ["day 5", "day 6", "rubbing"]
    assert "rubbing" in str(changed) and "<svg" in changed.report().html
    # Files and recordings in memory, a model and its file, are the same.
    folder = experiment.parent / "nights"
    folder.mkdir()
    for k, recording in enumerate([*later, rubbing]):
        write(recording, folder / f"{k}.csv")
    model.save(experiment.parent / "rd_calibrated.json")
    files = aurt.track(experiment, experiment.parent / "rd_calibrated.json", folder, **settings)
    assert numpy.allclose(files.drift["value"].astype(float), changed.drift["value"].astype(float), rtol=1e-9, equal_nan=True)
    assert len(files.alarms) == len(changed.alarms)
    for wrong in ({"window_s": 0.5}, {"false_alarm_h": 0.0}, {"load_half_life_s": numpy.nan}):
        with pytest.raises(aurt.Error, match=next(iter(wrong))):
            aurt.track(experiment, model, later, **wrong)
    with pytest.raises(aurt.Error, match="no recording"):
        aurt.track(experiment, model, [])
    with pytest.raises(TypeError, match="recordings must be"):
        aurt.track(experiment, model, 7)
    with pytest.raises(aurt.Error, match="standard input"):
        aurt.track(experiment, model, "-")


def test_gains_come_from_a_known_load(tmp_path):
    text = """
schema = 1
[robot]
name = "ur10e"
gravity_m_s2 = [0.0, 0.0, -9.81]
[[arm_terms]]
model = "rotor_inertia"
joints = [2, 3, 4, 5]
[[arm_terms]]
model = "payload"
link = 5
recordings = ["2.csv", "3.csv"]
[recordings]
calibration = ["0.csv", "1.csv", "2.csv", "3.csv"]
"""
    moving = {"kind": "multi_sine", "duration_s": 12.0, "harmonics": 8, "top_hz": 1.0, "share": 0.6}
    for k in range(4):
        effects = [LOAD] if k > 1 else None
        write(aurt.simulate("ur10e", motion=moving, seed=k + 1, effects=effects, logger={"rate_hz": 125.0}), tmp_path / f"{k}.csv")
    path = tmp_path / "experiment.toml"
    path.write_text(text)
    gains = aurt.gains(path, mass_kg=2.0)
    assert numpy.allclose(gains.torque_constants_nm_per_a, DRIVES, rtol=0.1), str(gains)
    assert set(gains.joints["decided"]) == {"gain"} and gains.measured_in == "A" and gains.instrument_gains is None
    assert "torque_constants_nm_per_a" in str(gains) and gains.to_dict()["gains"]["mass_kg"] == 2.0
    ratios = aurt.gains(path)
    assert ratios.torque_constants_nm_per_a is None and set(ratios.joints["decided"]) == {"ratio"}
    assert aurt.gains(path, mass_kg=2.0, expect=True).to_dict()["is_expectation"]
    with pytest.raises(aurt.Error, match="need mass_kg"):
        aurt.gains(path, mass_std_kg=0.1)
    with pytest.raises(aurt.Error, match="positive"):
        aurt.gains(path, mass_kg=-1.0)
