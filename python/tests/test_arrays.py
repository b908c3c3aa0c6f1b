"""Arrays as users have them: any layout gives the same result, and what cannot be is refused with its reason."""

import pickle
from pathlib import Path

import numpy
import pandas
import polars
import pytest

import aurt
from conftest import states


@pytest.fixture(scope="module")
def given(monday):
    """Stamps, positions and torques."""
    return monday.t, monday.q, monday.tau


def same(a, b):
    """Whether two recordings hold the same numbers."""
    return numpy.array_equal(a.t, b.t) and numpy.array_equal(a.q, b.q) and numpy.array_equal(a.tau, b.tau)


def test_layout_and_owner_make_no_difference(given):
    t, q, tau = given
    plain = aurt.Recording(t, q, tau=tau)
    frozen = q.copy()
    frozen.flags.writeable = False
    strided = numpy.repeat(q, 3, axis=0)[::3]
    backwards = q[::-1].copy()[::-1]
    swapped = q.astype(">f8")
    for other in (numpy.asfortranarray(q), frozen, strided, backwards, swapped, q.tolist(), pandas.DataFrame(q), polars.DataFrame(q)):
        assert same(aurt.Recording(t, other, tau=tau), plain)
    assert same(aurt.Recording(list(t), q, tau=tau.astype(object).astype(float)), plain)
    assert numpy.allclose(aurt.Recording(t, q.astype(numpy.float32)).q, q, atol=1e-6)
    assert numpy.array_equal(aurt.Recording([0, 1], [[1, 2], [3, 4]]).q, [[1.0, 2.0], [3.0, 4.0]])


def test_torques_of_any_layout_are_the_same(model):
    q, dq, ddq = states(1000, 2)
    expected = model.torque(q, dq, ddq)
    assert expected.shape == (1000, 2) and expected.flags.c_contiguous
    assert numpy.array_equal(model.torque(*(numpy.asfortranarray(x) for x in (q, dq, ddq))), expected)
    assert numpy.array_equal(model.torque(*(numpy.repeat(x, 2, axis=1)[:, ::2] for x in (q, dq, ddq))), expected)
    assert numpy.array_equal(model.torque(q[::-1], dq[::-1], ddq[::-1]), expected[::-1])
    assert numpy.array_equal(model.torque(q[7], dq[7], ddq[7]), model.torque(q[7:8], dq[7:8], ddq[7:8])[0])
    assert model.torque(q[:0], dq[:0], ddq[:0]).shape == (0, 2)


@pytest.mark.parametrize(
    ("change", "error", "said"),
    [
        (lambda t, q, tau: (t, q.T, tau), aurt.Error, "transpose it: q.T"),
        (lambda t, q, tau: (t, q, tau.T), aurt.Error, "tau has the shape (2, "),
        (lambda t, q, tau: (t[:-1], q, tau), aurt.Error, "stamps for"),
        (lambda t, q, tau: (t, q, tau[:-1]), aurt.Error, "measurements of joint 0"),
        (lambda t, q, tau: (t, q, tau[:, :1]), aurt.Error, "(samples, 2)"),
        (lambda t, q, tau: (t, q[:, :, None], tau), aurt.Error, "q has the shape"),
        (lambda t, q, tau: (t[:, None], q, tau), aurt.Error, "t has the shape"),
        (lambda t, q, tau: (t[::-1], q, tau), aurt.Error, "lies before the one before it"),
        (lambda t, q, tau: (numpy.where(t == t[3], numpy.nan, t), q, tau), aurt.Error, "stamp 3 of t is NaN"),
        (lambda t, q, tau: (t, q + 1j, tau), TypeError, "complex128"),
        (lambda t, q, tau: (t, q > 0, tau), TypeError, "bool"),
        (lambda t, q, tau: (t, q.astype(str), tau), TypeError, "must be real numbers"),
        (lambda t, q, tau: (t, q.astype("datetime64[s]"), tau), TypeError, "datetime64"),
        (lambda t, q, tau: (t, numpy.ma.masked_greater(q, 0.0), tau), aurt.Error, "masked"),
        (lambda t, q, tau: (t, [[1.0], [1.0, 2.0]], tau), TypeError, "no array of numbers"),
        (lambda t, q, tau: (t, q[:, :0], tau), aurt.Error, "q has the shape"),
    ],
)
def test_what_cannot_be_is_refused(given, change, error, said):
    t, q, tau = change(*given)
    with pytest.raises(error) as caught:
        aurt.Recording(t, q, tau=tau)
    assert said in str(caught.value)


@pytest.mark.parametrize("value", [numpy.nan, numpy.inf])
def test_numbers_that_are_none_are_refused_with_their_place(given, model, value):
    t, q, tau = given
    spoilt = tau.copy()
    spoilt[5, 1] = value
    with pytest.raises(aurt.Error, match="sample 5 of the measurements of joint 1 is not finite"):
        aurt.Recording(t, q, tau=spoilt)
    motion = states(600, 2)
    motion[2][517, 1] = value
    with pytest.raises(aurt.Error, match="ddq: sample 517 of joint 1"):
        model.torque(*motion)


def test_other_shapes_of_motions_are_refused(model):
    q, dq, ddq = states(10, 2)
    with pytest.raises(aurt.Error, match=r"q has the shape \(2, 10\).*transpose it: q.T"):
        model.torque(q.T, dq.T, ddq.T)
    with pytest.raises(aurt.Error, match=r"dq has the shape \(10, 1\)"):
        model.torque(q, dq[:, :1], ddq)
    with pytest.raises(aurt.Error, match="q has 10 samples, ddq has 9"):
        model.torque(q, dq, ddq[:-1])
    with pytest.raises(aurt.Error, match="shape"):
        model.torque(0.0, 0.0, 0.0)
    with pytest.raises(TypeError):
        model.torque(None, dq, ddq)


