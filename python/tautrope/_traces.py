"""Traces in all forms in which they may be given."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _tautrope as _core
from ._errors import InputError

#: What is said of anything else.
_FORMS = (
    "traces are an array of shape (n, points, 2), a list of arrays of shape (points, 2), a pair (offsets, xy), "
    "or a table with the columns trace, x, y and, if there is one, step"
)


def traces_of(given: Any) -> _core.Traces:
    """Traces as the compiled part takes them."""
    if hasattr(given, "__arrow_c_stream__"):
        try:
            capsule = given.__arrow_c_stream__()
        except ImportError:
            # A DataFrame of pandas needs pyarrow for this; its columns do as well.
            return _of_columns(given)
        return _core.Traces.of_stream(capsule)
    if isinstance(given, Mapping) or (hasattr(given, "columns") and hasattr(given, "__getitem__")):
        return _of_columns(given)
    if isinstance(given, tuple) and len(given) == 2 and _is_offsets(given[0]):
        return _of_offsets(*given)
    if hasattr(given, "__array__"):
        return _of_array(np.asarray(given))
    if hasattr(given, "coords"):
        return _of_list([given])
    try:
        return _of_list(list(given))
    except TypeError:
        raise InputError(f"{type(given).__name__} is given; {_FORMS}") from None


def _is_offsets(given: Any) -> bool:
    array = np.asarray(given)
    return array.ndim == 1 and (array.dtype.kind in "iu" or array.size == 0)


def _of_offsets(offsets: Any, xy: Any) -> _core.Traces:
    points = _points(xy, "xy")
    return _core.Traces.of_points(np.ascontiguousarray(offsets, dtype=np.int64), points.reshape(-1))


def _of_array(array: np.ndarray[Any, Any]) -> _core.Traces:
    if array.dtype == object:
        return _of_list(list(array))
    if array.ndim == 2 and array.shape[1] == 2:
        raise InputError("an array of shape (points, 2) is one trace; give it as [array]")
    if array.ndim != 3 or array.shape[2] != 2:
        raise InputError(f"an array of shape {array.shape} is given; {_FORMS}")
    count, points, _ = array.shape
    offsets = np.arange(count + 1, dtype=np.int64) * points
    return _of_offsets(offsets, array.reshape(count * points, 2))


def _of_list(traces: list[Any]) -> _core.Traces:
    arrays = [_points(np.asarray(t.coords) if hasattr(t, "coords") else t, f"trace {i}") for i, t in enumerate(traces)]
    offsets = np.cumsum([0] + [len(array) for array in arrays])
    return _of_offsets(offsets, np.concatenate(arrays) if arrays else np.zeros((0, 2)))


def _points(given: Any, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    array = np.asarray(given)
    if array.dtype.kind not in "fiu" or array.ndim != 2 or array.shape[1] != 2:
        what = f"an array of {array.dtype} of shape {array.shape}"
        raise InputError(f"{name}: {what}, where numbers of shape (points, 2) are needed; {_FORMS}")
    wide = np.ascontiguousarray(array, dtype=np.float64)
    _refuse_rounded(array, wide, name)
    return wide


def _of_columns(table: Any) -> _core.Traces:
    names = list(table.keys()) if isinstance(table, Mapping) else list(table.columns)
    missing = [name for name in ("trace", "x", "y") if name not in names]
    if missing:
        raise InputError(f"no column {missing[0]} among {', '.join(map(str, names))}; trace, x and y are needed")
    steps = _whole(table["step"], "step") if "step" in names else None
    x, y = _numbers(table["x"], "x"), _numbers(table["y"], "y")
    trace = _whole(table["trace"], "trace")
    lengths = {len(column) for column in [trace, x, y, *([steps] if steps is not None else [])]}
    if len(lengths) > 1:
        raise InputError("the columns trace, x, y and step are not equally long")
    return _core.Traces.of_rows(trace, x, y, steps)


def _whole(given: Any, name: str) -> np.ndarray[Any, np.dtype[np.uint64]]:
    array = np.asarray(given)
    if array.dtype.kind not in "iu" or array.ndim != 1:
        raise InputError(f"column {name}: whole numbers are needed, not {array.dtype}")
    if array.dtype.kind == "i" and len(array) and int(array.min()) < 0:
        row = int(np.argmax(array < 0))
        raise InputError(f"row {row}: column {name}: {array[row]} is not a whole number from 0", row=row)
    return np.ascontiguousarray(array, dtype=np.uint64)


def _numbers(given: Any, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    array = np.asarray(given)
    if array.dtype.kind not in "fiu" or array.ndim != 1:
        raise InputError(f"column {name}: numbers are needed, not {array.dtype}")
    wide = np.ascontiguousarray(array, dtype=np.float64)
    _refuse_rounded(array, wide, f"column {name}")
    return wide


def _refuse_rounded(array: np.ndarray[Any, Any], wide: np.ndarray[Any, Any], name: str) -> None:
    """Refuses numbers that float64 does not hold exactly: those are taken as they are, or not at all."""
    wider = array.dtype.itemsize > 8 if array.dtype.kind == "f" else array.dtype.itemsize == 8
    if wider and not np.array_equal(wide.astype(array.dtype), array, equal_nan=array.dtype.kind == "f"):
        raise InputError(f"{name}: some numbers have more digits than float64 holds; round them yourself")
