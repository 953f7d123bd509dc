"""What can go wrong."""

from __future__ import annotations

from typing import Any


class TautropeError(Exception):
    """What all exceptions of this package have in common.

    Its fields say where: each is None where it says nothing.

    Attributes:
        file: The file that cannot be read.
        line: The line in it, from 1.
        row: The row of a table, from 0.
        trace: The number of a trace.
        step: The step of that trace: the move from point ``step - 1`` to point ``step``; 0 is the move from the anchor.
        wall: The number of a wall.
    """

    file: str | None = None
    line: int | None = None
    row: int | None = None
    trace: int | None = None
    step: int | None = None
    wall: int | None = None

    def __init__(self, message: str = "", **fields: Any) -> None:
        super().__init__(message)
        self.__dict__.update(fields)


class InputError(TautropeError, ValueError):
    """Arrays, tables or arguments that cannot be used."""


class ReadError(TautropeError, ValueError):
    """A file that cannot be read, or does not hold what it should."""


class ViolationError(TautropeError, ValueError):
    """A step that crosses a wall: ropes are exact for traces that keep clear of the walls."""


class StudyError(TautropeError, ValueError):
    """A study that cannot be run, or a folder that does not hold it."""


class EngineError(TautropeError, RuntimeError):
    """An engine that cannot be opened, or failed."""


class WriteError(TautropeError, OSError):
    """A file that cannot be written."""
