"""A rope that follows its free end: the same as the rope of the whole trace."""

from __future__ import annotations

import numpy as np
import pytest
from tautrope import InputError, LiveRope, Scene, ViolationError


def test_moves_give_the_ropes_of_the_trace(rooms: Scene, walks: np.ndarray) -> None:
    ropes = rooms.evaluate(walks[:20])
    events = ropes.events.to_pandas()
    for trace, walk in enumerate(walks[:20]):
        live, found = LiveRope(rooms), []
        assert live.free_end == rooms.anchor and live.length == 0 and live.pull is None and live.scene is rooms
        for step, (x, y) in enumerate(walk):
            found += [(step, *event) for event in live.advance(x, y)]
            assert live.length == ropes.lengths[trace, step] and live.free_end == (x, y)
        own = events[events["trace"] == trace]
        assert found == [*own[["step", "kind", "vertex", "side"]].itertuples(index=False, name=None)]
        assert np.array_equal(live.points, ropes.rope(trace)) and live.pull == tuple(ropes["pull"][trace])
        assert np.array_equal(rooms.vertices[live.contacts], live.points[1:-1])
        assert repr(live).startswith("<LiveRope: free end at (")


def test_moves_that_touch_walls_are_refused() -> None:
    rope = LiveRope(Scene([[[-1, 0], [1, 0]]], anchor=(0, -1)))
    rope.advance(2, -1)
    before = rope.points.tolist()
    with pytest.raises(ViolationError, match="touches wall 0") as caught:
        rope.advance(-2, 0.5)
    assert caught.value.wall == 0 and rope.points.tolist() == before
    with pytest.raises(InputError, match="NaN"):
        rope.advance(float("nan"), 0)
    with pytest.raises(InputError, match="no anchor"):
        LiveRope(Scene([[[-1, 0], [1, 0]]]))
