"""Studies and sweeps on a Dask cluster of two processes: the bytes of one run, whatever happens meanwhile."""

from __future__ import annotations

import os
import pickle
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import tautrope
import tautrope.dask
from conftest import Program
from tautrope import Answer, InputError, Scene, Study, StudyError, SweepAnswer

WALK = {"kind": "persistent", "step": 0.3, "steps": 60}
BARE = {"pictures": False}


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    from dask.distributed import Client, LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        yield client


def study(traces: int = 4000, **sections: Any) -> Study:
    plan = {"scene": "rooms", "walk": WALK, "run": {"traces": traces, "block": 50}, "outputs": BARE, **sections}
    return Study(plan)


def same(own: Answer, truth: Answer) -> None:
    assert (own.folder / "summary.json").read_bytes() == (truth.folder / "summary.json").read_bytes()
    assert not (own.folder / "parts").exists()


def test_the_answer_is_that_of_one_run(client: Any, tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    plan = study(outputs={"traces": True})
    own = tautrope.dask.run(plan, client, tmp_path / "out", progress=lambda *of: told.append(of))
    truth = plan.run(progress=False)
    assert isinstance(own, Answer)
    same(own, truth)
    assert own.traces.to_arrow().equals(truth.traces.to_arrow()) and own.report
    assert told[-1] == (80, 80) and len(told) > 30 and sorted(told) == told
    # What is done is done.
    told.clear()
    again = tautrope.dask.run(plan, client, tmp_path / "out", progress=lambda *of: told.append(of))
    assert again.summary == own.summary and not told
    # So is what was put together and not told any more. What others keep in the folder stays.
    (tmp_path / "out/parts").mkdir()
    (tmp_path / "out/parts/mine.txt").write_text("mine")
    (tmp_path / "out/summary.json").unlink()
    again = tautrope.dask.run(plan, client, tmp_path / "out", progress=False)
    assert (again.folder / "summary.json").read_bytes() == (truth.folder / "summary.json").read_bytes()
    assert (tmp_path / "out/parts/mine.txt").read_text() == "mine"
    temporary = tautrope.dask.run(plan, client, progress=False, parts=3)
    assert temporary.summary == own.summary


def test_the_rule_ends_it_with_the_block_of_one_run(client: Any) -> None:
    plan = study(60_000, until={"relative_error": 0.02}, outputs={"traces": True, "pictures": False})
    truth = plan.run(progress=False)
    assert truth.summary["stopped"] == "relative_error" and truth.summary["blocks"] < 300
    own = tautrope.dask.run(plan, client, progress=False, parts=400)
    assert isinstance(own, Answer)
    same(own, truth)
    assert own.traces.to_arrow().equals(truth.traces.to_arrow())


def test_a_worker_that_is_killed(client: Any) -> None:
    plan = study(40_000)
    before = client.run(os.getpid)
    killed: list[int] = []

    def kill(done: int, of: int) -> None:
        if not killed:
            killed.append(next(iter(before.values())))
            os.kill(killed[0], signal.SIGKILL)

    own = tautrope.dask.run(plan, client, progress=kill)
    client.wait_for_workers(2)
    assert killed and killed[0] not in client.run(os.getpid).values()
    assert isinstance(own, Answer)
    same(own, plan.run(progress=False))


def test_what_was_stopped_goes_on(client: Any, program: Program, tmp_path: Path) -> None:
    def stop(done: int, of: int) -> None:
        if done >= 24:
            raise KeyboardInterrupt

    plan = study()
    with pytest.raises(KeyboardInterrupt):
        tautrope.dask.run(plan, client, tmp_path / "out", progress=stop, parts=40)
    parts = sorted((tmp_path / "out/parts").iterdir())
    assert 12 <= len(parts) < 40 and not (tmp_path / "out/summary.json").exists()
    # They are parts like any others.
    assert "24" in program("study", "status", *parts)
    assert tautrope.status(*parts)["done"].tolist() == [2] * len(parts)
    # Half of a part that was being saved is none.
    (tmp_path / "out/parts/.new-7").mkdir()
    with pytest.raises(StudyError, match="study"):
        tautrope.dask.run(study(3000), client, tmp_path / "out", progress=False)
    told: list[int] = []
    own = tautrope.dask.run(plan, client, tmp_path / "out", progress=lambda done, _: told.append(done), parts=7)
    assert told[0] > 24 and isinstance(own, Answer)
    same(own, plan.run(progress=False))


def test_what_is_under_way_is_stopped(client: Any) -> None:
    import time

    # Parts of minutes each: the workers must be free again at once.
    plan = study(2_000_000, run={"traces": 2_000_000, "block": 50})

    class Client:
        """Stops the driver as soon as all is handed over."""

        def __getattr__(self, name: str) -> Any:
            return getattr(client, name)

        def submit(self, *given: Any, **named: Any) -> Any:
            future = client.submit(*given, **named)
            if named["priority"] != 0:
                time.sleep(2)
                raise KeyboardInterrupt
            return future

    with pytest.raises(KeyboardInterrupt):
        tautrope.dask.run(plan, Client(), progress=False, parts=2)
    start = time.monotonic()
    while any(client.processing().values()) or any(client.run(_is_busy).values()):
        assert time.monotonic() - start < 20
        time.sleep(0.2)


def _is_busy(dask_worker: Any) -> bool:
    return bool(dask_worker.state.executing_count or dask_worker.active_threads)


def test_parts_that_others_cancel_are_said_and_not_lost(client: Any, tmp_path: Path) -> None:
    class Client:
        """Somebody else cancels some parts."""

        def __getattr__(self, name: str) -> Any:
            return getattr(client, name)

        def submit(self, *given: Any, **named: Any) -> Any:
            future = client.submit(*given, **named)
            if named["priority"] < -60:
                future.cancel()
            return future

    plan = study()
    with pytest.raises(StudyError, match="cancelled by others"):
        tautrope.dask.run(plan, Client(), tmp_path / "out", progress=False)
    assert 20 < len(list((tmp_path / "out/parts").iterdir())) < 80
    own = tautrope.dask.run(plan, client, tmp_path / "out", progress=False)
    assert isinstance(own, Answer)
    same(own, plan.run(progress=False))


def test_a_sweep_in_a_scene_of_ones_own(client: Any, tmp_path: Path) -> None:
    scene = Scene([[[-1, 0], [1, 0]], [[3, 3], [5, 1]]], anchor=(0, -1))
    plan = study(800, scene=scene, sweep={"walk.step": [0.2, 0.3, 0.4]}, until={"relative_error": 0.05})
    truth = plan.run(tmp_path / "one", progress=False)
    own = tautrope.dask.run(plan, client, tmp_path / "own", progress=False)
    assert isinstance(own, SweepAnswer)
    for name in ("sweep.csv", "sweep.parquet", "sweep.svg", *(f"point-00{i}/summary.json" for i in range(3))):
        assert (tmp_path / "own" / name).read_bytes() == (tmp_path / "one" / name).read_bytes(), name
    assert {point.summary["stopped"] for point in own} == {"relative_error"} and truth.summary == own.summary
    assert not (tmp_path / "own/parts").exists()
    moved = (tmp_path / "own").rename(tmp_path / "moved")
    assert Study.resume(moved, progress=False).summary == truth.summary


def test_a_study_without_files_needs_no_folder_in_common(tmp_path: Path) -> None:
    (tmp_path / "gone").mkdir()
    there = pickle.dumps(Study({**study().plan, "run": {"traces": 60, "block": 20}}, base=tmp_path / "gone"))
    (tmp_path / "gone").rmdir()
    pickle.loads(there)._core.run_part(tmp_path / "part", 1, 3, None, None)
    assert tautrope.status(tmp_path / "part").iloc[0]["part"] == "0/1 of blocks 1..3"


def test_what_will_not_do(client: Any, tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="until.seconds"):
        tautrope.dask.run(study(until={"seconds": 5}), client, progress=False)
    with pytest.raises(InputError, match="parts: 0"):
        tautrope.dask.run(study(), client, progress=False, parts=0)
    study(100).run(tmp_path / "taken", progress=False)
    with pytest.raises(StudyError, match="holds another study"):
        tautrope.dask.run(study(), client, tmp_path / "taken", progress=False)
    # What a worker finds out arrives as the package's own.
    with pytest.raises(InputError, match="does not count the same events"):
        tautrope.dask.run(study(), client, progress=False, engine="note")
