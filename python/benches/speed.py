"""How fast the package is: ropes of arrays in memory as a table in memory, against the same by way of Parquet files and
the program, in turns; and how long one call on one trace takes.

    cargo build --release
    python python/benches/speed.py target/release/tautline

It needs pyarrow. Times are medians; processor time counts all threads, and that of the program.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import pyarrow
import pyarrow.parquet
import tautrope


def measured(work: Callable[[], Any]) -> tuple[Any, float, float]:
    """What comes of it, and how many seconds it took: by the clock, and of the processor."""

    def processor() -> float:
        used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
        return sum(one.ru_utime for one in used)

    start, used = time.perf_counter(), processor()
    done = work()
    return done, time.perf_counter() - start, processor() - used


def by_files(program: str, scene: Path, walks: np.ndarray[Any, Any], folder: Path) -> Any:
    """The way through Parquet and the program."""
    count, points, _ = walks.shape
    columns = {"trace": np.repeat(np.arange(count), points), "x": walks[:, :, 0].ravel(), "y": walks[:, :, 1].ravel()}
    pyarrow.parquet.write_table(pyarrow.table(columns), folder / "walks.parquet")
    files: list[str | Path] = ["--traces", folder / "walks.parquet", "--out", folder / "ropes.parquet"]
    subprocess.run([program, "eval", "--engine", "cpu", "--scene", scene, *files], check=True, capture_output=True)
    return pyarrow.parquet.read_table(folder / "ropes.parquet")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program tautline")
    parser.add_argument("--traces", type=int, default=4000)
    parser.add_argument("--steps", type=int, default=500)
    parser.add_argument("--rounds", type=int, default=9)
    given = parser.parse_args()

    scene = tautrope.Scene.built_in("rooms")
    walks = scene.walks(given.traces, steps=given.steps)
    _, first, _ = measured(lambda: scene.evaluate(walks[:1], engine="cpu"))
    taken: dict[str, list[tuple[float, float]]] = {"in memory": [], "without events": [], "by files": []}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scene.write(folder / "rooms.geojson")
        ways: dict[str, Callable[[], Any]] = {
            "in memory": lambda: scene.evaluate(walks, engine="cpu").to_arrow(),
            "without events": lambda: scene.evaluate(walks, engine="cpu", events=False).to_arrow(),
            "by files": lambda: by_files(given.program, folder / "rooms.geojson", walks, folder),
        }
        for _ in range(given.rounds):
            tables = []
            for way, work in ways.items():
                table, clock, processor = measured(work)
                taken[way].append((clock, processor))
                tables.append(table)
            assert all(table.equals(tables[0]) for table in tables), "the ways do not agree"
    print(f"{given.traces} traces of {given.steps} steps in rooms, {given.rounds} rounds")
    for way, times in taken.items():
        against = [[theirs / own for theirs, own in zip(a, b)] for a, b in zip(taken["by files"], times)]
        clock, processor = (median(column) for column in zip(*times))
        ratios = [median(column) for column in zip(*against)]
        print(f"  {way:14}  {clock:7.3f} s by the clock, {processor:7.3f} s of the processor;", end=" ")
        print("by files takes {:.2f} and {:.2f} times as long".format(*ratios))

    one = [walks[i : i + 1] for i in range(min(1000, given.traces))]
    calls = [measured(lambda: scene.evaluate(walk, engine="cpu"))[1] for walk in one]
    print(f"one trace: {1e3 * median(calls):.3f} ms, the first {1e3 * first:.1f} ms")


if __name__ == "__main__":
    main()
