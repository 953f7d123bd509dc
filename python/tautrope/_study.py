"""Monte-Carlo studies."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from . import _tautrope as _core
from ._answer import Answer
from ._errors import InputError, StudyError
from ._folders import SCENE, SWEEP, base_of
from ._progress import Progress, Said, warn
from ._scene import Scene


class Study:
    """Very many random walks in a scene, and what their ropes are like on the whole.

    A plan has these sections, of which only ``scene`` and ``walk`` are needed (docs/studies.md explains all keys, and
    ``Study(...).plan`` shows them with what they are if left out):

    - ``scene``: ``{"built_in": "rooms"}`` or ``{"file": "plan.svg"}``, with ``anchor`` if the file marks none, or a
      list of anchors from which walks start by turns
    - ``walk``: ``{"kind": ..., "step": length of a step, "steps": how many}``. Kinds are ``uniform`` (any direction),
      ``gaussian``, ``persistent`` (keeps its heading but for ``turn``), ``waypoints`` (drives from goal to goal), and
      ``given`` (the traces of ``file``)
    - ``run``: ``{"traces": how many, "seed": a number, "block": traces that are counted as one, ...}``. Errors of means
      and of differences come from how blocks differ, so have ten of them or more
    - ``tallies``: what is counted: ``limits`` of lengths, ``map`` (cells along the longer side), ``confidence``,
      ``anchors`` (whether `Answer.anchors` tells them apart), ...
    - ``until``: when to stop earlier: ``relative_error``, ``seconds``
    - ``outputs``: what is written besides: ``traces`` (one row a trace), ``steps`` and ``points`` (of how many traces,
      or of which: `Answer.steps`, `Answer.points`), ``pictures``
    - ``sweep``: keys with a list of values each, ``{"walk.step": [0.2, 0.4]}``: the plan is a `Sweep` then, whose
      ``run`` gives a `SweepAnswer`

    `tautrope.dask.run` runs a study on a Dask cluster.

    Args:
        plan: A study's file (``.toml``), or a dict with the same sections; see docs/studies.md for all keys. Without it
            only what the keywords say.
        base: The folder from which the plan's files are named, if it is no file: the current one without it.
        sections: Sections of the plan: ``scene``, ``walk``, ``run``, ``tallies``, ``until``, ``outputs``, ``sweep``.
            ``scene`` may be a `Scene`, too, or the name of a built-in one.

    >>> import tautrope
    >>> scene = tautrope.Scene([[[-1, 0], [1, 0]], [[3, 3], [5, 1]]], anchor=(0, -1))
    >>> walk = {"kind": "uniform", "step": 0.3, "steps": 50}
    >>> answer = tautrope.Study(scene=scene, walk=walk, run={"traces": 2000}).run(progress=False)
    >>> length = answer.quantile("max_length", 0.99)
    >>> length.low <= length.value <= length.high
    True
    """

    def __new__(
        cls,
        plan: Mapping[str, Any] | str | os.PathLike[str] | None = None,
        *,
        base: str | os.PathLike[str] | None = None,
        **sections: Any,
    ) -> Study:
        """A plan with a section ``sweep`` makes a `Sweep`."""
        is_file = plan is not None and not isinstance(plan, Mapping)
        is_swept = _core.has_sweep(Path(plan)) if is_file else "sweep" in {**(plan or {}), **sections}  # type: ignore
        if cls is Study and is_swept:
            from ._sweep import Sweep

            return object.__new__(Sweep)
        return object.__new__(cls)

    def __init__(
        self,
        plan: Mapping[str, Any] | str | os.PathLike[str] | None = None,
        *,
        base: str | os.PathLike[str] | None = None,
        **sections: Any,
    ) -> None:
        #: Where a study without a folder of its own is run; it goes with the study and its answers.
        self._room: tempfile.TemporaryDirectory[str] | None = None
        #: The text of a scene that is no file of the user's.
        self._scene: str | None = None
        if plan is not None and not isinstance(plan, Mapping):
            if sections or base is not None:
                raise InputError("give a study's file, or its sections, not both")
            #: From where its files are named.
            self._base = Path(plan).absolute().parent
            self._open_file(Path(plan))
            return
        whole = {**(plan or {}), **sections}
        self._base = Path(base).absolute() if base is not None else Path.cwd()
        if isinstance(whole.get("scene"), str):
            whole["scene"] = {"built_in": whole["scene"]}
        if isinstance(whole.get("scene"), Scene):
            whole["scene"] = self._take(whole["scene"])
        self._open(whole)

    def _take(self, scene: Scene) -> dict[str, Any]:
        """Keeps a scene of one's own, and says where it is."""
        self._room = tempfile.TemporaryDirectory(prefix="tautrope-")
        self._base = Path(self._room.name)
        scene.write(self._base / SCENE)
        self._scene = (self._base / SCENE).read_text()
        return {"file": SCENE}

    def _keep(self, base: str, scene: str | None) -> None:
        """What a pickle says of where files are."""
        self._room, self._scene, self._base = None, scene, Path(base)
        if scene is not None:
            self._room = tempfile.TemporaryDirectory(prefix="tautrope-")
            self._base = Path(self._room.name)
            (self._base / SCENE).write_text(scene)

    def _open_file(self, path: Path) -> None:
        self._core = _core.Study.of_file(path)

    def _open(self, plan: dict[str, Any]) -> None:
        self._core = _core.Study.of_text(as_json(plan), True, self._base)

    @classmethod
    def example(cls) -> Study:
        """The study that ``tautline study run`` runs without a file."""
        study = object.__new__(Study)
        study._room, study._scene, study._base = None, None, Path.cwd()
        study._core = _core.Study.of_text(_core.example_study(), False, Path.cwd())
        return study

    @property
    def plan(self) -> dict[str, Any]:
        """The plan, with all that was left out."""
        plan: dict[str, Any] = json.loads(self._core.plan)
        return plan

    @property
    def identity(self) -> str:
        """A hash of all that the answer depends on."""
        return self._core.identity

    def run(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        progress: bool | Progress = True,
        engine: str | None = None,
    ) -> Answer:
        """Runs the study, or goes on with what is in the folder, and returns the answer.

        Ctrl-C ends it; what is done is saved, and the same call goes on with it, as does `resume` with the folder.

        Args:
            out: The folder for all that comes out; without it one that is gone when this study and its answers are.
            progress: Whether to say on stderr how far it is; or a function that is told the steps done and of how many.
            engine: ``cpu``, ``gpu`` or ``reference``; without it the one that suits the machine.
        """
        folder, room = self._place(out)
        with Said(progress) as said:
            warn(self._core.run(folder, engine, said, self._scene))
        return Answer(folder, room)

    def _place(self, out: str | os.PathLike[str] | None) -> tuple[Path, Any]:
        """The folder to run in, and what keeps it for as long as it is needed."""
        if out is not None:
            return Path(out), None
        if self._room is None:
            self._room = tempfile.TemporaryDirectory(prefix="tautrope-")
        return Path(self._room.name, "study"), self._room

    @staticmethod
    def resume(
        folder: str | os.PathLike[str],
        *,
        base: str | os.PathLike[str] | None = None,
        progress: bool | Progress = True,
        engine: str | None = None,
    ) -> Answer:
        """Goes on with the study in a folder, whatever program began it, and returns the answer: with a sweep's folder
        a `SweepAnswer`.

        Args:
            folder: The study's folder.
            base: The folder from which its files are named, if they have moved.
            progress: As for `run`.
            engine: As for `run`.
        """
        place = Path(folder)
        if (place / SWEEP).exists():
            from ._sweep import Sweep

            return Sweep.resume(place, base=base, progress=progress, engine=engine)  # type: ignore[return-value]
        with Said(progress) as said:
            warn(_core.resume_study(place, base_of(place, base), engine, said))
        return Answer(place)

    def __reduce__(self) -> Any:
        return _restored_study, (self._core.plan, str(self._base), self._scene)

    def __repr__(self) -> str:
        plan = self.plan
        return f"<Study: {plan['run']['traces']} traces, walk {plan['walk']['kind']}, scene {plan['scene']}>"


def _restored_study(plan: str, base: str, scene: str | None) -> Study:
    """A study that was pickled, with a scene of its own if it had one."""
    study = object.__new__(Study)
    study._keep(base, scene)
    study._core = _core.Study.of_text(plan, True, study._base)
    return study


def plain(value: Any) -> Any:
    """Numbers and arrays of numpy, and paths, as JSON has them."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} cannot stand in a plan")


def as_json(plan: Mapping[str, Any]) -> str:
    try:
        return json.dumps(plan, default=plain)
    except TypeError as error:
        raise StudyError(f"the plan: {error}") from None
