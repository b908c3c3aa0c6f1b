"""Between the compiled part and Python: rows as data frames, NumPy's numbers as plain ones."""

from __future__ import annotations

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


def columns(frame: Any) -> list[tuple[str, Any]]:
    """The columns of numbers of a frame, by name; an index with a name comes first."""
    if hasattr(frame, "iloc"):
        series = [(name, frame.iloc[:, k]) for k, name in enumerate(frame.columns)]
        index = frame.index
        if index.name is not None and index.name not in frame.columns:
            series.insert(0, (index.name, index))
    elif hasattr(frame, "get_columns"):
        series = [(column.name, column) for column in frame.get_columns()]
    else:
        series = [(name, frame[name]) for name in frame.columns]
    numbers = []
    for name, values in series:
        array = numpy.asarray(values)
        if array.dtype.kind == "O":
            # What is missing becomes NaN, which the reader refuses with its place.
            try:
                array = array.astype(float)
            except (TypeError, ValueError):
                continue
        if array.dtype.kind in "fiu":
            numbers.append((str(name), array))
    return numbers


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
