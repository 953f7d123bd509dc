"""Studies that differ in the values of some keys."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from . import _tautrope as _core
from ._answer import Answer
from ._errors import InputError
from ._folders import base_of
from ._frames import PARTS, frame, within
from ._ropes import Picture
from ._progress import Progress, Said, warn
from ._study import Study, plain
from ._table import Table

#: What names a point: its number, or the values of the keys.
Point = int | Mapping[str, Any]


class Sweep(Study):
    """Studies that differ in the values of some keys: how does the answer change with them?

    A plan with a section ``sweep`` is one: ``Study(plan)`` makes a `Sweep` of it, and so does ``Sweep(plan)``, by which
    type checkers know. The section gives keys of the plan a
    list of values each, and there is a study, a point, for each of them, with every value of each other key. Trace i of
    all points has the same random numbers, so that differences between points are more certain than their answers.

    ``sweep={"walk.step": [0.2, 0.4]}`` compares all points with the first one; ``"against": 1`` in it with the second.

    >>> import tautrope
    >>> walk = {"kind": "uniform", "step": 0.2, "steps": 40}
    >>> run = {"traces": 500, "block": 50}
    >>> sweep = tautrope.Study(scene="rooms", walk=walk, run=run, sweep={"walk.step": [0.2, 0.4]})
    >>> answer = sweep.run(progress=False)
    >>> [*answer.quantile("max_length", 0.99).columns], len(answer)
    (['value', 'low', 'high'], 2)
    >>> bool(answer.differences().loc[(0.4, "max_length"), "low"] > 0)
    True
    """

    _swept: _core.Sweep

    def _open_file(self, path: Path) -> None:
        self._text = path.read_text()
        self._swept = _core.Sweep.of_file(path)

    def _open(self, plan: dict[str, Any]) -> None:
        self._text = _toml(json.loads(json.dumps(plan, default=plain)))
        self._swept = _core.Sweep.of_text(self._text, self._base)

    @property
    def keys(self) -> list[str]:
        """The keys that differ from point to point."""
        return self._swept.keys

    @property
    def plans(self) -> list[dict[str, Any]]:
        """The plans of all points, with all that was left out: with the first values of all keys, then with the second
        one of the last key, and so on."""
        return [json.loads(plan) for _, plan in self._swept.points]

    @property
    def plan(self) -> dict[str, Any]:
        """The plan of the first point, with all that was left out."""
        return self.plans[0]

    @property
    def identity(self) -> str:
        """A hash of the plans of all points."""
        import hashlib

        return hashlib.sha256("\n".join(plan for _, plan in self._swept.points).encode()).hexdigest()

    def run(  # type: ignore[override]
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        progress: bool | Progress = True,
        engine: str | None = None,
    ) -> SweepAnswer:
        """Runs all points, or goes on with what is in the folder, and returns their answers; as `Study.run`."""
        folder, room = self._place(out)
        with Said(progress) as said:
            warn(self._swept.run(folder, engine, said, self._scene))
        return SweepAnswer(folder, room)

    @staticmethod
    def resume(  # type: ignore[override]
        folder: str | os.PathLike[str],
        *,
        base: str | os.PathLike[str] | None = None,
        progress: bool | Progress = True,
        engine: str | None = None,
    ) -> SweepAnswer:
        """Goes on with the sweep in a folder, whatever program began it, and returns the answers; as `Study.resume`."""
        place = Path(folder)
        with Said(progress) as said:
            warn(_core.resume_sweep(place, base_of(place, base), engine, said))
        return SweepAnswer(place)

    def __reduce__(self) -> Any:
        return _restored_sweep, (self._text, str(self._base), self._scene)

    def __repr__(self) -> str:
        return f"<Sweep: {len(self._swept.points)} studies over {', '.join(self.keys)}>"


class SweepAnswer:
    """What the points of a sweep say, side by side.

    ``SweepAnswer(folder)`` opens the folder of any sweep that has ended, or is under way. Tables are DataFrames of
    pandas, whose rows go by the values of the swept keys. ``answer[3]`` is the `Answer` of point 3,
    ``answer[{"walk.step": 0.4}]`` that of the point with this value.
    """

    def __init__(self, folder: str | os.PathLike[str], room: Any = None) -> None:
        #: The sweep's folder.
        self.folder = Path(folder)
        self._room = room
        self._text, table, picture = _core.look_at_sweep(self.folder, base_of(self.folder, None), None)
        self._take(Table(table), picture)

    def _take(self, table: Table, picture: str | None) -> None:
        #: What all points say, as ``tautline study show --json`` prints it.
        self.summary: dict[str, Any] = json.loads(self._text)
        #: One row a point: what ``sweep.csv`` and ``sweep.parquet`` hold; docs/studies.md explains the columns.
        self.table = table
        self._picture = picture
        self._answers: dict[int, Answer] = {}

    @property
    def keys(self) -> list[str]:
        """The keys that differ from point to point."""
        return list(self.summary["keys"])

    @property
    def against(self) -> int:
        """The number of the point with which all are compared."""
        return int(self.summary["against"])

    @property
    def points(self) -> Any:
        """One row a point: its folder, the values of the keys, traces and blocks, and of each quantity its mean, its
        quantiles and the difference of its mean, each with ``_error``, ``_low`` and ``_high`` behind its name; a
        DataFrame by the point's number."""
        points = self.table.to_pandas()
        points.index.name = "number"
        return points

    @property
    def scalars(self) -> Any:
        """The mean of each quantity with its standard error and interval, its deviation and extremes: a DataFrame by
        the values of the keys and the quantity's name."""
        return self._frame(
            lambda point: {
                (s["name"],): {**s["mean"], "deviation": s["deviation"], "min": s["min"], "max": s["max"]}
                for s in point["scalars"]
            },
            ["name"],
        )

    @property
    def quantiles(self) -> Any:
        """Below which value each share of the traces lies, with its interval: a DataFrame by the values of the keys,
        name and share."""
        return self._frame(
            lambda point: {
                (s["name"], q["share"]): {key: q["value"][key] for key in ("value", "low", "high")}
                for s in point["scalars"]
                for q in s["quantiles"]
            },
            ["name", "share"],
        )

    def mean(self, name: str = "max_length") -> Any:
        """How the mean of a quantity changes with the keys: a DataFrame by their values, with ``value``, ``error``,
        ``low`` and ``high``."""
        return self._frame(lambda point: {(): self._scalar(point, name)["mean"]}, [])

    def quantile(self, name: str, share: float) -> Any:
        """How a quantile changes with the keys: a DataFrame by their values, with ``value``, ``low`` and ``high``.

        ``answer.quantile("max_length", 0.99)`` is how long a tether must be for 99 % of the walks to fit.
        """

        def of(point: Mapping[str, Any]) -> Any:
            found = {q["share"]: q["value"] for q in self._scalar(point, name)["quantiles"]}
            if share not in found:
                raise InputError(f"no quantile {share} is in the answer; there are {', '.join(map(str, found))}")
            return {(): {key: found[share][key] for key in ("value", "low", "high")}}

        return self._frame(of, [])

    def differences(self, against: Point | None = None) -> Any:
        """By how much the mean of each quantity is above that of another point, with an interval: a DataFrame by the
        values of the keys and the quantity's name. 0 outside of the interval means that they differ. ``within_LIMIT``
        is the share of ropes that never were longer than one of ``tallies.limits``.

        Args:
            against: The other point, by its number or the values of the keys; the one that the sweep names without it.
                The sweep's folder must be there for another than that.
        """
        number = self.against if against is None else self._number(against)
        summary = self.summary
        if number != self.against:
            text, _, _ = _core.look_at_sweep(self.folder, base_of(self.folder, None), number)
            summary = json.loads(text)

        def of(point: Mapping[str, Any]) -> Any:
            told = point["differences"] or {"scalars": [], "within": []}
            named = [(d["name"], d["mean"]) for d in told["scalars"]]
            named += [(within(d["limit"]), d["share"]) for d in told["within"]]
            return {(name,): dict(value) if value else dict.fromkeys(PARTS.values()) for name, value in named}

        return self._frame(of, ["name"], summary)

    def _scalar(self, point: Mapping[str, Any], name: str) -> dict[str, Any]:
        scalars: dict[str, dict[str, Any]] = {s["name"]: s for s in point["scalars"]}
        if name not in scalars:
            raise InputError(f"there is no {name}; give one of {', '.join(scalars)}")
        return scalars[name]

    @cached_property
    def _values(self) -> list[tuple[Any, ...]]:
        """The values of the keys, of each point."""
        columns = [self.table[key].tolist() for key in self.keys]
        return list(zip(*columns, strict=True))

    def _frame(self, of: Any, names: list[str], summary: Mapping[str, Any] | None = None) -> Any:
        """A row for all that is told of each point which has begun."""
        points = (summary or self.summary)["points"]
        rows = {
            (*values, *key): row
            for values, point in zip(self._values, points, strict=True)
            if point["traces"]
            for key, row in of(point).items()
        }
        index = self.keys + names
        if len(index) == 1:
            return frame({key: row for (key,), row in rows.items()}, index[0])
        return frame(rows, index)

    def _number(self, point: Point) -> int:
        if isinstance(point, Mapping):
            unknown = [key for key in point if key not in self.keys]
            if unknown:
                raise InputError(f"{unknown[0]} is not swept; the keys are {', '.join(self.keys)}")
            wanted = json.loads(json.dumps(dict(point), default=plain))
            found = [i for i in range(len(self)) if self._has(i, wanted)]
            if len(found) != 1:
                raise InputError(f"{len(found)} points have {dict(point)}; one is needed")
            return found[0]
        number = int(point)
        if not -len(self) <= number < len(self):
            # What iteration by numbers ends with, too.
            raise IndexError(f"there is no point {number}; they are 0 to {len(self) - 1}")
        return number % len(self)

    def _has(self, number: int, wanted: Mapping[str, Any]) -> bool:
        """Whether a point has these values, which may be the texts that tables have for lists."""
        given = dict(zip(self.keys, self.summary["points"][number]["values"], strict=True))
        told = dict(zip(self.keys, self._values[number], strict=True))
        return all(value == given[key] or value == told[key] for key, value in wanted.items())

    def __getitem__(self, point: Point) -> Answer:
        """What a point says alone."""
        number = self._number(point)
        if number not in self._answers:
            self._answers[number] = Answer(self.folder / self.summary["points"][number]["folder"], self._room)
        return self._answers[number]

    def __len__(self) -> int:
        return len(self.summary["points"])

    def __iter__(self) -> Iterator[Answer]:
        return (self[number] for number in range(len(self)))

    def svg(self) -> Picture:
        """The picture of the mean greatest rope length against the swept keys, as SVG.

        Raises:
            InputError: No point has an answer yet.
        """
        if self._picture is None:
            raise InputError("there is nothing to draw before a point has an answer")
        return Picture(self._picture)

    def _repr_html_(self) -> str:
        means = self.mean()._repr_html_() if any(point["traces"] for point in self.summary["points"]) else ""
        return f"<p>{html.escape(repr(self))}</p>{self._picture or ''}{means}"

    def __reduce__(self) -> Any:
        begun = {i: self[i] for i, point in enumerate(self.summary["points"]) if point["traces"]}
        return _restored_answer, (self.folder, self._text, self.table, self._picture, begun)

    def __repr__(self) -> str:
        points = self.summary["points"]
        done = sum(point["stopped"] != "unfinished" for point in points)
        return f"<SweepAnswer: {len(points)} studies over {', '.join(self.keys)}, {done} done>"


