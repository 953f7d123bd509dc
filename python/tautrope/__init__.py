"""Taut ropes of dragged traces among walls.

A rope is tied to an anchor and held at its free end. The free end is dragged along a trace through a plane full of
walls. After every step, which wall ends does the taut rope bend round, and how long is it? This package answers that
for thousands to millions of traces at once, and exactly.

- `Scene` has the walls and the anchor: from a file, an array, or shapely's geometries.
- `Scene.evaluate` gives the `Ropes` of your traces, as tables, arrays and lines.
- `Study` draws random walks, as many as you like, and says how long a rope they need and where it touches walls.
- `LiveRope` follows one free end, move by move.

>>> import numpy as np, tautrope
>>> scene = tautrope.Scene.built_in("rooms")
>>> ropes = scene.evaluate(scene.walks(100, steps=200))
>>> bool(ropes["max_length"].max() >= ropes["length"].max())
True
"""

import os as _os
import sys as _sys

from ._errors import EngineError, InputError, ReadError, StudyError, TautropeError, ViolationError, WriteError
from ._live import Event, LiveRope
from ._ropes import Ropes
from ._scene import Scene, Violation
from ._study import Answer, Estimate, Study, status
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
