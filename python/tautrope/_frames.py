"""Estimates as DataFrames."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

#: How an estimate's parts are called behind a name.
PARTS = {"": "value", "_error": "error", "_low": "low", "_high": "high"}


def within(limit: float) -> str:
    """What the share of ropes within a limit is called."""
    return f"within_{limit!r}".removesuffix(".0")


def frame(rows: Mapping[Any, Mapping[str, Any]], index: str | list[str]) -> Any:
    import pandas

    keys = list(rows)
    by = pandas.Index(keys, name=index) if isinstance(index, str) else pandas.MultiIndex.from_tuples(keys, names=index)
    # An end of an interval that nobody knows is no number.
    known = [{key: np.nan if value is None else value for key, value in row.items()} for row in rows.values()]
    return pandas.DataFrame(known, index=by)
