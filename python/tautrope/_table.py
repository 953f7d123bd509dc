"""Tables that come out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from . import _tautrope as _core


class Table:
    """A table in memory: columns by name, and whatever kind of DataFrame you ask for.

    ``table["length"]`` is a column as an array. Any library that takes Arrow tables takes this one
    (``pyarrow.table(t)``, ``polars.DataFrame(t)``, DuckDB by its name in a query).

    >>> import tautrope
    >>> scene = tautrope.Scene([[[-1, 0], [1, 0]]], anchor=(0, -1))
    >>> events = scene.evaluate([[(0, -1), (3, -1), (1, 1)]]).events
    >>> len(events), events.columns
    (1, ['trace', 'step', 'kind', 'vertex', 'x', 'y', 'side'])
    >>> events["vertex"]
    array([1], dtype=uint32)
    """

    def __init__(self, core: _core.Table) -> None:
        self._core = core
        self._arrays: dict[str, Any] | None = None

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return self._core.names

    def __len__(self) -> int:
        return len(self._core)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def keys(self) -> list[str]:
        """The names of the columns."""
        return self.columns

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        """A column as an array: of numbers, of texts, or of shape (n, 2) for points; lists as an array of arrays."""
        return _plain(self._raw(name))

    def _raw(self, name: str) -> Any:
        if self._arrays is None:
            self._arrays = self._core.columns()
        try:
            return self._arrays[name]
        except KeyError:
            raise KeyError(f"no column {name}; there are {', '.join(self.columns)}") from None

    def ragged(self, name: str) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
        """A column of lists as two arrays: where each list begins (and the last ends), and the values of all.

        List i is ``values[offsets[i]:offsets[i + 1]]``.
        """
        raw = self._raw(name)
        if not _is_ragged(raw):
            raise KeyError(f"the column {name} has no lists; take [{name!r}]")
        return raw[0], _plain(raw[1])

    def to_numpy(self) -> dict[str, np.ndarray[Any, Any]]:
        """All columns as arrays, by name."""
        return {name: self[name] for name in self.columns}

    def to_pandas(self) -> Any:
        """The table as a DataFrame of pandas. Points become two columns, ``pull_x`` and ``pull_y`` say."""
        import pandas

        columns: dict[str, Any] = {}
        for name in self.columns:
            column = self[name]
            if column.ndim == 2:
                columns[f"{name}_x"], columns[f"{name}_y"] = column[:, 0], column[:, 1]
            else:
                columns[name] = column
        return pandas.DataFrame(columns)

    def to_polars(self) -> Any:
        """The table as a DataFrame of polars."""
        import polars

        return polars.DataFrame(self)

    def to_arrow(self) -> Any:
        """The table as one of pyarrow."""
        import pyarrow

        return pyarrow.table(self)

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        return self._core.__arrow_c_stream__(requested_schema)

    def __reduce__(self) -> Any:
        return _restored, (self._core.to_ipc(),)

    def __repr__(self) -> str:
        return f"<Table: {len(self)} rows, columns {', '.join(self.columns)}>"


class StepStream:
    """The rope after every step, made as it is read, so that all of it never is in memory: see `Ropes.stream_steps`.

    It can be read as often as you like: ``for table in stream`` gives `Table`s of some 250,000 rows, each of whole
    traces, and whatever takes Arrow streams takes this one: ``pyarrow.RecordBatchReader.from_stream(stream)``, DuckDB
    by its name in a query.
    """

    def __init__(self, core: _core.StepStream, again: Any) -> None:
        self._core = core
        #: What makes the same of a pickle.
        self._again = again

    def __iter__(self) -> Iterator[Table]:
        place = 0
        while (part := self._core.part(place)) is not None:
            table, place = part
            yield Table(table)

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        return self._core.__arrow_c_stream__(requested_schema)

    def __reduce__(self) -> Any:
        return self._again

    def __repr__(self) -> str:
        return "<StepStream: the rope after every step, made as it is read>"


def _restored(data: bytes) -> Table:
    return Table(_core.Table.of_ipc(data))


def _is_ragged(raw: Any) -> bool:
    """Whether a column has lists: offsets and values, where texts are codes and a list."""
    return isinstance(raw, tuple) and not isinstance(raw[1], list)


def _plain(raw: Any) -> np.ndarray[Any, Any]:
    if not isinstance(raw, tuple):
        array: np.ndarray[Any, Any] = raw
        return array
    if _is_ragged(raw):
        return split(raw[0], _plain(raw[1]))
    codes, texts = raw
    return np.array([*texts, None], dtype=object)[codes]


def split(offsets: np.ndarray[Any, Any], values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """The lists of a column of lists, as an array of arrays."""
    lists = np.empty(len(offsets) - 1, dtype=object)
    for i, (start, end) in enumerate(zip(offsets[:-1].tolist(), offsets[1:].tolist(), strict=True)):
        lists[i] = values[start:end]
    return lists
