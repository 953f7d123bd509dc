"""Threads, forks and Ctrl-C do no harm."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from tautrope import EngineError, Scene, Study

#: Many walks, which take seconds.
LONG = """
import threading, time, numpy as np, tautrope
scene = tautrope.Scene.built_in("random-20000")
walks = scene.walks(200, steps=20, seed=2)
scene.evaluate(walks[:2])
many = np.tile(walks, (1000, 1, 1))
"""


def interrupted(program: str, tmp_path: Path) -> float:
    """How long a program that says ready goes on after Ctrl-C, until it says that it was interrupted."""
    (tmp_path / "long.py").write_text(program)
    run = subprocess.Popen([sys.executable, tmp_path / "long.py"], stdout=subprocess.PIPE, text=True)
    assert run.stdout is not None
    assert run.stdout.readline() == "ready\n"
    time.sleep(0.4)
    start = time.monotonic()
    run.send_signal(signal.SIGINT)
    assert run.stdout.readline() == "interrupted\n", run.wait()
    took = time.monotonic() - start
    assert run.wait() == 0
    return took


def test_ctrl_c_ends_an_evaluation(tmp_path: Path) -> None:
    tail = """
print("ready", flush=True)
try:
    while True:
        scene.evaluate(many)
except KeyboardInterrupt:
    print("interrupted", flush=True)
# The scene is as good as before.
assert len(scene.evaluate(walks)) == 200
"""
    interrupted(LONG + tail, tmp_path)


def test_ctrl_c_leaves_a_study_that_goes_on(tmp_path: Path) -> None:
    out = tmp_path / "out"
    program = f"""
import tautrope
study = tautrope.Study(scene={{"built_in": "rooms"}}, walk={{"kind": "uniform", "step": 0.3, "steps": 500}},
                       run={{"traces": 1_000_000}})
ready = False
def told(done, of):
    global ready
    if done > 0 and not ready:
        ready = True
        print("ready", flush=True)
try:
    study.run({str(out)!r}, progress=told)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    interrupted(program, tmp_path)
    from tautrope import Answer

    assert Answer(out).summary["stopped"] == "unfinished"


def test_other_threads_go_on_meanwhile(tmp_path: Path) -> None:
    """The interpreter's lock is free while ropes are computed."""
    tail = """
counts = []
done = threading.Event()
def count():
    n = 0
    while not done.is_set():
        n += 1
        time.sleep(0.001)
    counts.append(n)
other = threading.Thread(target=count)
other.start()
start = time.monotonic()
while time.monotonic() - start < 1:
    scene.evaluate(many[:4000])
done.set()
other.join()
print(counts[0])
"""
    ended = subprocess.run([sys.executable, "-c", LONG + tail], capture_output=True, text=True, check=True)
    # With the lock held it would have counted once for each call.
    assert int(ended.stdout) > 20


def test_threads_share_a_scene(rooms: Scene, walks: np.ndarray) -> None:
    expected = rooms.evaluate(walks)["length"]
    scene = Scene.built_in("rooms")
    with ThreadPoolExecutor(8) as pool:
        parts = [pool.submit(scene.evaluate, walks[i : i + 20]) for i in range(0, 300, 20)]
        found = np.concatenate([part.result()["length"] for part in parts])
    assert np.array_equal(found, expected)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes cannot be forked here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_forks_evaluate_too(rooms: Scene, walks: np.ndarray) -> None:
    """Also while another thread of the parent evaluates in the same scene."""
    expected = rooms.evaluate(walks)["length"]
    stop = threading.Event()

    def busy() -> None:
        while not stop.is_set():
            rooms.evaluate(walks)

    thread = threading.Thread(target=busy)
    thread.start()
    try:
        with multiprocessing.get_context("fork").Pool(2) as pool:
            parts = pool.starmap_async(_lengths, [(rooms, walks[i : i + 75]) for i in range(0, 300, 75)]).get(60)
            inherited = pool.apply_async(_inherited).get(60)
    finally:
        stop.set()
        thread.join()
    assert np.array_equal(np.concatenate(parts), expected)
    assert inherited == rooms.evaluate(walks[:1])["length"][0] or inherited is None


def _lengths(scene: Scene, walks: np.ndarray) -> np.ndarray:
    return scene.evaluate(walks)["length"]


#: A scene whose engine was made before the fork.
OLD = Scene.built_in("rooms")
OLD_WALKS = OLD.walks(1, steps=120)
OLD.evaluate(OLD_WALKS)


def _inherited() -> float:
    return float(OLD.evaluate(OLD_WALKS)["length"][0])


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes cannot be forked here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_studies_in_forks_are_refused_rather_than_hanging(tmp_path: Path) -> None:
    _study(tmp_path / "parent")
    with multiprocessing.get_context("fork").Pool(1) as pool, pytest.raises(EngineError, match="spawn"):
        pool.apply_async(_study, [tmp_path / "child"]).get(60)
    assert not (tmp_path / "child").exists()
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply_async(_study, [tmp_path / "child"]).get(120) == 20


def _study(out: Path) -> int:
    walk, outputs = {"kind": "uniform", "step": 0.3, "steps": 10}, {"pictures": False}
    study = Study(scene="rooms", walk=walk, run={"traces": 20}, outputs=outputs)
    traces: int = study.run(out, progress=False).summary["traces"]
    return traces
