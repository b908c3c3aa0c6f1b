"""The equation of motion of a calibrated model, and the covariance of its coefficients."""

import ctypes
import pickle
import shutil
import subprocess

import numpy
import pytest

import aurt
from conftest import motion, states


@pytest.fixture(scope="module")
def arm():
    """A UR10e with rotors, a spring, a motor that two joints turn, and load-dependent friction."""
    moving = {"kind": "multi_sine", "duration_s": 15.0, "harmonics": 8, "top_hz": 1.0, "share": 0.6}
    recording = aurt.simulate("ur10e", motion=moving, seed=1, logger={"rate_hz": 125.0})
    terms = [
        {"model": "rotor_inertia", "joints": [2, 3]},
        {"model": "coupling", "joint": 5, "partner": 4},
        {"model": "spring", "joints": [1]},
    ]
    structure = aurt.Robot.by_name("ur10e").model(coulomb="absolute", arm_terms=terms)
    drives = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
    return aurt.calibrate(structure, recording, torque_constants_nm_per_a=drives)


def test_mass_matrices_and_gravity_are_those_of_the_torque(arm, model):
    for one in (model, arm):
        joints = one.joints
        q, dq, ddq = states(700, joints)
        rest = numpy.zeros_like(q)
        mass, gravity = one.mass_matrix(q), one.gravity(q)
        assert mass.shape == (700, joints, joints) and gravity.shape == (700, joints)
        assert numpy.allclose(mass, mass.transpose(0, 2, 1), rtol=0, atol=1e-12)
        assert (numpy.linalg.eigvalsh(mass)[:, -1] > 0.0).all()
        still = one.torque(q, rest, rest)
        for joint in range(joints):
            unit = rest.copy()
            unit[:, joint] = 1.0
            assert numpy.allclose(one.torque(q, rest, unit) - still, mass[:, :, joint], rtol=0, atol=1e-10)
        assert numpy.allclose(one.torque(q, rest, ddq) - still, numpy.einsum("sij,sj->si", mass, ddq), rtol=0, atol=1e-9)
        assert numpy.array_equal(one.mass_matrix(q[3]), mass[3]) and numpy.array_equal(one.gravity(q[3]), gravity[3])
    # Friction holds nothing here, so that all of the torque at rest is weight; only the spring is none.
    assert numpy.allclose(model.torque(q[:, :2], rest[:, :2], rest[:, :2]), model.gravity(q[:, :2]), rtol=0, atol=1e-12)
    spring = arm.torque(q, rest, rest) - arm.gravity(q)
    assert abs(spring[:, 1]).max() > 1e-6 and abs(numpy.delete(spring, 1, axis=1)).max() < 1e-11


def test_a_load_belongs_to_both(two_link, monday):
    load = {"name": "payload", "link": 1, "mass_kg": 3.0, "com_m": [0.1, 0.0, 0.0], "edges_m": [0.1, 0.1, 0.1]}
    loaded = aurt.simulate("two_link", motion=motion(10.0), seed=4, effects=[load])
    verdict = aurt.diagnose(two_link.model(arm_terms=["rotor_inertia"]), monday, target=loaded)
    names = list(verdict.model.parameters["name"])
    assert any(name.startswith("payload.m") for name in names), names
    q, _, _ = states(20, 2)
    rest = numpy.zeros_like(q)
    heavier = verdict.model
    mass = heavier.mass_matrix(q)
    values = dict(zip(names, heavier.parameters["value"]))
    assert values["payload.ZZ_1"] > 0.02
    assert numpy.allclose(mass[:, 1, 1], values["ZZ_1"] + values["rotor_inertia.I_a_1"] + values["payload.ZZ_1"], rtol=1e-12)
    for joint in range(2):
        unit = numpy.eye(2)[joint] + rest
        assert numpy.allclose(heavier.torque(q, rest, unit) - heavier.torque(q, rest, rest), mass[:, :, joint], rtol=0, atol=1e-9)
    assert numpy.allclose(heavier.torque(q, rest, rest), heavier.gravity(q), rtol=0, atol=1e-9)


def test_they_are_those_of_the_exported_program(two_link, monday, tmp_path):
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("there is no C compiler")
    terms = [{"model": "rotor_inertia", "joints": [1]}]
    model = aurt.calibrate(two_link.model(arm_terms=terms), monday)
    exported = model.export("c", tmp_path, name="arm")
    sources = [str(path) for path in exported.files if path.name == "arm.c"]
    library = tmp_path / "arm.so"
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-ffp-contract=off", "-o", library, *sources, "-lm"], check=True)
    arm = ctypes.CDLL(str(library))
    doubles = lambda count: (ctypes.c_double * count)()  # noqa: E731
    q, _, _ = states(20, 2)
    for position, mass, gravity in zip(q, model.mass_matrix(q), model.gravity(q)):
        given, m, g = (ctypes.c_double * 2)(*position), doubles(4), doubles(2)
        arm.arm_mass_matrix(given, m)
        arm.arm_gravity(given, g)
        assert numpy.allclose(numpy.reshape(m, (2, 2)), mass, rtol=0, atol=1e-12)
        assert numpy.allclose(g, gravity, rtol=0, atol=1e-11)


