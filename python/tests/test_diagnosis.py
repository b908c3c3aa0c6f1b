"""Diagnosis: what was put into a simulated robot is named; long work can be stopped."""

import _thread
import pickle
import threading
import time

import numpy
import pytest

import aurt
from conftest import motion


@pytest.fixture(scope="module")
def verdict(two_link, monday, tuesday):
    """Of a spring that appears on joint 1."""
    effects = [{"name": "spring", "joint": 1, "stiffness_nm_rad": 8.0, "rest_rad": 0.3}]
    later = aurt.simulate("two_link", motion=motion(10.0), seed=3, effects=effects).named("wednesday")
    steps = []
    verdict = aurt.diagnose(two_link, [monday, tuesday], target=later, progress=steps.append)
    assert len(steps) > 2
    return verdict


def test_what_was_added_is_named(verdict):
    assert verdict.found and verdict.answer == "named"
    effects = verdict.effects
    assert "spring" in list(effects["effect"]), str(verdict)
    assert verdict.to_dict()["effects"][0]["effect"] == effects["effect"][0]
    assert "spring" in str(verdict) and "spring" in repr(verdict)


def test_the_improved_model_has_it(verdict, monday):
    assert any("spring" in line for line in verdict.added)
    assert any(name.startswith("spring") for name in verdict.model.parameters["name"])
    assert verdict.model.predict(monday).shape == monday.q.shape


def test_the_report_says_it(verdict):
    assert "spring" in verdict.report().html and verdict._repr_html_().startswith("<iframe")
    assert len(verdict.residual) == 2


def test_a_pickled_verdict_is_the_same(verdict, monday):
    copy = pickle.loads(pickle.dumps(verdict))
    for name in ("answer", "structure", "found", "added", "notes"):
        assert getattr(copy, name) == getattr(verdict, name), name
    assert str(copy) == str(verdict) and copy.to_dict() == verdict.to_dict()
    assert copy.report().html == verdict.report().html and copy.report().title == verdict.report().title
    assert numpy.array_equal(copy.model.predict(monday), verdict.model.predict(monday))


def test_nothing_to_diagnose_is_refused(two_link):
    with pytest.raises(aurt.Error, match="no recording"):
        aurt.diagnose(two_link, [])


@pytest.fixture(scope="module")
def long_work():
    """A diagnosis of some seconds, at least."""
    robot = aurt.Robot.by_name("ur10e").model(arm_terms=["rotor_inertia"])
    recordings = [aurt.simulate("ur10e", motion=motion(20.0), seed=seed).named(str(seed)) for seed in (1, 2, 3)]
    return lambda: aurt.diagnose(robot, recordings[:2], target=recordings[2])


def test_ctrl_c_ends_the_waiting(long_work):
    begun, pressed = time.monotonic(), []
    long_work()
    whole = time.monotonic() - begun

    def press():
        pressed.append(time.monotonic())
        _thread.interrupt_main()

    timer = threading.Timer(0.2 * whole, press)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        long_work()
    # What does not listen goes on for four fifths of the work, however busy the machine is.
    assert time.monotonic() - pressed[0] < 0.5 * whole


def test_other_threads_go_on_meanwhile(two_link, monday):
    turns, done = [0], threading.Event()

    def turn():
        while not done.is_set():
            turns[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=turn)
    thread.start()
    begun = time.monotonic()
    q = numpy.zeros((2_000_000, 2))
    aurt.calibrate(two_link, monday).torque(q, q, q)
    took = time.monotonic() - begun
    done.set()
    thread.join()
    # A thread that goes on turns some hundred times a second, one that is held up hardly at all.
    assert turns[0] > 20 * took, (turns, took)

