"""Scenes: walls and an anchor."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from . import _tautrope as _core
from ._errors import InputError, ReadError
from ._ropes import Ropes, names_of
from ._traces import traces_of

#: What a point may be given as.
Point = tuple[float, float] | Sequence[float] | np.ndarray[Any, Any]


class Violation(NamedTuple):
    """A step that breaks the rules: the first of its trace.

    Attributes:
        trace: The trace.
        step: The move from point ``step - 1`` to point ``step``; 0 is the move from the anchor to the first point.
        wall: The wall in its way, as a number of `Scene.walls`.
        kind: ``crosses``, ``slips through`` (between walls that meet) or ``enters a solid``.
        start: Where the step starts.
        end: Where it ends.
    """

    trace: int
    step: int
    wall: int
    kind: str
    start: tuple[float, float]
    end: tuple[float, float]


class Scene:
    """Walls in the plane, and the anchor at which ropes are tied.

    Coordinates are planar, in your own unit. Walls may share ends, touch, cross and overlap. A scene keeps the engines
    that have evaluated ropes in it, so that a second call does not pay again for what the first has found out.

    Args:
        walls: An array of shape (n, 2, 2) or (n, 4): the two ends of each wall. They are thin, free on both sides.
        anchor: Where ropes are tied. A scene without an anchor can be looked at, and tied later: `tied`.

    >>> import tautrope
    >>> scene = tautrope.Scene([[[-1, 0], [1, 0]]], anchor=(0, -1))
    >>> scene
    <Scene: 1 wall, 2 vertices, anchor (0, -1)>
    >>> ropes = scene.evaluate([[(0, -1), (3, -1), (3, 1), (0, 1)]])
    >>> ropes["length"].round(3)
    array([2.828])
    """

    def __init__(self, walls: Any, anchor: Point | None = None) -> None:
        array = np.asarray(walls, dtype=np.float64)
        if array.size == 0:
            array = array.reshape(0, 4)
        if array.shape[1:] not in ((2, 2), (4,)):
            raise InputError(f"walls: an array of shape (n, 2, 2) or (n, 4) is needed, not {array.shape}")
        self._core = _core.Scene.of_walls(np.ascontiguousarray(array).reshape(-1), _point(anchor))
        self._step: float | None = None

    @classmethod
    def _of(cls, core: _core.Scene) -> Scene:
        scene = cls.__new__(cls)
        scene._core = core
        scene._step = None
        return scene

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        *,
        layers: str | Iterable[str] = (),
        without_layers: str | Iterable[str] = (),
        anchor: Point | None = None,
        flatten: float | None = None,
        unknown: str = "free",
        ros: int = 2,
    ) -> Scene:
        """The scene in a file: GeoJSON, well-known text, SVG, DXF, and maps of ROS and MovingAI.

        Args:
            path: The file; its extension names the format.
            layers: The layers whose walls are taken; all without it. ``KEY=VALUE`` goes by a property of GeoJSON.
            without_layers: The layers whose walls are left out.
            anchor: Where ropes are tied, instead of where the file says.
            flatten: How far walls may lie from curves.
            unknown: What unknown cells of a map of ROS are: ``free`` or ``blocked``.
            ros: Which ROS's ``map_server`` says what cells are occupied: 1 or 2.

        Raises:
            ReadError: If the file cannot be read; its fields say where.
        """
        chosen, left_out = ([given] if isinstance(given, str) else list(given) for given in (layers, without_layers))
        if unknown not in ("free", "blocked") or ros not in (1, 2):
            raise InputError("unknown is free or blocked, ros is 1 or 2")
        file = Path(path)
        blocked, at = unknown == "blocked", _point(anchor)
        return cls._of(_core.Scene.read(file, chosen, left_out, flatten, blocked, ros, at))

    @classmethod
    def built_in(cls, name: str = "rooms", anchor: Point | None = None) -> Scene:
        """A scene to try things in: ``rooms``, a floor plan of 24 rooms; ``random-M`` or ``lattice-M`` with M walls."""
        scene = cls._of(_core.Scene.built_in(name, _point(anchor)))
        scene._step = _core.built_in_step(name)
        return scene

    @classmethod
    def from_shapely(
        cls,
        geometries: Any,
        anchor: Point | None = None,
        *,
        labels: Iterable[str | None] | None = None,
        layers: Iterable[str | None] | None = None,
    ) -> Scene:
        """The borders of shapely's geometries, one or many: polygons are solid, lines are thin walls.

        Args:
            geometries: A geometry, or a sequence of them. What they mean is what a GeoJSON file of them would mean.
            anchor: Where ropes are tied.
            labels: A name for each geometry: wall ends of a geometry with a name have it in results.
            layers: A layer for each geometry.
        """
        several = not hasattr(geometries, "geom_type")
        all_of = list(geometries) if several else [geometries]
        features = []
        named = [None if names is None else list(names) for names in (labels, layers)]
        for kind, names in zip(("labels", "layers"), named, strict=True):
            if names is not None and len(names) != len(all_of):
                raise InputError(f"{kind}: {len(names)} for {len(all_of)} geometries")
        for i, geometry in enumerate(all_of):
            own = [None if names is None else names[i] for names in named]
            properties = {key: name for key, name in zip(("label", "layer"), own, strict=True) if isinstance(name, str)}
            shape = getattr(geometry, "__geo_interface__", geometry)
            try:
                feature = {"type": "Feature", "properties": properties, "geometry": shape}
                features.append(json.dumps(feature, allow_nan=False))
            except (TypeError, ValueError) as error:
                raise InputError(f"geometry {i} is none, or has a coordinate that is not finite: {error}") from None
        text = '{"type": "FeatureCollection", "features": [' + ",\n".join(features) + "]}"
        return cls._of(_of_text(text, _point(anchor)))

    @classmethod
    def from_geopandas(
        cls, frame: Any, anchor: Point | None = None, *, label: str | None = None, layer: str | None = None
    ) -> Scene:
        """The borders of the geometries of a GeoDataFrame or GeoSeries.

        Args:
            frame: The frame. Its lengths should be lengths: project degrees first (``frame.to_crs(...)``).
            anchor: Where ropes are tied.
            label: The column that names each geometry.
            layer: The column that says in which layer each lies.
        """
        columns = [None if name is None else list(frame[name]) for name in (label, layer)]
        return cls.from_shapely(list(frame.geometry), anchor, labels=columns[0], layers=columns[1])

    def tied(self, anchor: Point) -> Scene:
        """The same walls with the rope tied elsewhere."""
        at = _point(anchor)
        assert at is not None
        scene = Scene._of(self._core.tied(at))
        scene._step = self._step
        return scene

    @property
    def anchor(self) -> tuple[float, float] | None:
        """Where ropes are tied; None if that is not said yet."""
        return self._core.anchor

    @property
    def vertices(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The ends of all walls, each once: an array of shape (vertices, 2)."""
        return self._core.vertices

    @property
    def walls(self) -> np.ndarray[Any, np.dtype[np.int64]]:
        """The walls as pairs of rows of `vertices`: ``scene.vertices[scene.walls]`` has shape (walls, 2, 2)."""
        return self._core.walls

    @property
    def labels(self) -> list[str | None]:
        """The label of each vertex; an empty list if there are none."""
        return self._core.labels

    @property
    def layers(self) -> dict[str, int]:
        """How many walls each layer has."""
        return dict(sorted(self._core.layers.items()))

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The lowest x and y and the highest x and y of all walls and the anchor, as shapely gives them."""
        points = np.concatenate([self.vertices, np.array([self.anchor] if self.anchor else []).reshape(-1, 2)])
        if not len(points):
            raise InputError("a scene without walls and anchor has no bounds")
        return (*points.min(axis=0).tolist(), *points.max(axis=0).tolist())

    @property
    def y_down(self) -> bool:
        """Whether y points down when the scene is looked at as its file means it."""
        return self._core.y_down

    @property
    def notes(self) -> list[str]:
        """What the reader of its file has to say, and what is odd about where the anchor stands."""
        return self._core.notes

    def evaluate(
        self,
        traces: Any,
        *,
        engine: str | None = None,
        precision: str = "certified",
        on_violation: str = "error",
        events: bool = True,
        steps: bool = False,
        about: Iterable[str | int] | None = None,
        friction: float | None = None,
    ) -> Ropes:
        """The taut ropes of traces: the points through which the free end is dragged.

        The first point of a trace must be visible from the anchor, and each next one from the one before. Ropes are
        exact then. Other Python threads go on meanwhile, and Ctrl-C ends it.

        Args:
            traces: An array of shape (n, points, 2); a list of arrays of shape (points, 2), or of shapely's lines; a
                pair ``(offsets, xy)``, where trace i is ``xy[offsets[i]:offsets[i + 1]]``; or a table of pandas,
                polars, pyarrow, DuckDB, or a dict of arrays, with the columns ``trace``, ``x``, ``y``. Rows of one
                trace follow each other and numbers of traces increase: sort by trace and step. A column ``step`` may
                not go back; without it rows that are out of order cannot be told from a walk.
            engine: ``cpu``, ``gpu``, ``gpu-windows``, ``gpu-rays``, ``reference``, ``funnel`` or ``note``; without it the one that suits
                the machine.
            precision: ``certified``, or ``fast`` for the engine gpu: f32 decides alone, and ropes can be wrong.
            on_violation: ``error`` raises at the first trace that crosses a wall; ``flag`` marks such traces in the
                column ``status``.
            events: Whether what happens step by step is kept. Without it there are results only, in less memory.
            steps: Whether the rope after every step is told at once, as `Ropes.steps`: a table of one row a step. With
                ``events=False`` that is all that is kept of the steps. Without it `Ropes.steps` makes the table when it
                is asked for, and `Ropes.stream_steps` without ever holding all of it.
            about: Of which obstacles `Ropes.steps` counts how often the free end has gone round them: their labels, or
                numbers of wall ends as in `Scene.vertices`. Without it all obstacles that have a label.
            friction: A coefficient of friction from 0 to 10, with which `Ropes.steps` tells the rope's pull at the
                anchor, its turns, its tension and the work of the free end. Without it they are not told.

        Raises:
            ViolationError: A step crosses a wall; its fields say which.
            InputError: Traces that cannot be used, an obstacle that is not there, or no coefficient of friction.
        """
        if on_violation not in ("error", "flag"):
            raise InputError("on_violation is error or flag")
        if self.anchor is None:
            raise InputError("the scene has no anchor; give one: scene.tied((x, y))")
        name = None if engine in (None, "auto") else engine
        names = names_of(about)
        flag = on_violation == "flag"
        core = self._core.evaluate(traces_of(traces), name, precision, flag, events, steps, names, friction)
        return Ropes(core, self)

    def check(self, traces: Any) -> list[Violation]:
        """The first step of each trace that crosses a wall; an empty list if all traces keep to the rules."""
        return [Violation(*found) for found in self._core.check(traces_of(traces))]

    def walks(
        self, count: int, steps: int = 500, step: float | None = None, seed: int = 1
    ) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Random walks from the anchor that keep clear of the walls: an array of shape (count, steps + 1, 2).

        Args:
            count: How many.
            steps: How many steps each has.
            step: How long a step is, about; without it what suits a built-in scene, else a 200th of the scene's longer
                side.
            seed: Walk i of a seed is the same whatever else is drawn.
        """
        if step is None:
            low_x, low_y, high_x, high_y = self.bounds
            step = self._step or max(high_x - low_x, high_y - low_y) / 200 or 1.0
        return self._core.walks(count, steps, float(step), seed).reshape(count, steps + 1, 2)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the scene as GeoJSON or well-known text, so that the same scene is read from it."""
        self._core.write(Path(path))

    def svg(self) -> str:
        """The picture of the scene as SVG."""
        return self._core.svg()

    def _repr_svg_(self) -> str:
        return self.svg()

    def plot(self, ax: Any = None, **style: Any) -> Any:
        """Draws walls and anchor with matplotlib, and returns the axes. ``style`` goes to its LineCollection."""
        import matplotlib.pyplot as plt
        from matplotlib.collections import LineCollection

        if ax is None:
            _, ax = plt.subplots()
        ax.add_collection(LineCollection(self.vertices[self.walls], **{"colors": "0.2", "linewidths": 1, **style}))
        if self.anchor is not None:
            ax.plot(*self.anchor, "o", color="0.2")
        ax.autoscale()
        ax.set_aspect("equal")
        if self.y_down and not ax.yaxis_inverted():
            ax.invert_yaxis()
        return ax

    def __reduce__(self) -> Any:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "scene.geojson")
            self.write(file)
            return _restored, (file.read_text(), self._step)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        same = self.anchor == other.anchor and self.y_down == other.y_down and self.labels == other.labels
        return same and np.array_equal(self.vertices[self.walls], other.vertices[other.walls])

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        count = len(self.walls)
        at = "no anchor" if self.anchor is None else "anchor ({:g}, {:g})".format(*self.anchor)
        return f"<Scene: {count} wall{'' if count == 1 else 's'}, {len(self.vertices)} vertices, {at}>"


def _point(given: Point | None) -> tuple[float, float] | None:
    if given is None:
        return None
    try:
        x, y = getattr(given, "coords", [given])[0]
        return float(x), float(y)
    except (TypeError, ValueError):
        raise InputError(f"a point (x, y) is needed, not {given!r}") from None


def _of_text(text: str, anchor: tuple[float, float] | None) -> _core.Scene:
    """The scene that a text in GeoJSON describes."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "scene.geojson")
        file.write_text(text)
        try:
            return _core.Scene.read(file, [], [], None, False, 2, anchor)
        except ReadError as error:
            # Nobody but this function knows that file.
            what = str(error).removeprefix(f"{file}: ").replace("feature ", "geometry ")
            raise InputError(what) from None


def _restored(text: str, step: float | None) -> Scene:
    scene = Scene._of(_of_text(text, None))
    scene._step = step
    return scene
