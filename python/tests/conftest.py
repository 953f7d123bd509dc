"""What all tests share: the program that results are held to, and a scene with random walks."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tautrope

ROOT = Path(__file__).resolve().parents[2]

#: Runs the program with some arguments, and returns what it prints.
Program = Callable[..., str]


@pytest.fixture(scope="session")
def program() -> Program:
    """The program, as it was built beside the package."""
    binary = Path(os.environ.get("TAUTLINE_BINARY", ROOT / "target/debug/tautline"))
    assert binary.exists(), f"{binary} is not built; cargo build builds it, or name it in TAUTLINE_BINARY"

    def run(*arguments: object, fails: bool = False) -> str:
        ended = subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert (ended.returncode != 0) == fails, ended.stderr
        return ended.stderr if fails else ended.stdout

    return run


def run_by(program: Program, plan: str, folder: Path) -> Path:
    """Has the program run the study or sweep of a plan, and returns where it did."""
    (folder / "plan.toml").write_text(plan)
    program("study", "run", folder / "plan.toml", "--engine", "cpu", "--out", folder / "out")
    return folder / "out"


@pytest.fixture(scope="session")
def rooms() -> tautrope.Scene:
    return tautrope.Scene.built_in("rooms")


@pytest.fixture(scope="session")
def walks(rooms: tautrope.Scene) -> np.ndarray:
    return rooms.walks(300, steps=120)


@pytest.fixture(scope="session")
def columns(walks: np.ndarray) -> dict[str, np.ndarray]:
    """The walks as rows of a table."""
    count, points, _ = walks.shape
    trace = np.repeat(np.arange(count), points)
    return {"trace": trace, "x": walks[:, :, 0].ravel(), "y": walks[:, :, 1].ravel()}


@pytest.fixture(scope="session")
def rooms_file(rooms: tautrope.Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("scene") / "rooms.geojson"
    rooms.write(file)
    return file


@pytest.fixture(scope="session")
def files(
    rooms_file: Path, program: Program, columns: dict[str, np.ndarray], tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """A folder with the walks in a file, and what the program makes of them."""
    import pandas

    folder = tmp_path_factory.mktemp("files")
    pandas.DataFrame(columns).to_parquet(folder / "walks.parquet")
    for kind in ("parquet", "csv", "jsonl"):
        outputs = "--out", folder / f"ropes.{kind}", "--events", folder / f"events.{kind}"
        program("eval", "--scene", rooms_file, "--traces", folder / "walks.parquet", "--engine", "cpu", *outputs)
    return folder
