"""The rope after every step: the program's rows, to the byte, as tables, streams and files."""

from __future__ import annotations

import multiprocessing
import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tautrope
from conftest import Program
from tautrope import InputError, Scene, Study


@pytest.fixture(scope="module")
def desks() -> Scene:
    import shapely

    boxes = [shapely.box(0, 0, 1, 1), shapely.box(3, -2, 4, 2)]
    return Scene.from_shapely(boxes, anchor=(-1, -1), labels=["desk", "long desk"])


@pytest.fixture(scope="module")
def dragged(desks: Scene) -> np.ndarray[Any, Any]:
    return desks.walks(200, steps=150, step=0.5)


@pytest.fixture(scope="module")
def theirs(desks: Scene, dragged: np.ndarray[Any, Any], program: Program, tmp_path_factory: Any) -> Path:
    """A folder with the traces in a file, and what the program says of their steps."""
    import pandas

    folder = tmp_path_factory.mktemp("steps")
    count, points, _ = dragged.shape
    x, y = dragged.reshape(-1, 2).T
    columns = {"trace": np.repeat(np.arange(count), points), "x": x, "y": y}
    pandas.DataFrame(columns).to_parquet(folder / "walks.parquet")
    desks.write(folder / "desks.geojson")
    for kind in ("parquet", "csv", "jsonl"):
        for name, about in (("all", []), ("some", ["--about", "desk", "--about", "5"])):
            steps = "--steps", folder / f"{name}.{kind}", *about
            given = "--scene", folder / "desks.geojson", "--traces", folder / "walks.parquet"
            program("eval", *given, "--engine", "cpu", *steps)
    return folder


@pytest.mark.parametrize("kind", ["parquet", "csv", "jsonl"])
def test_files_are_the_programs_to_the_byte(
    kind: str, desks: Scene, dragged: np.ndarray[Any, Any], theirs: Path, tmp_path: Path
) -> None:
    desks.evaluate(dragged, engine="cpu").write(steps=tmp_path / f"all.{kind}")
    some = desks.evaluate(dragged, engine="cpu", steps=True, about=["desk", 5])
    some.write(steps=tmp_path / f"some.{kind}")
    for name in (f"all.{kind}", f"some.{kind}"):
        assert (tmp_path / name).read_bytes() == (theirs / name).read_bytes()


def test_tables_are_the_programs_to_the_bit(desks: Scene, dragged: np.ndarray[Any, Any], theirs: Path) -> None:
    import pyarrow
    import pyarrow.parquet

    all_of, some_of = (pyarrow.parquet.read_table(theirs / f"{name}.parquet") for name in ("all", "some"))
    ropes = desks.evaluate(dragged)
    assert ropes.steps.to_arrow().equals(all_of)
    assert ropes.steps.columns[-2:] == ["winding_desk", "winding_long desk"]
    for kept in (True, False):
        steps = desks.evaluate(dragged, events=kept, steps=True, about=["desk", 5]).steps
        assert steps.to_arrow().equals(some_of) and steps.columns[-1] == "winding_vertex 5"
    stream = ropes.stream_steps(about=["desk", 5])
    # Every reading is one of its own.
    for _ in range(2):
        assert pyarrow.RecordBatchReader.from_stream(stream).read_all().equals(some_of)
        assert pyarrow.concat_tables([pyarrow.table(part) for part in stream]).equals(some_of)
    frame = ropes.steps.to_pandas()
    assert np.isnan(frame.loc[frame["length"] == 0, "pull_x"]).all() and len(frame) == 200 * 151
    assert ropes.steps.to_polars().shape == (200 * 151, 11) and ropes.steps.to_numpy()["turns"].dtype == np.uint32


