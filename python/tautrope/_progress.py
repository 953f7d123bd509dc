"""What is said of a study while it runs, and after."""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

#: Told how many steps are done, and of how many.
Progress = Callable[[int, int], Any]


def warn(notes: list[str]) -> None:
    for note in notes:
        if " holds the answer of this study already" not in note and " traces of this study already" not in note:
            warnings.warn(note, stacklevel=3)


class Said:
    """Says on stderr how far a study is, in one line."""

    def __init__(self, progress: bool | Progress) -> None:
        self._tell = progress if callable(progress) else None
        self._is_on = progress is True
        self._start = self._last = time.monotonic()
        self._written = False

    def __enter__(self) -> Progress | None:
        return self._tell or (self._say if self._is_on else None)

    def _say(self, done: int, of: int) -> None:
        now = time.monotonic()
        if now - self._last < 0.5:
            return
        self._last, self._written = now, True
        share = f"{100 * done / of:.0f} %" if of else f"{done:,} steps"
        left = (now - self._start) * (of - done) / done if of and done else None
        more = f", {left:.0f} s left" if left is not None else ""
        print(f"\rtautrope: {share}{more}      ", end="", file=sys.stderr, flush=True)

    def __exit__(self, *_: object) -> None:
        if self._written:
            print("\r" + " " * 40 + "\r", end="", file=sys.stderr, flush=True)