def _restored_sweep(text: str, base: str, scene: str | None) -> Sweep:
    """A sweep that was pickled, with a scene of its own if it had one."""
    sweep = object.__new__(Sweep)
    sweep._keep(base, scene)
    sweep._text, sweep._swept = text, _core.Sweep.of_text(text, sweep._base)
    return sweep


def _restored_answer(
    folder: Path, text: str, table: Table, picture: str | None, answers: dict[int, Answer]
) -> SweepAnswer:
    """Answers without their folder: on another machine, say."""
    answer = object.__new__(SweepAnswer)
    answer.folder, answer._room, answer._text = folder, None, text
    answer._take(table, picture)
    answer._answers = answers
    return answer


def _toml(plan: Mapping[str, Any]) -> str:
    """A plan as a study's file has it: what is swept goes by the order in which it stands there."""
    swept = _flat(plan.get("sweep"))
    lines = [f"{_key(name)} = {_value(value)}" for name, value in plan.items() if name != "sweep" and value is not None]
    return "\n".join([*lines, "[sweep]", *(f"{_path(name)} = {_value(value)}" for name, value in swept.items())])


def _flat(swept: Any, outer: str = "") -> dict[str, Any]:
    """The keys that are swept, each with its dots, however they are nested."""
    if not isinstance(swept, Mapping):
        raise InputError('sweep: give keys with a list of values each, {"walk.step": [0.2, 0.4]}')
    flat: dict[str, Any] = {}
    for name, value in swept.items():
        flat |= _flat(value, f"{outer}{name}.") if isinstance(value, Mapping) else {f"{outer}{name}": value}
    return flat


def _path(name: str) -> str:
    return ".".join(_key(part) for part in name.split("."))


def _key(name: str) -> str:
    return json.dumps(name, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items() if v is not None) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, str):
        return _key(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None:
        raise InputError("sweep: None is no value of a key")
    return repr(value)
