"""Between the compiled part and Python: rows as data frames, NumPy's numbers as plain ones."""

from __future__ import annotations

import datetime
import sys
from typing import Any

import numpy


def rows(list_of_dicts: list[dict[str, Any]]) -> Any:
    """The rows as a data frame where pandas is installed, else as they are."""
    try:
        import pandas  # type: ignore[import-untyped, unused-ignore]
    except ImportError:
        return list_of_dicts
    return pandas.DataFrame(list_of_dicts)


def plain(value: Any) -> Any:
    """What JSON has for an array or number of NumPy."""
    for method in ("tolist", "item"):
        if hasattr(value, method):
            return getattr(value, method)()
    raise TypeError(f"{type(value).__name__} is neither text nor a number, list or dict")


def seconds(values: Any) -> tuple[Any, float] | None:
    """Dates or durations as s, with what they count from: dates, s from 1970 to the first whole second; durations, 0. None of
    anything else."""
    moments = _moments(values)
    if moments is None:
        return None
    second = numpy.timedelta64(1, "s")
    if moments.dtype.kind == "m":
        return moments / second, 0.0
    known = moments[~numpy.isnat(moments)]
    if known.size == 0:
        return numpy.full(moments.shape, numpy.nan), 0.0
    origin = known.ravel()[0].astype("datetime64[s]")
    return (moments - origin) / second, float(origin.astype("int64"))


def _moments(values: Any) -> Any:
    """An array of datetime64 or timedelta64 of what holds dates (with a time zone: in UTC) or durations, else None."""
    if getattr(getattr(values, "dtype", None), "tz", None) is not None:
        values = values.dt.tz_convert(None) if hasattr(values, "dt") else values.tz_convert(None)
    try:
        array = numpy.asarray(values)
    except (TypeError, ValueError):
        return None
    if array.dtype.kind in "mM":
        return array
    if array.dtype.kind != "O" or array.ndim != 1 or array.size == 0:
        return None
    present = [value for value in array if not _is_missing(value)]
    kinds = {datetime.datetime: "datetime64[ns]", datetime.timedelta: "timedelta64[ns]"}
    kind = next((kind for kind in kinds if present and isinstance(present[0], kind)), None)
    if kind is None or not all(isinstance(value, kind) for value in present):
        return None
    zones = {value.tzinfo is not None for value in present} if kind is datetime.datetime else {False}
    if len(zones) > 1:
        raise TypeError("some of the dates have a time zone and others have none; give all of them one")
    return numpy.array(["NaT" if _is_missing(value) else _moment(value) for value in array], dtype=kinds[kind])


def _is_missing(value: Any) -> bool:
    return value is None or type(value).__name__ in ("NaTType", "NAType") or isinstance(value, float) and value != value


def _moment(value: Any) -> Any:
    """A datetime or timedelta, of Python or pandas, as NumPy has it."""
    if isinstance(value, datetime.datetime) and value.tzinfo is not None:
        value = value.astimezone(datetime.timezone.utc).replace(tzinfo=None)
    for method in ("to_datetime64", "to_timedelta64"):
        if hasattr(value, method):
            return getattr(value, method)()
    return numpy.datetime64(value) if isinstance(value, datetime.datetime) else numpy.timedelta64(value)


def columns(frame: Any) -> list[tuple[str, Any, float | None]]:
    """The columns of numbers of a frame or an Arrow table, by name; an index with a name, or one of dates without, which has
    the name "", comes first. Dates and durations are in s, with what they count from (see `seconds`), numbers with None. Lists
    of n numbers are n columns, name_0 and so on."""
    if hasattr(frame, "iloc"):
        series = [(str(name), frame.iloc[:, k]) for k, name in enumerate(frame.columns)]
        index = frame.index
        if index.name is None:
            if _moments(index) is not None:
                series.insert(0, ("", index))
        elif index.name not in frame.columns:
            series.insert(0, (str(index.name), index))
    elif hasattr(frame, "get_columns"):
        series = [(column.name, column) for column in frame.get_columns()]
    elif hasattr(frame, "schema") and hasattr(frame.schema, "names"):
        series = list(zip(frame.schema.names, frame.columns))
    else:
        series = [(str(name), frame[name]) for name in frame.columns]
    found: list[tuple[str, Any, float | None]] = []
    for name, values in series:
        moments = seconds(values)
        if moments is not None:
            found.append((name, moments[0], moments[1]))
            continue
        array = numpy.asarray(values)
        if array.dtype.kind == "O":
            # What is missing becomes NaN, which the reader refuses with its place.
            try:
                array = numpy.stack(list(array)) if array.size and _is_list(array[0]) else array.astype(float)
            except (TypeError, ValueError):
                continue
        if array.dtype.kind not in "fiu":
            continue
        if array.ndim == 2 and array.shape[1] != 1:
            found.extend((f"{name}_{k}", array[:, k], None) for k in range(array.shape[1]))
        else:
            found.append((name, array.reshape(len(array)), None))
    return found


def _is_list(value: Any) -> bool:
    return isinstance(value, (list, tuple, numpy.ndarray))


def say(step: str) -> None:
    """A line about the progress."""
    print(step, file=sys.stderr, flush=True)


def unpickled(contents: bytes) -> Any:
    """The model whose file has these contents."""
    import tempfile
    from pathlib import Path

    from ._aurt import Model

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rd_calibrated.json"
        path.write_bytes(contents)
        return Model.load(path)


def restored_recording(*parts: Any) -> Any:
    """The recording that `pickle` took apart."""
    from ._aurt import Recording

    return Recording._restored(*parts)


def restored_robot(*parts: Any) -> Any:
    """The robot that `pickle` took apart."""
    from ._aurt import Robot

    return Robot._restored(*parts)


def restored_verdict(*parts: Any) -> Any:
    """The verdict that `pickle` took apart."""
    from ._aurt import Verdict

    return Verdict._restored(*parts)
