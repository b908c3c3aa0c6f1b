"""Stamps as loggers have them: dates and durations of NumPy, Python, pandas, polars and Arrow; tables of Arrow as recordings."""

import datetime

import numpy
import pandas
import polars
import pytest

import aurt
from conftest import states

BEGIN = numpy.datetime64("2026-03-01T12:00:00.250000000", "ns")
ZONE = datetime.timezone(datetime.timedelta(hours=2))


@pytest.fixture(scope="module")
def nanoseconds(monday):
    """Its stamps in whole ns."""
    return (monday.t * 1e9).round().astype("timedelta64[ns]")


@pytest.fixture(scope="module")
def expected(nanoseconds):
    """The same in s."""
    return nanoseconds.astype("int64") / 1e9


def durations(ns):
    """Durations of every kind."""
    yield "numpy", ns
    yield "numpy us", ns.astype("timedelta64[us]")
    yield "python", [datetime.timedelta(microseconds=int(x)) for x in ns.astype("timedelta64[us]").astype(int)]
    yield "pandas", pandas.Series(ns)
    yield "pandas index", pandas.TimedeltaIndex(ns)
    yield "polars", polars.Series(ns)


def dates(ns):
    """Dates of every kind; with a zone they are the same moments."""
    stamps = BEGIN + ns
    python = [datetime.datetime(2026, 3, 1, 12, 0, 0, 250_000) + x for _, l in durations(ns) if _ == "python" for x in l]
    aware = [x.replace(tzinfo=datetime.timezone.utc).astimezone(ZONE) for x in python]
    yield "numpy", stamps
    yield "numpy ms", stamps.astype("datetime64[ms]")
    yield "python", python
    yield "python aware", aware
    yield "pandas", pandas.Series(stamps)
    yield "pandas index", pandas.DatetimeIndex(stamps)
    yield "pandas zone", pandas.Series(pandas.DatetimeIndex(stamps).tz_localize("UTC").tz_convert("Europe/Copenhagen"))
    yield "pandas index zone", pandas.DatetimeIndex(stamps).tz_localize("UTC").tz_convert("Europe/Copenhagen")
    yield "pandas objects", pandas.Series(list(pandas.DatetimeIndex(stamps).tz_localize("UTC")), dtype=object)
    yield "polars", polars.Series(stamps)
    yield "polars zone", polars.Series(stamps).dt.replace_time_zone("UTC").dt.convert_time_zone("Europe/Copenhagen")


def test_durations_are_seconds(monday, nanoseconds, expected):
    for kind, t in durations(nanoseconds):
        recording = aurt.Recording(t, monday.q, tau=monday.tau)
        exact = kind not in ("numpy us", "python")
        assert numpy.allclose(recording.t, expected, rtol=0, atol=0 if exact else 1e-6), kind
        assert recording.origin_s == 0.0


def test_dates_count_from_the_first_whole_second(monday, nanoseconds, expected):
    whole = float(BEGIN.astype("datetime64[s]").astype(int))
    for kind, t in dates(nanoseconds):
        recording = aurt.Recording(t, monday.q, tau=monday.tau)
        tolerance = {"numpy ms": 1e-3, "python": 1e-6, "python aware": 1e-6}.get(kind, 1e-12)
        assert numpy.allclose(recording.t, expected + 0.25, rtol=0, atol=tolerance), kind
        assert recording.origin_s == whole, kind
    assert aurt.Recording(monday.t, monday.q).origin_s == 0.0


def test_motions_have_dates_too(two_link, monday):
    model = aurt.calibrate(two_link.model(hysteresis="dahl"), monday, fit_shapes=False)
    q, dq, ddq = states(50, 2)
    t = 0.002 * numpy.arange(50)
    dated = BEGIN + (t * 1e9).round().astype("timedelta64[ns]")
    assert numpy.allclose(model.torque(q, dq, ddq, dated), model.torque(q, dq, ddq, t), rtol=1e-9)


