"""What a person sees of the package: signatures, help, types, metadata."""

import importlib.metadata
import inspect
import json
import pathlib
import re
import subprocess
import sys

import pytest

import aurt
from test_commands import experiment  # noqa: F401

PACKAGE = pathlib.Path(__file__).parents[1]
PUBLIC = [getattr(aurt, name) for name in aurt.__all__ if name != "__version__"]


def methods(kind):
    return [member for name, member in vars(kind).items() if not name.startswith("_")]


def test_everything_public_says_what_it_is():
    silent = [
        getattr(thing, "__qualname__", str(thing))
        for thing in [*PUBLIC, *(m for kind in PUBLIC if inspect.isclass(kind) for m in methods(kind))]
        if not (inspect.getdoc(thing) or "").strip() and not isinstance(thing, (str, tuple, bool))
    ]
    assert silent == []


def test_signatures_show_options_and_defaults():
    for function in (aurt.calibrate, aurt.diagnose):
        options = inspect.signature(function).parameters
        assert options["f_dyn_hz"].default == 10.0 and options["estimator"].default == "wls" and len(options) >= 20
        for name in options:
            assert name in function.__doc__, f"{function.__name__} says nothing of {name}"
    vague = [
        f.__qualname__
        for kind in PUBLIC
        for f in ([kind] if inspect.isbuiltin(kind) else methods(kind) if inspect.isclass(kind) else [])
        if callable(f) and any(p.kind is p.VAR_KEYWORD for p in inspect.signature(f).parameters.values())
    ]
    # The keywords of a simulation are the keys of a scenario's file.
    assert vague == ["simulate"]


def test_defaults_are_those_of_experiments(experiment, two_link, monday, tmp_path):  # noqa: F811
    structure = two_link.model(arm_terms=[{"model": "rotor_inertia", "joints": [1]}])
    said = {}
    for name, model in (("call", aurt.calibrate(structure, monday)), ("file", aurt.calibrate_experiment(experiment))):
        model.save(tmp_path / f"{name}.json")
        document = json.loads((tmp_path / f"{name}.json").read_text())
        said[name] = [document["preprocess"], document["instrument"], document["calibration"]["options"]]
    assert said["call"] == said["file"]


def test_unknown_keywords_and_wrong_types_are_refused(two_link, monday):
    with pytest.raises(TypeError, match="unexpected keyword argument 'f_dyn'"):
        aurt.calibrate(two_link, monday, f_dyn=5.0)
    with pytest.raises(TypeError, match="f_dyn_hz"):
        aurt.calibrate(two_link, monday, f_dyn_hz="ten")
    with pytest.raises(TypeError, match="trim_rest"):
        aurt.calibrate(two_link, monday, trim_rest="yes")


def test_metadata_is_what_an_index_needs():
    metadata = importlib.metadata.metadata("aurt-dynamics")
    assert metadata["License-Expression"] == "MIT OR Apache-2.0" and "AURT" in (metadata["Author"] or metadata["Author-email"])
    assert set(metadata.get_all("License-File")) == {"LICENSE-MIT", "LICENSE-APACHE"}
    assert metadata["Requires-Python"] == ">=3.9" and "Typing :: Typed" in metadata.get_all("Classifier")
    files = [str(file) for file in importlib.metadata.files("aurt-dynamics")]
    assert sum(bool(re.search("licenses/LICENSE", file)) for file in files) == 2
    # An index shows the description alone: what it links to has to be absolute.
    links = re.findall(r"\]\(([^)]*)\)", metadata.get_payload() or metadata["Description"])
    assert all(link.startswith("https://") for link in links), links


def mypy(*arguments):
    pytest.importorskip("mypy")
    return subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=PACKAGE, timeout=300)


def test_a_typed_program_is_accepted_and_runs(tmp_path):
    program = PACKAGE / "tests" / "typed_program.py"
    checked = mypy("mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), str(program))
    assert checked.returncode == 0, checked.stdout
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import aurt\n\naurt.calibrate(aurt.Robot.by_name('ur10e'), aurt.simulate('ur10e'), f_dyn_hz='ten')\n")
    refused = mypy("mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), str(wrong))
    assert refused.returncode == 1 and "f_dyn_hz" in refused.stdout, refused.stdout
    subprocess.run([sys.executable, program, tmp_path], check=True, timeout=300)


def test_the_stub_is_what_the_compiled_part_has():
    checked = mypy("mypy.stubtest", "aurt._aurt", "--mypy-config-file", str(PACKAGE / "pyproject.toml"))
    assert checked.returncode == 0, checked.stdout
