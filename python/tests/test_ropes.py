"""Ropes: the same as the program's, whatever they come from and go to."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tautrope
from conftest import Program
from tautrope import InputError, Ropes, Scene, ViolationError


def same(a: Ropes, b: Ropes) -> bool:
    """Whether all columns agree to the bit."""

    def equal(x: Any, y: Any) -> bool:
        if isinstance(x, np.ndarray) and x.dtype == object:
            return len(x) == len(y) and all(equal(p, q) for p, q in zip(x, y, strict=True))
        return np.array_equal(x, y, equal_nan=np.asarray(x).dtype.kind == "f")

    tables = [(a.results, b.results), (a.events, b.events)]
    return all(s.columns == t.columns and all(equal(s[name], t[name]) for name in s.columns) for s, t in tables)


@pytest.fixture(scope="module")
def ropes(rooms: Scene, walks: np.ndarray) -> Ropes:
    return rooms.evaluate(walks, engine="cpu")


@pytest.mark.parametrize("kind", ["parquet", "csv", "jsonl"])
def test_files_are_the_programs_to_the_byte(ropes: Ropes, files: Path, tmp_path: Path, kind: str) -> None:
    ropes.write(tmp_path / f"ropes.{kind}", events=tmp_path / f"events.{kind}")
    for name in (f"ropes.{kind}", f"events.{kind}"):
        assert (tmp_path / name).read_bytes() == (files / name).read_bytes()


def test_tables_in_memory_are_those_in_files(ropes: Ropes, files: Path) -> None:
    import polars
    import pyarrow.parquet

    for table, name in ((ropes.results, "ropes"), (ropes.events, "events")):
        assert table.to_arrow().equals(pyarrow.parquet.read_table(files / f"{name}.parquet"))
        assert table.to_polars().equals(polars.read_parquet(files / f"{name}.parquet"))


def test_frames_of_pandas_have_the_same_numbers(ropes: Ropes, files: Path) -> None:
    import pandas

    read = pandas.read_csv(files / "ropes.csv")
    frame = ropes.to_pandas()
    assert [*frame.columns] == [*read.columns]
    for name in frame.columns.drop(["wraps", "sides"]):
        assert (frame[name] == read[name]).all(), name
    wraps = read["wraps"].fillna("").map(lambda text: [[*map(float, p.split())] for p in text.split(";") if p])
    assert [w.tolist() for w in frame["wraps"]] == [*wraps]
    assert [";".join(sides) for sides in frame["sides"]] == [*read["sides"].fillna("")]
    assert (ropes.events.to_pandas() == pandas.read_csv(files / "events.csv")).all(axis=None)


def test_traces_may_come_as_arrays(rooms: Scene, walks: np.ndarray, columns: dict[str, Any], ropes: Ropes) -> None:
    import shapely

    count, points, _ = walks.shape
    offsets = np.arange(count + 1) * points
    forms = [list(walks), (offsets, walks.reshape(-1, 2)), columns, walks[::-1][::-1], np.asfortranarray(walks)]
    forms += [{**columns, "step": np.tile(np.arange(points), count)}, [shapely.LineString(walk) for walk in walks]]
    assert all(same(ropes, rooms.evaluate(form, engine="cpu")) for form in forms)
    # Narrow numbers are widened as they are; a view of others, too.
    narrow = rooms.evaluate(walks[:50, :5].astype(np.float32).astype(np.float64))
    assert same(narrow, rooms.evaluate(walks[:50, :5].astype(np.float32)))
    ragged = rooms.evaluate([walks[0], walks[1, :7], walks[2, :1]])
    assert ragged["steps"].tolist() == [points - 1, 6, 0] and [len(one) for one in ragged.lengths] == [points, 7, 1]
    assert len(rooms.evaluate(np.zeros((0, 5, 2)))) == 0 == len(rooms.evaluate([])) == len(rooms.evaluate([]).events)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (np.zeros((4, 2)), "is one trace; give it as"),
        (np.zeros((4, 3, 3)), r"shape \(4, 3, 3\)"),
        ([np.zeros((4, 3))], "trace 0"),
        ([[(0.0, 1.0), (np.nan, 1.0)]], "trace 0, point 1: NaN"),
        (([0, 2], np.zeros((3, 2))), "the last 3"),
        (([0, 2, 2, 3], np.zeros((3, 2))), "trace 1 has no points"),
        ({"trace": [0], "x": [1.0]}, "no column y"),
        ({"trace": [0.5], "x": [1.0], "y": [1.0]}, "whole numbers"),
        ({"trace": [-1], "x": [1.0], "y": [1.0]}, "-1 is not a whole number"),
        ({"trace": [1, 0], "x": [1.0, 1], "y": [1.0, 1]}, "trace 0 after trace 1"),
        ({"trace": [0, 0], "x": [1.0, 1], "y": [1.0, 1], "step": [1, 0]}, "step 0 after step 1"),
        ({"trace": [0, 1], "x": [1.0], "y": [1.0]}, "not equally long"),
        ({"trace": [0], "x": [2**53 + 1], "y": [1]}, "more digits"),
        (3, "int is given"),
        ("walks.csv", "trace 0"),
    ],
)
def test_what_cannot_be_used_is_refused(rooms: Scene, given: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        rooms.evaluate(given)


def test_engines_agree(rooms: Scene, walks: np.ndarray, ropes: Ropes) -> None:
    for engine in ("reference", "auto", None):
        assert same(ropes, rooms.evaluate(walks, engine=engine))
    assert ropes.engine.startswith("cpu (certified) on ")
    with pytest.raises(InputError, match="give one of gpu, cpu, .*reference"):
        rooms.evaluate(walks, engine="quantum")
    with pytest.raises(tautrope.EngineError, match="cpu has no precision fast"):
        rooms.evaluate(walks, engine="cpu", precision="fast")


def test_a_trace_through_a_wall_is_refused_or_flagged(
    rooms: Scene, rooms_file: Path, program: Program, tmp_path: Path
) -> None:
    x, y = rooms.anchor or (0, 0)
    traces = [[(x, y), (x + 0.1, y)], [(x, y), (x, y), (1000, 1000)]]
    with pytest.raises(ViolationError, match="flag") as caught:
        rooms.evaluate(traces)
    assert (caught.value.trace, caught.value.step) == (1, 2) and caught.value.wall is not None
    flagged = rooms.evaluate(traces, on_violation="flag")
    assert flagged["status"].tolist() == ["ok", "violation"]
    rows = "".join(f"{i},{px},{py}\n" for i, trace in enumerate(traces) for px, py in trace)
    (tmp_path / "t.csv").write_text("trace,x,y\n" + rows)
    asked = "eval", "--scene", rooms_file, "--traces", tmp_path / "t.csv"
    program(*asked, "--on-violation", "flag", "--out", tmp_path / "a.jsonl")
    flagged.write(tmp_path / "b.jsonl")
    assert (tmp_path / "a.jsonl").read_bytes() == (tmp_path / "b.jsonl").read_bytes()
    assert program(*asked, fails=True).split("trace 1, ")[1].startswith("step 2: ")


def test_ropes_step_by_step(ropes: Ropes, walks: np.ndarray) -> None:
    """Lengths after each step have the greatest and the last length of the results, and are those of ropes shown."""
    assert ropes.lengths.shape == walks.shape[:2] and np.array_equal(ropes.points, walks)
    assert np.array_equal(ropes.lengths[:, -1], ropes["length"])
    assert np.array_equal(ropes.lengths.max(axis=1), ropes["max_length"])
    for trace, step in ((0, 0), (7, 60), (299, 120)):
        rope = ropes.rope(trace, step)
        legs = np.linalg.norm(np.diff(rope, axis=0), axis=1).sum()
        assert abs(legs - ropes.lengths[trace, step]) < 1e-12 and np.array_equal(rope[-1], walks[trace, step])
        # A rope after the last of so many steps is the rope at that step.
        short = ropes.scene.evaluate([walks[trace, : step + 1]], engine="cpu")
        assert np.array_equal(short.rope(0), rope) and short["length"][0] == ropes.lengths[trace, step]
    assert np.array_equal(ropes.rope(5), ropes.rope(5, 120))
    with pytest.raises(InputError, match="no step 121"):
        ropes.rope(5, 121)
    for none in (300, -1):
        with pytest.raises(InputError, match="no trace"):
            ropes.rope(none)


def test_lines_of_shapely(ropes: Ropes) -> None:
    lines = ropes.lines()
    assert len(lines) == len(ropes)
    assert np.allclose([line.length for line in lines], ropes["length"], rtol=1e-12)
    offsets, wraps = ropes.results.ragged("wraps")
    for i in (0, 5, 299):
        assert np.array_equal(np.array(lines[i].coords)[1:-1], wraps[offsets[i] : offsets[i + 1]])
    frame = ropes.to_geopandas()
    assert (frame.geometry == lines).all() and "max_length" in frame.columns


def test_pictures_are_the_programs(
    ropes: Ropes, program: Program, rooms_file: Path, files: Path, tmp_path: Path
) -> None:
    import matplotlib

    matplotlib.use("Agg")
    one = "draw", "--scene", rooms_file, "--traces", files / "walks.parquet", "--trace", 7
    program(*one, "--out", tmp_path / "7.svg")
    assert ropes.svg(7) == (tmp_path / "7.svg").read_text() == ropes.svg(7)._repr_svg_()
    program(*one, "--step", 60, "--out", tmp_path / "60.svg")
    assert ropes.svg(7, step=60) == (tmp_path / "60.svg").read_text()
    assert "prefers-color-scheme" not in ropes.svg(1, 2, dark=True)
    ax = ropes.plot(7, 8)
    assert len(ax.lines) == 5 and np.array_equal(ax.lines[2].get_xydata(), ropes.rope(7))


def test_results_pickle(ropes: Ropes, rooms: Scene, walks: np.ndarray, tmp_path: Path) -> None:
    again = pickle.loads(pickle.dumps(ropes))
    assert same(again, ropes) and again.engine == ropes.engine and again.scene == rooms
    assert np.array_equal(again.lengths, ropes.lengths) and np.array_equal(again.points, walks)
    again.write(tmp_path / "a.parquet", tmp_path / "a.csv")
    ropes.write(tmp_path / "b.parquet", tmp_path / "b.csv")
    assert all((tmp_path / f"a.{k}").read_bytes() == (tmp_path / f"b.{k}").read_bytes() for k in ("parquet", "csv"))
    table = pickle.loads(pickle.dumps(ropes.results))
    assert table.to_arrow().equals(ropes.to_arrow())
    with pytest.raises(InputError, match="pickled"):
        tautrope._ropes._restored(rooms, b"\xff\xff")


def test_results_alone(rooms: Scene, walks: np.ndarray, ropes: Ropes) -> None:
    alone = rooms.evaluate(walks, engine="cpu", events=False)
    for one in (alone, pickle.loads(pickle.dumps(alone))):
        assert one.to_arrow().equals(ropes.to_arrow()) and (one.lines() == ropes.lines()).all()
        for ask in (lambda: one.events, lambda: one.lengths, lambda: one.write("x.csv"), lambda: one.rope(0, 1)):
            with pytest.raises(InputError, match="events=True"):
                ask()


def test_labels_come_through() -> None:
    import shapely

    shapes = [shapely.box(-1, 0, 1, 1), shapely.box(3, 0, 4, 1)]
    scene = Scene.from_shapely(shapes, (0, -1), labels=["desk", None])
    ropes = scene.evaluate([[(0, -1), (2, -1), (2, 2), (0, 2)], [(0, -1), (5, -1), (5, 3), (2, 3)]])
    assert [[*names] for names in ropes["labels"]][0] == ["desk", "desk"]
    assert ropes.events["label"].tolist()[0] == "desk"
    assert ropes.to_arrow()["labels"].to_pylist()[0] == ["desk", "desk"]


def test_the_second_call_finds_what_the_first_made(rooms: Scene, walks: np.ndarray) -> None:
    """The engine lives in the scene: its lists are there still, and another anchor has others."""
    import tautrope._tautrope as core

    scene = Scene.built_in("rooms")
    first = scene.evaluate(walks[:20])
    assert same(first, scene.evaluate(walks[:20]))
    other = scene.tied(walks[3, 60])
    back = other.evaluate([walks[3, 60::-1]])
    assert back["length"][0] == pytest.approx(first.lengths[3, 60], rel=1e-12)
    assert {"gpu", "cpu", "gpu-windows", "gpu-rays", "reference", "funnel", "note"} == {name for name, _ in core.engines()}