def test_stamps_that_cannot_be_are_refused(monday, nanoseconds):
    missing = nanoseconds.copy()
    missing[3] = numpy.timedelta64("NaT")
    with pytest.raises(aurt.Error, match="stamp 3 of t is NaN"):
        aurt.Recording(missing, monday.q)
    with pytest.raises(aurt.Error, match="stamp 7 of t is NaN"):
        lost = [None if k == 7 else x for k, x in enumerate(dict(dates(nanoseconds))["python"])]
        aurt.Recording(lost, monday.q)
    with pytest.raises(aurt.Error, match="lies before the one before it"):
        aurt.Recording((BEGIN + nanoseconds)[::-1], monday.q)
    mixed = dict(dates(nanoseconds))
    with pytest.raises(TypeError, match="time zone"):
        aurt.Recording([mixed["python aware"][0], *mixed["python"][1:]], monday.q)
    with pytest.raises(TypeError, match="datetime64"):
        aurt.Recording(monday.t, numpy.full(monday.q.shape, BEGIN))


def columns(recording, clock, name="timestamp"):
    table = {} if name is None else {name: clock}
    for joint in range(recording.joints):
        table[f"actual_q_{joint}"] = recording.q[:, joint]
        table[f"torque_{joint}"] = recording.tau[:, joint]
    return table


def same(recording, other, t):
    return (
        numpy.allclose(recording.t, t, rtol=0, atol=1e-12)
        and numpy.array_equal(recording.q, other.q)
        and numpy.array_equal(recording.tau, other.tau)
    )


@pytest.mark.parametrize("name", ["timestamp", "time", "time_ms", "timestamp_ns"])
def test_clocks_of_frames_are_dates_or_durations(monday, nanoseconds, expected, name):
    stamps = BEGIN + nanoseconds
    for frame in (pandas.DataFrame, polars.DataFrame):
        assert same(aurt.Recording(frame(columns(monday, nanoseconds, name))), monday, expected)
        recording = aurt.Recording(frame(columns(monday, stamps, name)))
        assert same(recording, monday, expected + 0.25) and recording.origin_s > 1.7e9
        with pytest.raises(aurt.Error, match="leave out the argument time"):
            aurt.Recording(frame(columns(monday, stamps, name)), time="ms")


def test_an_index_of_dates_is_a_clock(monday, nanoseconds, expected):
    stamps = pandas.DatetimeIndex(BEGIN + nanoseconds)
    plain = pandas.DataFrame(columns(monday, None, None), index=stamps)
    assert same(aurt.Recording(plain), monday, expected + 0.25)
    assert same(aurt.Recording(plain.tz_localize("Asia/Tokyo")), monday, expected + 0.25)
    assert same(aurt.Recording(plain.rename_axis("when"), columns={"time": "when"}), monday, expected + 0.25)
    # A clock among the columns goes first.
    assert same(aurt.Recording(plain.assign(time=monday.t)), monday, monday.t)
    other = pandas.DataFrame({**columns(monday, monday.t), "written": stamps})
    assert same(aurt.Recording(other), monday, monday.t)


def test_arrow_tables_are_recordings(monday, nanoseconds, expected):
    pyarrow = pytest.importorskip("pyarrow")
    table = pyarrow.table({**columns(monday, monday.t), "remark": ["a word"] * len(monday)})
    assert same(aurt.Recording(table), monday, monday.t)
    assert same(aurt.Recording(table.to_batches()[0]), monday, monday.t)
    dated = pyarrow.table(columns(monday, pyarrow.array(BEGIN + nanoseconds, pyarrow.timestamp("ns", tz="UTC"))))
    assert same(aurt.Recording(dated), monday, expected + 0.25)
    chunked = pyarrow.concat_tables([table.slice(0, 100), table.slice(100)])
    assert same(aurt.Recording(chunked), monday, monday.t)
    listed = pyarrow.table({"time": monday.t, "q": monday.q.tolist(), "torque": monday.tau.tolist()})
    assert same(aurt.Recording(listed), monday, monday.t)
    holed = table.set_column(1, "actual_q_0", [[None, *monday.q[1:, 0]]])
    with pytest.raises(aurt.Error, match="line 2"):
        aurt.Recording(holed)
    with pytest.raises(aurt.Error, match="two columns"):
        aurt.Recording(pyarrow.table([monday.t, monday.q[:, 0], monday.q[:, 0]], names=["time", "q_0", "q_0"]))
