"""What a study says."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from . import _tautrope as _core
from ._errors import InputError, StudyError
from ._folders import SWEEP, base_of
from ._frames import PARTS, frame, within
from ._ropes import Ropes
from ._scene import Scene
from ._table import Table


class Estimate(NamedTuple):
    """A number with its interval, at the study's confidence (95 % unless it says otherwise).

    Attributes:
        value: The number.
        low: Where the interval begins; None where the traces are too few to say.
        high: Where it ends; None where they are too few.
    """

    value: float
    low: float | None
    high: float | None

    def __str__(self) -> str:
        low, high = (f"{end:.4g}" if end is not None else "?" for end in (self.low, self.high))
        return f"{self.value:.4g} ({low} to {high})"


class Answer:
    """What a study says: its summary as tables, arrays and a page.

    ``Answer(folder)`` opens the folder of any study that has ended, or is under way.
    """

    def __init__(self, folder: str | os.PathLike[str], room: Any = None) -> None:
        #: The study's folder.
        self.folder = Path(folder)
        self._room = room
        file = self.folder / "summary.json"
        if (self.folder / SWEEP).exists():
            raise StudyError(f"{self.folder} holds a sweep; SweepAnswer opens it")
        if file.exists():
            self._text = file.read_text()
        else:
            self._text = _core.look_at_study(self.folder, base_of(self.folder, None))
        #: The summary, as ``summary.json`` has it; docs/studies.md explains all of it.
        self.summary: dict[str, Any] = json.loads(self._text)

    @property
    def scalars(self) -> Any:
        """The mean of each quantity with its standard error and interval, its deviation and extremes: a DataFrame of
        pandas, by the quantity's name."""
        rows = {
            s["name"]: {
                "mean": s["mean"]["value"],
                "error": s["mean"]["error"],
                "low": s["mean"]["low"],
                "high": s["mean"]["high"],
                "deviation": s["deviation"],
                "min": s["min"],
                "max": s["max"],
            }
            for s in self.summary["scalars"]
        }
        return frame(rows, "name")

    @property
    def quantiles(self) -> Any:
        """Below which value each share of the traces lies, with its interval: a DataFrame of pandas by name and
        share."""
        rows = {
            (s["name"], q["share"]): {key: q["value"][key] for key in ("value", "low", "high")}
            for s in self.summary["scalars"]
            for q in s["quantiles"]
        }
        return frame(rows, ["name", "share"])

    def mean(self, name: str) -> Estimate:
        """The mean of ``length``, ``max_length``, ``depth``, ``max_depth``, ``wraps`` or ``unwraps``."""
        return _estimate(self._scalar(name)["mean"])

    def quantile(self, name: str, share: float) -> Estimate:
        """The value below which that share of the traces lies: 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95 or 0.99.

        ``answer.quantile("max_length", 0.99)`` is how long a tether must be for 99 % of the walks to fit.
        """
        found = {q["share"]: q["value"] for q in self._scalar(name)["quantiles"]}
        if share not in found:
            raise InputError(f"no quantile {share} is in the summary; there are {', '.join(map(str, found))}")
        return _estimate(found[share])

    def difference(self, other: Answer, name: str = "max_length", share: float | None = None) -> Estimate:
        """By how much the mean of this answer is above that of another, or with a ``share`` that quantile, with an
        interval.

        ``a.difference(b, "max_length", 0.99)`` is how much longer a tether must be at ``a`` for 99 % of the walks to
        fit. It takes both answers for independent, so the studies must have different seeds. 0 outside of the interval
        means that they differ.

        Raises:
            InputError: The studies have the same seed, or different confidences; there is no such quantile.
        """
        both = [of.mean(name) if share is None else of.quantile(name, share) for of in (self, other)]
        (a, a_low, a_high), (b, b_low, b_high) = both
        confidences = {answer.summary["study"]["tallies"]["confidence"] for answer in (self, other)}
        if len(confidences) > 1:
            raise InputError(f"the studies have different confidences: {sorted(confidences)}")
        seeds = [answer.summary["study"]["run"]["seed"] for answer in (self, other)]
        if seeds[0] == seeds[1]:
            raise InputError(f"both studies have the seed {seeds[0]}; give one of them another, run={{\"seed\": ...}}")
        if a_low is None or a_high is None or b_low is None or b_high is None:
            return Estimate(a - b, None, None)
        below = ((a - a_low) ** 2 + (b_high - b) ** 2) ** 0.5
        above = ((a_high - a) ** 2 + (b - b_low) ** 2) ** 0.5
        return Estimate(a - b, a - b - below, a - b + above)

    def _scalar(self, name: str) -> dict[str, Any]:
        scalars: dict[str, dict[str, Any]] = {s["name"]: s for s in self.summary["scalars"]}
        if name not in scalars:
            raise InputError(f"there is no {name}; give one of {', '.join(scalars)}")
        return scalars[name]

    def histogram(self, name: str = "max_length") -> Any:
        """How many traces lie in each bin, and which share of them: a DataFrame of pandas. Bins without traces are left
        out.

        ``name`` is one of ``length``, ``max_length``, ``depth``, ``max_depth``, as far as the study counts them.
        """
        found = {h["name"]: h for h in self.summary["histograms"]}
        if name not in found:
            raise InputError(f"there is no histogram of {name}; there are {', '.join(found)}")
        width = found[name]["width"]
        rows = {
            bin["bin"]: {
                "from": bin["bin"] * width,
                "to": (bin["bin"] + 1) * width,
                "count": bin["count"],
                "share": bin["share"]["value"],
                "low": bin["share"]["low"],
                "high": bin["share"]["high"],
            }
            for bin in found[name]["bins"]
        }
        return frame(rows, "bin")

    @property
    def survival(self) -> Any:
        """Which share of the ropes has never been longer than each limit, step by step: a DataFrame of pandas."""
        rows = {
            (curve["limit"], at["step"]): {key: at["share"][key] for key in ("value", "low", "high")}
            for curve in self.summary["survival"]
            for at in curve["curve"]
        }
        return frame(rows, ["limit", "step"])

    @property
    def contacts(self) -> Any:
        """The wall ends that ropes touch, the busiest first: a DataFrame of pandas by vertex. ``share`` is that of all
        steps after which the rope has a contact with it, ``wraps`` how often a trace wraps round it."""
        rows = {
            c["vertex"]: {
                "x": c["at"][0],
                "y": c["at"][1],
                **{
                    f"{name}{end}": c[name][key]
                    for name in ("share", "wraps")
                    for end, key in (("", "value"), ("_low", "low"), ("_high", "high"))
                },
                **({"label": c["label"]} if c.get("label") is not None else {}),
            }
            for c in self.summary["contacts"]
        }
        return frame(rows, "vertex")

    @property
    def anchors(self) -> Any:
        """What the ropes of each anchor say, and by how much that differs from the first anchor's: a DataFrame of
        pandas by the anchor's number and the quantity; only of studies with ``tallies = {"anchors": True}``.

        ``x`` and ``y`` are where the anchor is, ``traces`` is how many traces start from it. Quantities are those of
        `scalars`, whose mean is told, and ``within_LIMIT`` for each of ``tallies.limits``: the share of ropes that
        never were longer. ``difference`` is positive where the anchor has more of it than the first one; 0 outside of
        its interval, ``difference_low`` to ``difference_high``, means that they differ.
        """
        rows = {}
        for number, anchor in enumerate(self._anchors()):
            at = {"x": anchor["at"][0], "y": anchor["at"][1], "traces": anchor["traces"]}
            told = anchor["differences"] or {"scalars": [], "within": []}
            against = {d["name"]: d["mean"] for d in told["scalars"]}
            against |= {within(d["limit"]): d["share"] for d in told["within"]}
            values = {s["name"]: s["mean"] for s in anchor["scalars"]}
            values |= {within(w["limit"]): w["share"] for w in anchor["within"]}
            for name, value in values.items():
                difference = against.get(name) or {}
                parts = {f"difference{end}": difference.get(key) for end, key in PARTS.items()}
                rows[number, name] = {**at, **value, **parts}
        return frame(rows, ["anchor", "name"])

    @property
    def anchor_quantiles(self) -> Any:
        """Below which value each share of an anchor's traces lies, with its interval: a DataFrame of pandas by the
        anchor's number, the quantity and the share; as `anchors`."""
        rows = {
            (number, s["name"], q["share"]): {key: q["value"][key] for key in ("value", "low", "high")}
            for number, anchor in enumerate(self._anchors())
            for s in anchor["scalars"]
            for q in s["quantiles"]
        }
        return frame(rows, ["anchor", "name", "share"])

    @property
    def classes(self) -> Any:
        """The most common homotopy classes of ropes at the end, the most common first: a DataFrame of pandas by the
        class's word, as `Ropes.classes` has it, and the anchor's ``x`` and ``y``; only of studies with ``tallies =
        {"classes": 10}`` or so. ``share`` is that of all traces, ``count`` is how many ended with it; at most
        ``at_most``, since classes that are rare in a block are not all counted.
        """
        found = self.summary.get("classes")
        if found is None:
            raise StudyError('the study counts no classes; give it tallies={"classes": 10}')
        rows = {
            (c["class"], *c["anchor"]): {
                "count": c["count"],
                "at_most": c["at_most"],
                **{f"share{end}": c["share"][key] for end, key in (("", "value"), ("_low", "low"), ("_high", "high"))},
            }
            for c in found["classes"]
        }
        return frame(rows, ["class", "x", "y"])

    def _anchors(self) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] | None = self.summary.get("anchors")
        if found is None:
            raise StudyError('the study does not tell its anchors apart; give it tallies={"anchors": True}')
        return found

    @cached_property
    def map(self) -> Any:
        """The plane, cell by cell: a Dataset of xarray, or where that is not installed a dict of arrays.

        Variables, each of shape (rows, columns): ``contacts``, with how many wall ends there the rope has a contact
        after a step, on the mean; ``length``, how long the rope is on the mean while its free end is there; both with
        ``_low`` and ``_high`` for the interval; ``visits``, how often a free end was seen there. ``x`` and ``y`` are
        the middles of the cells. Where nothing came there is NaN, or 0 visits.
        """
        found = self.summary.get("map")
        if found is None:
            raise StudyError("the study counts no map: tallies.map is 0")
        shape = found["rows"], found["columns"]
        names = [f"{of}{end}" for of in ("contacts", "length") for end in ("", "_low", "_high")]
        variables: dict[str, np.ndarray[Any, Any]] = {name: np.full(shape, np.nan) for name in names}
        variables["visits"] = np.zeros(shape, dtype=np.int64)
        for cell in found["cells"]:
            at = divmod(cell["cell"], found["columns"])
            variables["visits"][at] = cell["visits"]
            for of in ("contacts", "length"):
                for end, key in (("", "value"), ("_low", "low"), ("_high", "high")):
                    if cell[of] is not None and cell[of][key] is not None:
                        variables[of + end][at] = cell[of][key]
        low_x, low_y = found["low"]
        x = low_x + found["cell"] * (np.arange(found["columns"]) + 0.5)
        y = low_y + found["cell"] * (np.arange(found["rows"]) + 0.5)
        try:
            import xarray
        except ImportError:
            return {**variables, "x": x, "y": y}
        return xarray.Dataset({name: (("y", "x"), array) for name, array in variables.items()}, {"x": x, "y": y})

    @cached_property
    def traces(self) -> Table:
        """One row a trace, as those of `Ropes`; only of studies with ``outputs = {"traces": True}``."""
        return self._rows("traces", "traces; give it outputs={\"traces\": True}")

    @cached_property
    def steps(self) -> Table:
        """One row for the rope after every step of some traces, as those of `Ropes.steps`; only of studies with
        ``outputs = {"steps": ...}``."""
        return self._rows("steps", "steps; give it outputs={\"steps\": 100}, say, for the first 100 traces")

    @cached_property
    def points(self) -> Table:
        """The points of some traces: ``trace``, ``x``, ``y``, as `Scene.evaluate` takes them; only of studies with
        ``outputs = {"points": ...}``."""
        return self._rows("points", "points; give it outputs={\"points\": 100}, say, for the first 100 traces")

    def _rows(self, name: str, otherwise: str) -> Table:
        file = self.folder / f"{name}.parquet"
        if not file.exists():
            raise StudyError(f"the study wrote no {otherwise}")
        return Table(_core.Table.of_parquet(file))

    def replay(self, trace: int) -> Ropes:
        """The rope of one of the study's traces, drawn and evaluated again: its lengths step by step, its events, its
        picture. The study's folder and its scene must be there. O(steps)."""
        study = _core.Study.of_folder(self.folder, base_of(self.folder, None))
        scene, ropes = study.replay(trace)
        return Ropes(ropes, Scene._of(scene))

    @property
    def report(self) -> str:
        """The page with all tables and pictures, as HTML; only of studies with ``outputs.pictures``."""
        kept = self.__dict__.get("_page")
        if kept is not None:
            return str(kept)
        file = self.folder / "report.html"
        if not file.exists():
            raise StudyError("the study wrote no page: it has not ended, or outputs.pictures is false")
        return file.read_text()

    def _repr_html_(self) -> str:
        try:
            page = self.report
        except StudyError:
            return f"<pre>{html.escape(repr(self))}</pre>"
        # In a frame of its own: the page's style is none of the notebook's.
        style = "width: 100%; height: 40em; border: 1px solid #ccc"
        return f'<iframe srcdoc="{html.escape(page)}" style="{style}"></iframe>'

    def __reduce__(self) -> Any:
        names = ("traces", "steps", "points")
        rows = {name: getattr(self, name) for name in names if self._has(name)}
        try:
            page = self.report
        except StudyError:
            page = None
        return _restored, (self.folder, self._text, rows, page)

    def _has(self, name: str) -> bool:
        return name in self.__dict__ or (self.folder / f"{name}.parquet").exists()

    def __repr__(self) -> str:
        length = self.mean("max_length") if self.summary["traces"] else "unknown"
        of = f"{self.summary['traces']} traces, {self.summary['stopped']}"
        return f"<Answer: {of}, greatest rope length {length} on the mean>"


def _restored(folder: Path, text: str, rows: dict[str, Table], page: str | None) -> Answer:
    """An answer without its folder: on another machine, say."""
    answer = Answer.__new__(Answer)
    answer.folder, answer._room, answer._text, answer.summary = folder, None, text, json.loads(text)
    answer.__dict__["_page"] = page
    answer.__dict__.update(rows)
    return answer


def _estimate(found: Mapping[str, Any]) -> Estimate:
    return Estimate(found["value"], found["low"], found["high"])