def test_positions_that_cannot_be_are_refused(model):
    for call in (model.mass_matrix, model.gravity):
        with pytest.raises(aurt.Error, match=r"q has the shape \(2, 10\).*transpose"):
            call(numpy.zeros((2, 10)))
        with pytest.raises(aurt.Error, match="q: sample 5 of joint 1 is"):
            call(numpy.where(numpy.arange(20).reshape(10, 2) == 11, numpy.nan, 0.0))
    assert model.mass_matrix(numpy.zeros((0, 2))).shape == (0, 2, 2)
    many = states((1 << 16) + 300, 2)[0]
    for k in (0, 256, 1 << 16, len(many) - 1):
        assert numpy.allclose(model.mass_matrix(many[k]), model.mass_matrix(many)[k], rtol=1e-14, atol=0)


@pytest.mark.parametrize("estimator", ["wls", "ols", "irls", "consistent", "essential"])
def test_deviations_are_roots_of_the_covariance(two_link, monday, tuesday, estimator):
    structure = two_link.model(viscous={"model": "polynomial", "powers": [1, 3]}, arm_terms=["rotor_inertia"])
    model = aurt.calibrate(structure, [monday, tuesday], estimator=estimator)
    rows, covariance = model.parameters, model.covariance
    assert covariance.shape == (len(rows), len(rows))
    excited = rows["excited"].to_numpy(dtype=bool)
    assert numpy.isnan(covariance[~excited]).all() and numpy.isnan(covariance[:, ~excited]).all()
    known = covariance[numpy.ix_(excited, excited)]
    assert numpy.array_equal(known, known.T)
    deviations = numpy.sqrt(numpy.diag(known))
    assert numpy.array_equal(deviations, rows["std_dev"][excited].to_numpy(dtype=float))
    correlation = known / numpy.outer(deviations, deviations)
    assert numpy.linalg.eigvalsh(correlation).min() > -1e-9 and abs(correlation).max() <= 1.0 + 1e-9


def test_the_covariance_tells_how_estimates_scatter(two_link):
    """Estimates from forty recordings of one motion, against the covariance that each states."""
    planned = aurt.simulate("two_link", motion=motion(6.0), seed=1)
    # The machine is the structure itself, its noise white.
    truth = aurt.calibrate(two_link, planned)
    q = truth.simulate(planned).q
    t = truth.simulate(planned).t
    clean = truth.predict(aurt.Recording(t, q))
    random = numpy.random.default_rng(1)
    fits = [
        aurt.calibrate(two_link, aurt.Recording(t, q, tau=clean + random.normal(0.0, 3.0, clean.shape)), f_dyn_hz=10.0)
        for _ in range(40)
    ]
    stated = numpy.mean([fit.covariance for fit in fits], axis=0)
    found = numpy.cov(numpy.stack([fit.coefficients for fit in fits]).T)
    scale = numpy.sqrt(numpy.diag(stated))
    ratio = numpy.diag(found) / numpy.diag(stated)
    # χ² with 39 degrees of freedom over 39: 0.5 to 1.7 with 99.9 %, and what is stated is never below white noise.
    assert (ratio > 0.2).all() and (ratio < 1.8).all(), ratio
    difference = (found / numpy.outer(*2 * [numpy.sqrt(numpy.diag(found))])) - stated / numpy.outer(scale, scale)
    assert abs(difference).max() < 0.6, difference


def test_saved_and_pickled_models_keep_it(model, tmp_path):
    path = tmp_path / "rd_calibrated.json"
    model.save(path)
    for copy in (aurt.Model.load(path), pickle.loads(pickle.dumps(model))):
        assert numpy.array_equal(copy.covariance, model.covariance, equal_nan=True)
    text = path.read_text()
    begin = text.index('"covariance": [')
    path.write_text(text[:begin] + '"covariance": []' + text[text.index("]", begin) + 1 :])
    with pytest.raises(aurt.Error, match="calibrate again"):
        aurt.Model.load(path).covariance
    path.write_text(text[:begin] + '"covariance": [1.0, 2.0]' + text[text.index("]", begin) + 1 :])
    with pytest.raises(aurt.Error, match="covariance` has 2 entries"):
        aurt.Model.load(path)
