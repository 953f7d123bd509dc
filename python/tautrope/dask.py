"""Studies and sweeps on the workers of a Dask cluster: their blocks are shared out, and the answer is that of one run,
byte for byte.

>>> import tautrope, tautrope.dask
>>> from dask.distributed import Client
>>> study = tautrope.Study(scene="rooms", walk={"kind": "uniform", "step": 0.4, "steps": 60}, run={"traces": 3000})
>>> with Client(processes=False, dashboard_address=None) as client:
...     answer = tautrope.dask.run(study, client, progress=False)
>>> answer.summary == study.run(progress=False).summary
True
"""

from __future__ import annotations

import json
import os
import pickle
import shutil
import tempfile
import time
import uuid
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

from . import _tautrope as _core
from ._answer import Answer
from ._errors import InputError, StudyError
from ._folders import SCENE
from ._progress import Progress, Said, warn
from ._study import Study
from ._sweep import Sweep, SweepAnswer

#: How many parts there are at the least, if there are as many blocks, and for each worker.
_LEAST, _EACH = 64, 8


def run(
    study: Study,
    client: Any,
    out: str | os.PathLike[str] | None = None,
    *,
    parts: int | None = None,
    progress: bool | Progress = True,
    engine: str | None = None,
) -> Answer | SweepAnswer:
    """Runs a study or a sweep on the workers of a Dask cluster, and returns the answer: that of ``study.run``, byte for
    byte.

    Parts of the study, each some blocks, are tasks. Whatever comes back is saved at once on the client's machine, below
    ``parts`` in the folder; workers need no folder in common, but the package, and each file that the plan names, at
    the same place. A `Scene` goes along. A worker that is lost costs its parts under way, which Dask gives to others.

    With ``until.relative_error`` the study ends with the first block, in the order of the blocks, after which it is
    certain enough, whatever came back first; what is under way behind that is stopped.

    Ctrl-C stops all of it, and the same call goes on with what is saved, on any cluster and in other parts if you like.
    ``tautline study status`` and ``merge --partial`` take the folders in ``parts`` meanwhile.

    Args:
        study: The study, or a sweep: the parts of all its points are shared out together.
        client: A ``dask.distributed.Client``. A part uses all cores of its worker's machine, or as many threads as the
            environment's RAYON_NUM_THREADS says there: workers of one thread each are enough.
        out: The folder for all that comes out; without it one that is gone when this study and its answers are.
        parts: In how many parts all is shared out, about: each point of a sweep is one at the least. Without it 64, or
            eight for each worker if that is more.
        progress: Whether to say on stderr how far it is; or a function that is told the blocks done and of how many.
        engine: As for `Study.run`, on the workers.

    Raises:
        StudyError: A folder that holds something else, or a study that ends by the clock (``until.seconds``).
        KilledWorker: One of Dask's: a part was lost with several workers, one after the other.
    """
    from dask.distributed import Event, as_completed

    if getattr(client, "asynchronous", False):
        raise InputError("client: give one that waits for its results, Client(..., asynchronous=False)")
    if parts is not None and parts < 1:
        raise InputError(f"parts: {parts} are none; give 1 or more")
    folder, room = study._place(out)
    points = _points(study, folder)
    share = -(-(parts or max(_LEAST, _EACH * len(client.nthreads()))) // len(points))
    stop = Event(f"tautrope-{uuid.uuid4()}", client=client)
    under_way: dict[Any, tuple[_Point, int, int]] = {}
    try:
        with Said(progress) as said:
            for point in points:
                point.conclude_if_done()
                for first, end in point.missing(share) if not point.is_done else ():
                    given = point.pickled, first, end, engine, stop.name
                    future = client.submit(_part, *given, pure=False, retries=2, priority=-first)
                    under_way[future] = point, first, end
            of = sum(point.blocks for point in points)
            for future in as_completed(list(under_way)):
                if future not in under_way:
                    continue
                point, first, end = under_way.pop(future)
                if not future.cancelled():
                    point.save(first, end, future.result())
                    future.release()
                    point.conclude_if_done()
                if point.is_done:
                    behind = [other for other, (of_point, *_) in under_way.items() if of_point is point]
                    client.cancel(behind)
                    for other in behind:
                        del under_way[other]
                if said is not None:
                    said(sum(point.blocks if point.is_done else len(point.saved) for point in points), of)
                if not under_way:
                    break
    finally:
        # What is under way on workers looks at this now and then.
        stop.set()
        client.cancel(list(under_way))
    if not all(point.is_done for point in points):
        raise StudyError("some parts were cancelled by others; what is done is saved, and the same call goes on")
    if isinstance(study, Sweep):
        _core.conclude_sweep(folder, points[0].base)
    for point in points:
        point.tidy()
    _remove(folder / "parts")
    return SweepAnswer(folder, room) if isinstance(study, Sweep) else Answer(folder, room)


def _points(study: Study, folder: Path) -> list[_Point]:
    """The studies that are to be done, each with its folder."""
    if not isinstance(study, Sweep):
        return [_Point(study, folder, folder / "parts", folder if study._scene is not None else study._base)]
    folders, base = study._swept.begin(folder, study._scene)
    points = []
    for own, plan in zip(folders, study.plans, strict=True):
        one = object.__new__(Study)
        one._keep(str(base), study._scene)
        one._core = _core.Study.of_text(json.dumps(plan), True, base)
        points.append(_Point(one, own, folder / "parts" / own.name, base))
    return points


class _Point:
    """A study that is shared out: what of it is saved, and what is missing."""

    def __init__(self, study: Study, folder: Path, parts: Path, base: Path) -> None:
        self.study, self.folder, self.parts, self.base = study, folder, parts, base
        self.blocks = study._core.blocks
        until = study.plan["until"]
        if until.get("seconds") is not None:
            raise StudyError("until.seconds: a study that is shared out does not end by the clock; leave it out")
        self.has_rule = until.get("relative_error") is not None
        self.pickled = pickle.dumps(study)
        self.is_done = False
        #: How many blocks without a gap were found not to be enough, and when next to ask.
        self._asked, self._next = 0, 0.0
        if (folder / "state.bin").exists():
            there = Answer(folder)
            if there.summary["identity"] != study.identity:
                raise StudyError(f"{folder} holds another study already; give another folder")
            if there.summary["stopped"] == "unfinished":
                raise StudyError(f"{folder} holds part of this study, begun without Dask; go on with study.run")
            if not (folder / "summary.json").exists():
                # It was put together, and stopped before that was told.
                warn(study._core.run(folder, None, None, study._scene))
            self.is_done = True
        for left in parts.glob(".new-*"):
            shutil.rmtree(left)
        #: The folders of parts that are saved, by each block in them.
        self.saved: dict[int, Path] = {}
        for part in parts.glob("part-*-*"):
            first, end = map(int, part.name.split("-")[1:])
            self.saved.update(dict.fromkeys(range(first, end), part))
        if study._scene is not None and not self.is_done:
            base.mkdir(parents=True, exist_ok=True)
            (base / SCENE).write_text(study._scene)
        if self.saved and not self.is_done:
            # Those of another study are refused before anything is computed.
            _core.are_enough(study._core, self._folders())

    def _folders(self, end: int | None = None) -> list[Path]:
        return sorted({part for block, part in self.saved.items() if end is None or block < end})

    def missing(self, parts: int) -> Iterator[tuple[int, int]]:
        """The blocks that are not saved, as ranges for so many parts."""
        most = -(-self.blocks // parts)
        first = 0
        while first < self.blocks:
            if first in self.saved:
                first += 1
                continue
            end = first + 1
            while end < min(first + most, self.blocks) and end not in self.saved:
                end += 1
            yield first, end
            first = end

    def save(self, first: int, end: int, files: dict[str, bytes]) -> None:
        """Keeps a part, whole or not at all."""
        new = self.parts / f".new-{first}"
        for name, data in files.items():
            (new / name).parent.mkdir(parents=True, exist_ok=True)
            (new / name).write_bytes(data)
        part = self.parts / f"part-{first:06}-{end:06}"
        new.rename(part)
        self.saved.update(dict.fromkeys(range(first, end), part))

    def tidy(self) -> None:
        """Removes the parts, once the answer is there."""
        for part in self._folders():
            shutil.rmtree(part)
        _remove(self.parts)

    def conclude_if_done(self) -> None:
        """Puts the parts together once they are all, or as many as the answer needs."""
        if self.is_done or not self.saved:
            return
        if len(self.saved) < self.blocks and not self._is_enough():
            return
        warn(_core.merge_parts(self._folders(), self.base, self.folder))
        self.is_done = True

    def _is_enough(self) -> bool:
        """Whether the blocks up to the first that is missing are certain enough. It is not asked all the time."""
        gap = self._asked
        while gap in self.saved:
            gap += 1
        if not self.has_rule or gap == self._asked or time.monotonic() < self._next:
            return False
        start = time.monotonic()
        is_enough = _core.are_enough(self.study._core, self._folders(gap))
        self._asked, self._next = gap, time.monotonic() + 4 * (time.monotonic() - start)
        return is_enough


def _remove(folder: Path) -> None:
    """Removes a folder of parts, unless somebody else's files are in it."""
    with suppress(OSError):
        folder.rmdir()


@lru_cache(maxsize=4)
def _opened(study: bytes) -> Study:
    """A study on a worker, for all its parts."""
    opened: Study = pickle.loads(study)
    return opened


def _part(study: bytes, first: int, end: int, engine: str | None, stop: str) -> dict[str, bytes]:
    """Does some blocks on a worker, and returns the files of their folder."""
    from dask.distributed import Event

    event, asked = Event(stop), time.monotonic()

    def watch(*_: int) -> None:
        nonlocal asked
        if time.monotonic() - asked > 1:
            asked = time.monotonic()
            if event.is_set():
                raise StudyError("stopped")

    with tempfile.TemporaryDirectory(prefix="tautrope-") as room:
        folder = Path(room, "part")
        _opened(study)._core.run_part(folder, first, end, engine, watch)
        files = [file for file in folder.rglob("*") if file.is_file() and file.name != "lock"]
        return {
            str(file.relative_to(folder)): file.read_bytes() for file in files if not file.name.startswith("lease.")
        }
