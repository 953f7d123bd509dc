"""One rope, move by move."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from . import _tautrope as _core
from ._scene import Scene


class Event(NamedTuple):
    """A wrap or an unwrap.

    Attributes:
        kind: ``wrap`` or ``unwrap``.
        vertex: The wall end, as a number of `Scene.vertices`.
        side: On which side of the rope it lies, as a picture shows it: ``left`` or ``right``.
    """

    kind: str
    vertex: int
    side: str


class LiveRope:
    """A rope that follows its free end, one straight move at a time: for loops that cannot wait for the end of a trace.

    It starts with its free end at the anchor. Events and ropes are those that `Scene.evaluate` gives for the same
    points.

    >>> import tautrope
    >>> rope = tautrope.LiveRope(tautrope.Scene([[[-1, 0], [1, 0]]], anchor=(0, -1)))
    >>> rope.advance(2, -1)
    []
    >>> rope.advance(1, 1)
    [Event(kind='wrap', vertex=1, side='left')]
    >>> round(rope.length, 3), rope.points.tolist()
    (2.414, [[0.0, -1.0], [1.0, 0.0], [1.0, 1.0]])
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._core = _core.LiveRope(scene._core)

    @property
    def scene(self) -> Scene:
        """Its scene."""
        return self._scene

    def advance(self, x: float, y: float) -> list[Event]:
        """Moves the free end straight to (x, y), and returns what happened to the rope, in order.

        Raises:
            ViolationError: If the move touches a wall. The rope is as it was.
        """
        return [Event(*event) for event in self._core.advance(float(x), float(y))]

    @property
    def free_end(self) -> tuple[float, float]:
        """Where the free end is."""
        return self._core.free_end

    @property
    def length(self) -> float:
        """The taut rope's length."""
        return self._core.length

    @property
    def pull(self) -> tuple[float, float] | None:
        """The unit vector along which the rope pulls the free end; None for a rope of no length."""
        return self._core.pull

    @property
    def points(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The taut rope: the anchor, its turns and the free end, an array of shape (turns + 2, 2)."""
        return self._core.points

    @property
    def contacts(self) -> list[int]:
        """The wall ends at which it turns, from the anchor, as numbers of `Scene.vertices`."""
        return self._core.contacts

    def __repr__(self) -> str:
        x, y = self.free_end
        return f"<LiveRope: free end at ({x:g}, {y:g}), {len(self.contacts)} turns, {self.length:g} long>"
