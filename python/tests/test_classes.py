"""The homotopy classes of ropes: the program's columns, to the byte, and what studies say of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Program
from tautrope import InputError, Scene, Study, StudyError


@pytest.fixture(scope="module")
def desks() -> Scene:
    import shapely

    boxes = [shapely.box(0, 0, 1, 1), shapely.box(3, -2, 4, 2)]
    return Scene.from_shapely(boxes, anchor=(-1, -1))


@pytest.mark.parametrize("kind", ["parquet", "csv", "jsonl"])
def test_columns_are_the_programs_to_the_byte(kind: str, desks: Scene, program: Program, tmp_path: Path) -> None:
    import pandas

    dragged = desks.walks(200, steps=150, step=0.5)
    count, points, _ = dragged.shape
    x, y = dragged.reshape(-1, 2).T
    columns = {"trace": np.repeat(np.arange(count), points), "x": x, "y": y}
    pandas.DataFrame(columns).to_parquet(tmp_path / "walks.parquet")
    desks.write(tmp_path / "desks.geojson")
    given = "--scene", tmp_path / "desks.geojson", "--traces", tmp_path / "walks.parquet"
    program("eval", *given, "--engine", "cpu", "--class", "--out", tmp_path / f"theirs.{kind}")
    ropes = desks.evaluate(dragged, engine="cpu")
    ropes.write(results=tmp_path / f"ours.{kind}", classes=True)
    assert (tmp_path / f"ours.{kind}").read_bytes() == (tmp_path / f"theirs.{kind}").read_bytes()
    if kind == "parquet":
        theirs = pandas.read_parquet(tmp_path / "theirs.parquet")
        assert ropes.classes["class"].tolist() == theirs["class"].tolist()
        same = theirs.loc[theirs["class"] == theirs["class"][7], "trace"]
        assert ropes.same_class(7) == same.tolist()


def test_a_rope_has_its_class_whatever_its_history(desks: Scene) -> None:
    there: list[Any] = [(-1, 2), (2, 2), (2, -1)]
    around: list[Any] = [(-1, 2), (2, 2), (2, 3), (5, 3), (5, -3), (5, 3), (2, 3), (2, -1)]
    other: list[Any] = [(2, -1)]
    classes = desks.evaluate([there, around, other]).classes
    assert classes["class"].tolist() == ["o0^-1", "o0^-1", "e"]
    assert [windings.tolist() for windings in classes["windings"]] == [[[0, -1]], [[0, -1]], []]
    assert classes.to_pandas()["class"].tolist() == ["o0^-1", "o0^-1", "e"]


def test_classes_change_up_to_those_at_the_end(desks: Scene) -> None:
    ropes = desks.evaluate(desks.walks(200, steps=150, step=0.5))
    changes = ropes.class_changes.to_pandas()
    assert (changes.groupby("trace")["step"].first() == 0).all() and len(changes) > 400
    assert changes.groupby("trace")["class"].last().tolist() == ropes.classes["class"].tolist()


def test_what_has_no_class(desks: Scene) -> None:
    crossing = desks.evaluate([[(2, 2)], [(2, -1)]], on_violation="flag")
    assert list(crossing.classes["class"]) == [None, "e"]
    assert [len(windings) for windings in crossing.classes["windings"]] == [0, 0]
    assert crossing.same_class(0) == []
    with pytest.raises(InputError, match="the engine funnel"):
        _ = desks.evaluate([[(2, -1)]], engine="funnel").classes


def test_studies_count_classes(tmp_path: Path) -> None:
    plan: dict[str, Any] = {"scene": "rooms", "walk": {"kind": "persistent", "step": 0.3, "steps": 40}}
    plan["run"] = {"traces": 200}
    counted = Study({**plan, "tallies": {"classes": 4}}).run(tmp_path / "a", progress=False)
    classes = counted.classes
    assert len(classes) == 4 and (classes["count"] / 200 == classes["share"]).all()
    assert classes.index.names == ["class", "x", "y"]
    with pytest.raises(StudyError, match="counts no classes"):
        _ = Study(plan).run(tmp_path / "b", progress=False).classes
