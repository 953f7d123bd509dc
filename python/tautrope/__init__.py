"""Taut ropes of dragged traces among walls.

A rope is tied to an anchor and held at its free end. The free end is dragged along a trace through a plane full of
walls. After every step, which wall ends does the taut rope bend round, and how long is it? This package answers that
for thousands to millions of traces at once, and exactly.

- `Scene` has the walls and the anchor: from a file, an array, or shapely's geometries.
- `Scene.evaluate` gives the `Ropes` of your traces, as tables, arrays and lines, step by step if you like.
- `Study` draws random walks, as many as you like, and its `Answer` says how long a rope they need and where it touches
  walls. A plan with a section ``sweep`` is a `Sweep`: how does that change with the step, or the anchor?
- `tautrope.dask.run` does studies and sweeps on a Dask cluster.
- `LiveRope` follows one free end, move by move.

How long is the rope over time, on my own arrays?

>>> import numpy as np, tautrope
>>> scene = tautrope.Scene([[[-1, 0], [1, 0]], [[3, 3], [5, 1]]], anchor=(0, -1))
>>> traces = np.array([[(0, -1), (3, -1), (3, 1), (0, 1)], [(0, -1), (-2, -1), (-2, 2), (1, 2)]])
>>> ropes = scene.evaluate(traces)
>>> ropes.lengths.round(3)
array([[0.   , 3.   , 3.606, 2.828],
       [0.   , 2.   , 3.65 , 4.243]])

How long must a tether be so that 99 % of the walks fit, with an interval?

>>> walk = {"kind": "persistent", "step": 0.5, "steps": 100}
>>> answer = tautrope.Study(scene="rooms", walk=walk, run={"traces": 2000, "block": 100}).run(progress=False)
>>> length = answer.quantile("max_length", 0.99)
>>> length.low < length.value < length.high
True

Where do contacts happen, cell by cell as an array, and at which wall end most?

>>> contacts = answer.map["contacts"].to_numpy()
>>> busiest = answer.contacts.index[0]
>>> contacts.ndim, bool(answer.contacts.loc[busiest, "share"] > 0)
(2, True)

Which of two anchors is better, and by how much?

>>> sweep = {"scene.anchor": [(24.3, 9.2), (2.0, 2.0)]}
>>> two = tautrope.Study(scene="rooms", walk=walk, run={"traces": 2000, "block": 100}, sweep=sweep).run(progress=False)
>>> longer = two.differences().loc[("[2, 2]", "max_length")]
>>> bool(longer["low"] < longer["value"] < longer["high"] < 0)
True

How does that change with the step?

>>> sweep = {"walk.step": [0.25, 0.5, 1.0]}
>>> steps = tautrope.Study(scene="rooms", walk=walk, run={"traces": 500}, sweep=sweep).run(progress=False)
>>> bool(steps.quantile("max_length", 0.99)["value"].is_monotonic_increasing)
True
"""

import os as _os
import sys as _sys

from ._answer import Answer, Estimate
from ._errors import EngineError, InputError, ReadError, StudyError, TautropeError, ViolationError, WriteError
from ._folders import status
from ._live import Event, LiveRope
from ._ropes import Ropes
from ._scene import Scene, Violation
from ._study import Study
from ._sweep import Sweep, SweepAnswer
from ._table import StepStream, Table
from ._tautrope import __version__

__all__ = [
    "Answer",
    "EngineError",
    "Estimate",
    "Event",
    "InputError",
    "LiveRope",
    "ReadError",
    "Ropes",
    "Scene",
    "StepStream",
    "Study",
    "StudyError",
    "Sweep",
    "SweepAnswer",
    "Table",
    "TautropeError",
    "Violation",
    "ViolationError",
    "WriteError",
    "__version__",
    "status",
]

# As the program does: keeps Mesa's Vulkan layer that sorts devices by window system from complaining on stderr where
# there is none. It has nothing to add here.
if _sys.platform == "linux" and "XDG_RUNTIME_DIR" not in _os.environ:
    _os.environ.setdefault("NODEVICE_SELECT", "1")
