"""Experiments in files do what the same calls on arrays do."""

import numpy
import pandas
import pytest

import aurt
from conftest import TWO_LINK

EXPERIMENT = """
schema = 1
[robot]
mdh = "mdh.csv"
gravity_m_s2 = [0.0, -9.81, 0.0]
[joint_dynamics]
coulomb = { model = "constant" }
hysteresis = { model = "sign" }
viscous = { model = "polynomial", powers = [1] }
[recordings]
calibration = ["monday.csv"]
validation = ["tuesday.csv"]
[preprocess]
f_dyn_hz = 10.0
"""


@pytest.fixture(scope="module")
def experiment(tmp_path_factory, monday, tuesday):
    """The file of an experiment, with its recordings."""
    folder = tmp_path_factory.mktemp("experiment")
    for recording in (monday, tuesday):
        columns = {"time": recording.t}
        for joint in range(2):
            columns[f"q_{joint}"], columns[f"torque_{joint}"] = recording.q[:, joint], recording.tau[:, joint]
        pandas.DataFrame(columns).to_csv(folder / f"{recording.name}.csv", index=False)
    (folder / "mdh.csv").write_text(TWO_LINK)
    (folder / "experiment.toml").write_text(EXPERIMENT)
    return folder / "experiment.toml"


def test_an_experiment_gives_the_model_of_the_same_call(experiment, model):
    of_file = aurt.calibrate_experiment(experiment)
    assert numpy.allclose(of_file.coefficients, model.coefficients, rtol=1e-12)
    assert len(of_file.errors) == 4 and "joint" in of_file.report().html


def test_an_experiment_is_diagnosed(experiment):
    before = sorted(path.name for path in experiment.parent.iterdir())
    verdict = aurt.diagnose_experiment(experiment)
    # The simulated machine has rotors, of which the experiment says nothing.
    assert verdict.found and "rotor_inertia" in list(verdict.effects["effect"]), str(verdict)
    assert "rotor_inertia" in verdict.report().html and verdict.model.joints == 2
    assert sorted(path.name for path in experiment.parent.iterdir()) == before


def test_mistakes_are_told_with_their_places(experiment):
    wrong = experiment.with_name("wrong.toml")
    wrong.write_text(EXPERIMENT.replace("f_dyn_hz", "f_dyn"))
    for call in (aurt.calibrate_experiment, aurt.diagnose_experiment):
        with pytest.raises(aurt.Error, match="f_dyn"):
            call(wrong)
        with pytest.raises(aurt.Error, match="none.toml"):
            call(experiment.with_name("none.toml"))
    wrong.unlink()


def test_variants_are_ranked_and_kept(experiment, tmp_path):
    path = experiment.with_name("sweep.toml")
    path.write_text(EXPERIMENT + """
[sweep.grid]
"joint_dynamics.viscous.powers" = [[1], [1, 3]]

[[sweep.variant]]
name = "links alone"

[[sweep.variant]]
name = "with rotors"
set = { arm_terms = [{ model = "rotor_inertia" }] }
""")
    steps = []
    sweep = aurt.sweep(path, tmp_path / "sweep", progress=steps.append)
    assert len(sweep) == 4 and len(sweep.failed) == 0
    assert list(sweep.table["rank"]) == [1, 2, 3, 4] and sweep.best == sweep.table["name"][0]
    # The simulated machine has rotors.
    assert "with rotors" in sweep.best, str(sweep)
    assert sweep.table["score"][0] < 0.9 and len(sweep.table["nrmse_percent"][0]) == 2
    assert steps.count("a point is done") == 4
    # What has a result is not computed again.
    steps.clear()
    again = aurt.sweep(path, tmp_path / "sweep", rows="moving", progress=steps.append)
    assert steps == ["4 points, 4 of them have their result"] and again.document["rows"] == "moving"
    with pytest.raises(aurt.Error, match="all"):
        aurt.sweep(path, tmp_path / "sweep", rows="some")
    with pytest.raises(aurt.Error, match="sweep"):
        aurt.sweep(experiment, tmp_path / "none")