def test_steps_are_what_else_is_known_of_them(desks: Scene, dragged: np.ndarray[Any, Any]) -> None:
    ropes = desks.evaluate(dragged, steps=True)
    steps = {name: column.reshape(200, 151) for name, column in ropes.steps.to_numpy().items()}
    assert np.array_equal(steps["length"], ropes.lengths)
    assert np.array_equal(np.stack([steps["x"], steps["y"]], axis=2), dragged)
    assert np.array_equal(steps["length"].max(axis=1), ropes["max_length"])
    assert np.array_equal(steps["turns"].max(axis=1), ropes["max_depth"])
    # Winding by the sum of angles, about the desk's first corner: far from walls it is exact enough to be rounded.
    corner = desks.vertices[desks.labels.index("desk")]
    angle = np.unwrap(np.arctan2(dragged[..., 1] - corner[1], dragged[..., 0] - corner[0]), axis=1)
    rounds = np.trunc((angle - angle[:, :1]) / (2 * np.pi))
    assert np.array_equal(steps["winding_desk"], rounds) and np.abs(rounds).max() >= 1


def test_friction_is_the_programs_and_the_formulas(
    desks: Scene, dragged: np.ndarray[Any, Any], theirs: Path, program: Program, tmp_path: Path
) -> None:
    import pyarrow.parquet

    given = "--scene", theirs / "desks.geojson", "--traces", theirs / "walks.parquet"
    program("eval", *given, "--engine", "cpu", "--steps", tmp_path / "theirs.parquet", "--friction", 0.3)
    table = pyarrow.parquet.read_table(tmp_path / "theirs.parquet")
    ropes = desks.evaluate(dragged, engine="cpu", friction=0.3)
    assert ropes.steps.to_arrow().equals(table)
    assert ropes.steps.columns[9:14] == ["anchor_pull_x", "anchor_pull_y", "turned", "tension", "work"]
    ropes.write(steps=tmp_path / "ours.parquet")
    assert (tmp_path / "ours.parquet").read_bytes() == (tmp_path / "theirs.parquet").read_bytes()
    for kept in (True, False):
        some = desks.evaluate(dragged, events=kept, steps=True, friction=0.3)
        assert some.steps.to_arrow().equals(table)
        assert pickle.loads(pickle.dumps(some)).steps.to_arrow().equals(table)
    stream = desks.evaluate(dragged).stream_steps(friction=0.3)
    for made in (stream, pickle.loads(pickle.dumps(stream))):
        assert pyarrow.concat_tables([pyarrow.table(part) for part in made]).equals(table)
    # The formula, and the forces, which add up to the pulls of both ends.
    steps = {name: column.reshape(200, 151) for name, column in ropes.steps.to_numpy().items()}
    assert np.allclose(steps["tension"], np.exp(0.3 * steps["turned"]), rtol=1e-15)
    assert (steps["turned"] > np.pi).any() and ((steps["turned"] > 0) == (steps["turns"] > 0)).all()
    for trace in (0, 3, 199):
        for holds in (False, True):
            forces = ropes.forces(trace, friction=0.3, holds=holds)
            tension = steps["tension"][trace, -1] ** (-1 if holds else 1)
            assert len(forces["angle"]) == ropes["depth"][trace]
            assert np.isclose(forces["angle"].sum(), steps["turned"][trace, -1])
            for axis in "xy":
                pulls = steps[f"anchor_pull_{axis}"][trace, -1] + tension * steps[f"pull_{axis}"][trace, -1]
                assert np.isclose(forces[f"force_{axis}"].sum(), -pulls)
            assert np.allclose(forces["before"][1:], forces["beyond"][:-1], rtol=1e-13)
    assert ropes.forces(3, step=20)["x"].tolist() == ropes.rope(3, step=20)[1:-1, 0].tolist()
    for ask in (lambda: desks.evaluate(dragged, friction=-1), lambda: ropes.forces(0, friction=11)):
        with pytest.raises(InputError, match="friction: .* is no coefficient of friction; give a number from 0 to 10"):
            ask()


def test_many_steps_come_in_parts(rooms: Scene) -> None:
    ropes = rooms.evaluate(rooms.walks(1500, steps=400))
    parts = [len(part) for part in ropes.stream_steps()]
    assert sum(parts) == 1500 * 401 and len(parts) == 3 and max(parts) < 300_000
    assert all(count % 401 == 0 for count in parts)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes cannot be forked here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_forks_make_steps_too(rooms: Scene) -> None:
    traces = rooms.walks(40, steps=100)
    here = _all_ways(rooms, traces)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.starmap_async(_all_ways, [(rooms, traces)] * 3).get(60) == [here] * 3


