"""The ropes of many traces."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _tautrope as _core
from ._errors import InputError
from ._table import StepStream, Table, split

if TYPE_CHECKING:
    from ._scene import Scene


class Picture(str):
    """A picture as SVG, which notebooks show."""

    def _repr_svg_(self) -> str:
        return str(self)


class Ropes:
    """The taut ropes of many traces, as `Scene.evaluate` gives them: a table with one row a trace, and more.

    Columns, by ``ropes["length"]`` and in every DataFrame:

    - ``trace``, ``status`` (``ok`` or ``violation``), ``steps``
    - ``length``, ``max_length``: how long the rope is at the end, and at its longest after any step
    - ``depth``, ``max_depth``: how many turns it has
    - ``events``: how many wraps and unwraps there were
    - ``wraps``, ``sides``: where it turns, from the anchor, and on which side of the rope each wall end lies
    - ``pull``: the unit vector along which it pulls the free end
    - ``labels``: the names of the wall ends at which it turns, if the scene has names

    >>> import tautrope
    >>> scene = tautrope.Scene([[[-1, 0], [1, 0]]], anchor=(0, -1))
    >>> ropes = scene.evaluate([[(0, -1), (3, -1), (3, 1), (0, 1)], [(0, -1), (0, -2)]])
    >>> ropes["max_length"].round(3)
    array([3.606, 1.   ])
    >>> ropes.rope(0).tolist()
    [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0]]
    >>> ropes.lengths[0].round(3)
    array([0.   , 3.   , 3.606, 2.828])
    """

    def __init__(self, core: _core.Ropes, scene: Scene) -> None:
        self._core = core
        self._scene = scene

    @property
    def scene(self) -> Scene:
        """The scene in which they are."""
        return self._scene

    @property
    def engine(self) -> str:
        """What evaluated them, and on what."""
        return self._core.engine

    @cached_property
    def results(self) -> Table:
        """One row a trace."""
        return Table(self._core.results())

    @cached_property
    def events(self) -> Table:
        """One row for every wrap and unwrap, in order: ``trace``, ``step``, ``kind``, ``vertex``, ``x``, ``y``,
        ``side``."""
        return Table(self._core.events())

    @cached_property
    def classes(self) -> Table:
        """The homotopy class of each rope at the end, one row a trace: ``trace``, ``class`` and ``windings``.

        Two ropes between the same ends have the same ``class`` exactly if one can be moved into the other without
        crossing a wall, whatever their histories. It is a word: ``o12`` where the rope passes over the cut of obstacle
        12, the ray straight up from its highest wall end, counter-clockwise, ``o12^-1`` where it passes clockwise, in
        the order from the anchor; ``e`` if it passes none. ``windings`` are arrays of shape (n, 2): obstacles,
        and how often the rope winds about each, those with 0 left out. A trace that crosses a wall has None and none.

        >>> import tautrope
        >>> scene = tautrope.Scene([[[-1, 0], [1, 0]]], anchor=(0, -1))
        >>> ropes = scene.evaluate([[(3, -1), (3, 1), (0, 1)], [(-3, -1), (-3, 1), (0, 1)]])
        >>> ropes.classes["class"].tolist()
        ['o0', 'e']
        """
        return Table(self._core.classes())

    @cached_property
    def class_changes(self) -> Table:
        """How the class of each rope changes: ``trace``, ``step``, and the ``class`` and ``windings`` after that step as
        `classes` has them. One row for the first step of a trace, and one for each step after which the class is another.
        Traces that cross walls have none.

        >>> import tautrope
        >>> scene = tautrope.Scene([[[-1, 0], [1, 0]]], anchor=(0, -1))
        >>> changes = scene.evaluate([[(0, -2), (3, 0), (3, 2), (0, 2), (3, 2)]]).class_changes
        >>> changes["step"].tolist(), changes["class"].tolist()
        ([0, 3, 4], ['e', 'o0', 'e'])
        """
        return Table(self._core.class_changes())

    def same_class(self, trace: int) -> list[int]:
        """The numbers of the traces whose ropes are of the same class at the end as that of this one, which is among
        them unless it has none.

        >>> import tautrope
        >>> scene = tautrope.Scene([[[-1, 0], [1, 0]]], anchor=(0, -1))
        >>> east, west = [(3, -1), (3, 1), (0, 1)], [(-3, -1), (-3, 1), (0, 1)]
        >>> ropes = scene.evaluate([east, west, [*east, (-1, 2)]])
        >>> ropes.same_class(0)
        [0, 2]
        """
        classes = self.classes["class"]
        wanted = classes[self._place(trace)]
        same: Any = [] if wanted is None else np.flatnonzero(classes == wanted)
        return [int(self["trace"][place]) for place in same]

    @cached_property
    def steps(self) -> Table:
        """One row for the rope after every step, in order: ``trace``, ``step``, where the free end is (``x``, ``y``),
        the rope's ``length``, its ``contacts`` and ``turns``, its ``pull_x`` and ``pull_y`` (null for a rope of no
        length), and ``winding_NAME`` for each obstacle of which `Scene.evaluate` was told by ``about``, or else for all
        that have a label: how often the free end has gone all the way round it since the trace began.

        If `Scene.evaluate` was told of ``friction``, there are ``anchor_pull_x`` and ``anchor_pull_y`` (as the rope
        pulls the anchor), ``turned`` (by which angle it turns in all, in radians), ``tension`` (at the free end when it
        is hauled, for 1 at the anchor: exp(friction * turned)) and ``work`` (that of the free end since the trace
        began), before the windings.

        The table is in memory: some 70 bytes a step and 8 for each obstacle. `stream_steps` makes it as it is read.

        >>> import tautrope
        >>> scene = tautrope.Scene([[[-1, 0], [1, 0]]], anchor=(0, -1))
        >>> ropes = scene.evaluate([[(0, -1), (3, -1), (3, 1), (0, 1)]], steps=True, about=[1])
        >>> ropes.steps["turns"], ropes.steps["length"].round(3)
        (array([0, 0, 0, 1], dtype=uint32), array([0.   , 3.   , 3.606, 2.828]))
        """
        return Table(self._core.steps())

    def stream_steps(
        self, about: Iterable[str | int] | None = None, friction: float | None = None
    ) -> StepStream:
        """The rows of `steps`, made as they are read: some 250,000 at a time are in memory, and one trace at least.

        Args:
            about: Obstacles about which turns are counted, by label or number of a wall end; as for `Scene.evaluate`
                without it.
            friction: A coefficient of friction; as for `Scene.evaluate` without it.

        >>> import tautrope
        >>> scene = tautrope.Scene.built_in("rooms")
        >>> ropes = scene.evaluate(scene.walks(1000, steps=300))
        >>> longest = max(table["length"].max() for table in ropes.stream_steps())
        >>> bool(longest == ropes["max_length"].max())
        True
        """
        names = names_of(about)
        return StepStream(self._core.stream_steps(names, friction), (Ropes.stream_steps, (self, names, friction)))

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return self.results.columns

    def __len__(self) -> int:
        return len(self._core)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def keys(self) -> list[str]:
        """The names of the columns."""
        return self.columns

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        """A column as an array; see `Table`."""
        return self.results[name]

    def to_numpy(self) -> dict[str, np.ndarray[Any, Any]]:
        """All columns as arrays, by name."""
        return self.results.to_numpy()

    def to_pandas(self) -> Any:
        """The table as a DataFrame of pandas."""
        return self.results.to_pandas()

    def to_polars(self) -> Any:
        """The table as a DataFrame of polars."""
        return self.results.to_polars()

    def to_arrow(self) -> Any:
        """The table as one of pyarrow."""
        return self.results.to_arrow()

    def to_geopandas(self) -> Any:
        """The table as a GeoDataFrame: the ropes at the end are its geometry."""
        import geopandas

        frame = self.to_pandas().drop(columns=["wraps", "sides", *(["labels"] if "labels" in self.columns else [])])
        return geopandas.GeoDataFrame(frame, geometry=self.lines())

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        return self.results.__arrow_c_stream__(requested_schema)

    @cached_property
    def lengths(self) -> np.ndarray[Any, Any]:
        """The rope's length after each step: an array of shape (n, points) if all traces have as many points, else an
        array of arrays."""
        return _even(*self._core.lengths())

    @cached_property
    def points(self) -> np.ndarray[Any, Any]:
        """The traces' points: an array of shape (n, points, 2) if all have as many, else an array of arrays."""
        return _even(*self._core.points())

    def lines(self) -> np.ndarray[Any, Any]:
        """The taut ropes at the end as shapely's LineStrings, from the anchor to the free end."""
        import shapely

        offsets, points = self._core.lines()
        rope = np.repeat(np.arange(len(self)), np.diff(offsets))
        lines: np.ndarray[Any, Any] = shapely.linestrings(points, indices=rope)
        return lines

    def rope(self, trace: int, step: int | None = None) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The taut rope of a trace after a step, at its end without one: the anchor, its turns and the free end, an
        array of shape (turns + 2, 2)."""
        place = self._place(trace)
        if step is None:
            offsets, points = self._core.lines()
            return points[offsets[place] : offsets[place + 1]]
        return self._core.rope_at(place, step)

    def forces(
        self, trace: int, step: int | None = None, friction: float = 0.0, holds: bool = False
    ) -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
        """The forces of a rope on what it bends round, for a tension of 1 at the anchor: an array for each column, with
        an entry for each turn from the anchor on.

        ``x`` and ``y`` say where the rope turns, ``angle`` by which angle in radians, ``before`` and ``beyond`` its
        tension on the side of the anchor and on that of the free end, ``force_x`` and ``force_y`` the force.

        Args:
            trace: The trace's number.
            step: After which step; at the end without it.
            friction: A coefficient of friction from 0 to 10.
            holds: Whether the free end only holds, so that the rope is about to slip towards the anchor; otherwise it
                hauls. Without friction that makes no difference.

        >>> import tautrope
        >>> scene = tautrope.Scene([[[1, 0], [1, 9]]], anchor=(0, 0))
        >>> ropes = scene.evaluate([[(0, 0), (1, -1), (2, -1), (2, 1)]])
        >>> ropes.forces(0)["angle"].round(4), ropes.forces(0, friction=0.5)["beyond"].round(4)
        (array([0.7854]), array([1.481]))
        """
        names = ("x", "y", "angle", "before", "beyond", "force_x", "force_y")
        return dict(zip(names, _core.forces(self.rope(trace, step), friction, holds), strict=True))

    def _place(self, trace: int) -> int:
        numbers = self["trace"]
        place = int(np.searchsorted(numbers, trace)) if trace >= 0 else len(numbers)
        if place == len(numbers) or numbers[place] != trace:
            raise InputError(f"there is no trace {trace}")
        return place

    def write(
        self,
        results: str | os.PathLike[str] | None = None,
        events: str | os.PathLike[str] | None = None,
        steps: str | os.PathLike[str] | None = None,
        *,
        classes: bool = False,
    ) -> None:
        """Writes one row a trace to ``results``, one row an event to ``events`` and one row a step to ``steps``:
        ``.parquet``, ``.csv`` or ``.jsonl``.

        With ``classes`` the results have the columns ``class`` and ``windings`` of `classes` too.

        The files are those of ``tautline eval --out --events --steps``, and ``--class``, to the byte. Steps are written as they are
        made, in bounded memory.
        """
        paths = [None if path is None else Path(path) for path in (results, events, steps)]
        self._core.write(paths[0], paths[1], paths[2], classes)

    def svg(self, *traces: int, step: int | None = None, dark: bool | None = None) -> Picture:
        """The picture of up to six traces and their ropes as SVG, after a step or at the end.

        >>> import tautrope
        >>> scene = tautrope.Scene.built_in("rooms")
        >>> ropes = scene.evaluate(scene.walks(10, steps=50))
        >>> ropes.svg(3)[:4], ropes.svg(3, step=20) == ropes.svg(3)
        ('<svg', False)
        """
        chosen = traces or (int(self["trace"][0]),)
        return Picture(self._core.svg([self._place(trace) for trace in chosen], step, dark))

    def plot(self, *traces: int, ax: Any = None, step: int | None = None) -> Any:
        """Draws the scene, some traces and their ropes with matplotlib, and returns the axes."""
        ax = self.scene.plot(ax)
        for trace in traces or (int(self["trace"][0]),):
            walked = self.points[self._place(trace)]
            walked = walked if step is None else walked[: step + 1]
            (line,) = ax.plot(*walked.T, linewidth=0.8, alpha=0.6, label=f"trace {trace}")
            ax.plot(*self.rope(trace, step).T, "--", color=line.get_color(), label=f"its rope {trace}")
        return ax

    def __reduce__(self) -> Any:
        return _restored, (self.scene, self._core.state())

    def __repr__(self) -> str:
        return f"<Ropes: {len(self)} traces, engine {self.engine}>"


def names_of(about: Iterable[str | int] | None) -> list[str] | None:
    """Obstacles as the compiled part takes them: all by name."""
    if about is None:
        return None
    if isinstance(about, str):
        raise InputError(f"about: give a list of names, [{about!r}]")
    return [str(name) for name in about]


def _restored(scene: Scene, state: bytes) -> Ropes:
    return Ropes(_core.Ropes.restored(scene._core, state), scene)


def _even(offsets: np.ndarray[Any, Any], values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Lists as one array if they are equally long."""
    counts = np.diff(offsets)
    if len(counts) and (counts == counts[0]).all():
        return values.reshape(len(counts), counts[0], *values.shape[1:])
    return split(offsets, values)