def table(recording):
    """A recording as columns by their usual names."""
    columns = {"timestamp": recording.t}
    for joint in range(recording.joints):
        columns[f"actual_q_{joint}"] = recording.q[:, joint]
        columns[f"torque_{joint}"] = recording.tau[:, joint]
    return columns


def test_frames_are_read_by_the_names_of_their_columns(monday):
    columns = table(monday)
    frame = pandas.DataFrame({**columns, "remark": "a word"})
    assert same(aurt.Recording(frame), monday)
    assert same(aurt.Recording(polars.DataFrame(columns), name="a log"), monday)
    assert aurt.Recording(polars.DataFrame(columns), name="a log").name == "a log"
    assert same(aurt.Recording(frame.set_index("timestamp")), monday)
    shuffled = frame[sorted(frame.columns, reverse=True)]
    assert same(aurt.Recording(shuffled), monday)


def test_frames_that_cannot_be_read_are_refused(monday):
    frame = pandas.DataFrame(table(monday))
    doubled = pandas.concat([frame, frame[["actual_q_1"]]], axis=1)
    with pytest.raises(aurt.Error, match="frame, line 1: there are two columns `actual_q` with number 1"):
        aurt.Recording(doubled)
    with pytest.raises(aurt.Error, match="my frame.*position"):
        aurt.Recording(frame[["timestamp", "torque_0", "torque_1"]], name="my frame")
    holed = frame.copy()
    holed.loc[3, "actual_q_0"] = numpy.nan
    with pytest.raises(aurt.Error, match="line 5"):
        aurt.Recording(holed)
    with pytest.raises(aurt.Error):
        aurt.Recording(frame[:0])


def test_files_are_read(monday, tmp_path):
    path = tmp_path / "monday.csv"
    pandas.DataFrame(table(monday)).to_csv(path, index=False)
    for written in (path, str(path)):
        assert same(aurt.Recording(written), monday)
    with pytest.raises(aurt.Error, match="none.csv"):
        aurt.Recording(tmp_path / "none.csv")
    with pytest.raises(TypeError):
        aurt.Recording(7)
    with pytest.raises(TypeError, match="need q"):
        aurt.Recording(path, tau=monday.tau)


def test_a_recording_gives_back_what_it_was_given(given):
    t, q, tau = given
    recording = aurt.Recording(t, q, 2.0 * q, current=tau, name="monday")
    assert recording.name == "monday" and len(recording) == len(t) and recording.joints == 2
    assert numpy.array_equal(recording.dq, 2.0 * q) and numpy.array_equal(recording.current, tau)
    assert recording.tau is None and recording.unit == "A"
    part = recording.window(1.0, 2.0)
    assert t[0] + 1.0 <= part.t[0] and part.t[-1] <= t[0] + 2.0
    with pytest.raises(aurt.Error, match="holds no samples"):
        recording.window(1e6, 2e6)
    with pytest.raises(aurt.Error, match="not both"):
        aurt.Recording(t, q, tau=tau, current=tau)
    with pytest.raises(aurt.Error, match="unit"):
        aurt.Recording(t, q, tau=tau, unit="A")
    with pytest.raises(aurt.Error, match='one of "Nm", "A"'):
        aurt.Recording(t, q, tau=tau, unit="mA")


def test_what_a_frame_or_a_bag_does_not_tell_is_said(monday):
    degrees = numpy.degrees(monday.q)
    frame = pandas.DataFrame(
        {"clock": 1e3 * monday.t, "a": degrees[:, 0], "b": degrees[:, 1], "x": monday.tau[:, 0], "y": monday.tau[:, 1]}
    )
    columns = {"time": "clock", "position": ["a", "b"], "measurement": ["x", "y"]}
    said = {"columns": columns, "angle": "deg", "time": "ms", "unit": "Nm", "joint_names": ["left", "right"]}
    recording = aurt.Recording(frame, **said)
    assert numpy.allclose(recording.q, monday.q, rtol=0, atol=1e-15) and numpy.allclose(recording.t, monday.t, rtol=0, atol=1e-12)
    assert numpy.array_equal(recording.tau, monday.tau) and recording.joint_names == ["left", "right"]
    bag = Path(__file__).parents[2] / "examples" / "urdf-bag" / "monday.mcap"
    assert aurt.Recording(bag, topic="/joint_states", unit="A").joints == 6
    with pytest.raises(aurt.Error, match="there is no topic `/nothing`"):
        aurt.Recording(bag, topic="/nothing", unit="A")


def test_a_pickled_recording_is_the_same(monday, tmp_path):
    bag = aurt.Recording(Path(__file__).parents[2] / "examples" / "urdf-bag" / "monday.mcap", unit="A")
    dates = aurt.Recording(numpy.datetime64("2026-01-05T08:00:00.25", "ms") + numpy.arange(50), numpy.ones((50, 2)))
    for recording in (monday, bag, dates, bag.window(0.5, 1.5).named("part")):
        copy = pickle.loads(pickle.dumps(recording))
        for name in ("name", "joint_names", "unit", "origin_s", "notes", "duration_s"):
            assert getattr(copy, name) == getattr(recording, name), name
        for name in ("t", "q", "dq", "tau", "current"):
            own, other = getattr(recording, name), getattr(copy, name)
            assert own is other is None or numpy.array_equal(own, other), name
        assert repr(copy) == repr(recording)
    restored, parts = monday.__reduce__()
    with pytest.raises(ValueError, match="no pickled recording"):
        restored(*parts[:-1], "{}")
    with pytest.raises(aurt.Error, match="positions of joint"):
        restored(parts[0][1:], *parts[1:])