def _all_ways(scene: Scene, traces: np.ndarray[Any, Any]) -> tuple[float, float, float]:
    import pyarrow

    ropes = scene.evaluate(traces)
    streamed = pyarrow.RecordBatchReader.from_stream(ropes.stream_steps()).read_all()
    in_parts = sum(part["length"].sum() for part in ropes.stream_steps())
    return float(ropes.steps["length"].sum()), float(in_parts), float(streamed["length"].to_numpy().sum())


def test_steps_pickle(desks: Scene, dragged: np.ndarray[Any, Any]) -> None:
    for kept in (True, False):
        ropes = desks.evaluate(dragged, events=kept, steps=True, about=["desk"])
        again = pickle.loads(pickle.dumps(ropes))
        assert again.steps.to_arrow().equals(ropes.steps.to_arrow()) and again.steps.columns[-1] == "winding_desk"
    assert pickle.loads(pickle.dumps(ropes.steps)).to_arrow().equals(ropes.steps.to_arrow())
    stream = pickle.loads(pickle.dumps(desks.evaluate(dragged).stream_steps(about=["desk"])))
    assert sum(len(part) for part in stream) == 200 * 151 and next(iter(stream)).columns[-1] == "winding_desk"


def test_what_was_not_kept_is_said(desks: Scene, dragged: np.ndarray[Any, Any]) -> None:
    bare = desks.evaluate(dragged, events=False)
    for ask in (lambda: bare.steps, bare.stream_steps, lambda: bare.write(steps="x.csv")):
        with pytest.raises(InputError, match="events=True"):
            ask()
    with pytest.raises(InputError, match="about: no obstacle is called \"chair\""):
        desks.evaluate(dragged, steps=True, about=["chair"])
    with pytest.raises(InputError, match="give a list of names"):
        desks.evaluate(dragged, steps=True, about="desk")


def test_violations_end_where_they_are(desks: Scene) -> None:
    traces = [[(-1, -1), (2, 2)], [(-1, -1), (-2, -2)]]
    ropes = desks.evaluate(traces, on_violation="flag", steps=True)
    assert ropes["status"].tolist() == ["violation", "ok"] and 1 in ropes.steps["trace"]


def test_a_studys_steps_and_replay(program: Program, tmp_path: Path) -> None:
    import pyarrow.parquet

    walk = {"kind": "persistent", "step": 0.25, "steps": 60, "turn": 0.4}
    outputs = {"steps": [3, 17], "points": 20, "pictures": False, "traces": True}
    study = Study(scene="rooms", walk=walk, run={"traces": 100}, outputs=outputs)
    answer = study.run(tmp_path / "out", progress=False)
    assert answer.steps.to_arrow().equals(pyarrow.parquet.read_table(tmp_path / "out/steps.parquet"))
    again = pickle.loads(pickle.dumps(answer))
    assert again.steps.to_arrow().equals(answer.steps.to_arrow()) and len(again.points) == 20 * 61
    replayed = answer.replay(17)
    program("study", "replay", tmp_path / "out", "--trace", 17, "--steps", tmp_path / "17.parquet")
    assert replayed.steps.to_arrow().equals(pyarrow.parquet.read_table(tmp_path / "17.parquet"))
    assert replayed["max_length"][0] == answer.traces["max_length"][17] and replayed.rope(17, step=30).shape[1] == 2
    assert np.array_equal(replayed.points[0][:, 0], answer.points["x"][17 * 61 : 18 * 61])
    with pytest.raises(InputError, match="there is no trace 100") as caught:
        answer.replay(100)
    assert caught.value.trace == 100
    # Traces as a study writes them can be evaluated.
    ropes = tautrope.Scene.built_in("rooms").evaluate(answer.points)
    assert np.array_equal(ropes["max_length"], answer.traces["max_length"][:20])
