"""Scenes from files, arrays and other libraries' geometries."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
import tautrope
from conftest import ROOT, Program
from tautrope import InputError, ReadError, Scene

FORMATS = ROOT / "tests/scenes/formats"


@pytest.mark.parametrize("name", ["plan.svg", "plan.dxf", "plan.wkt", "map.yaml", "degrees.geojson", "lab.svg"])
def test_files_are_read_as_the_program_reads_them(name: str, program: Program) -> None:
    scene = Scene.read(FORMATS / name)
    told = json.loads(program("check", "--scene", FORMATS / name, "--json"))["scene"]
    assert len(scene.walls) == told["walls"] and len(scene.vertices) == told["vertices"]
    assert scene.anchor == (None if told["anchor"] is None else tuple(told["anchor"]))
    assert scene.y_down == (told["y"] == "down")
    assert scene.notes == told["notes"] + told["warnings"]
    assert scene.layers == {layer["name"]: layer["walls"] for layer in told["layers"]}
    if told["box"] is not None and scene.anchor is None:
        assert scene.bounds == (*told["box"][0], *told["box"][1])


def test_a_scene_written_is_the_scene_read(tmp_path: Path) -> None:
    scene = Scene.read(FORMATS / "lab.svg")
    scene.write(tmp_path / "lab.geojson")
    assert Scene.read(tmp_path / "lab.geojson") == scene
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert scene.tied((1, 2)) != scene


def test_layers_are_chosen() -> None:
    all_of = Scene.read(FORMATS / "lab.svg")
    name, walls = next((name, walls) for name, walls in all_of.layers.items() if 0 < walls < len(all_of.walls))
    assert len(Scene.read(FORMATS / "lab.svg", layers=name).walls) == walls
    assert len(Scene.read(FORMATS / "lab.svg", without_layers=[name]).walls) < len(all_of.walls)
    with pytest.raises(ReadError, match="layer"):
        Scene.read(FORMATS / "lab.svg", layers=["nowhere"])


def test_walls_are_an_array() -> None:
    walls = np.array([[[0, 0], [1, 0]], [[1, 0], [1, 2]]])
    for given in (walls, walls.reshape(2, 4), walls.tolist(), walls.astype(np.float32)):
        scene = Scene(given, anchor=(-1, -1))
        assert scene.vertices.tolist() == [[0, 0], [1, 0], [1, 2]] and scene.walls.tolist() == [[0, 1], [1, 2]]
        assert np.array_equal(scene.vertices[scene.walls], walls)
    assert scene.anchor == (-1, -1) and scene.bounds == (-1, -1, 1, 2)
    assert Scene([]).walls.shape == (0, 2) and Scene([]).anchor is None
    with pytest.raises(InputError, match=r"\(n, 2, 2\) or \(n, 4\)"):
        Scene([[1, 2, 3]])
    with pytest.raises(InputError, match="wall 1") as caught:
        Scene([[0, 0, 1, 1], [0, 0, np.nan, 1]])
    assert caught.value.wall == 1
    with pytest.raises(InputError, match="a point"):
        Scene(walls, anchor=(1, 2, 3))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="no anchor"):
        Scene(walls).evaluate([[(0, 0)]])


def test_errors_say_where(tmp_path: Path) -> None:
    file = tmp_path / "bad.wkt"
    file.write_text("LINESTRING(0 0, 1 1)\nLINESTRING(0 0, 1 x)\n")
    with pytest.raises(ReadError) as caught:
        Scene.read(file)
    assert (caught.value.file, caught.value.line, caught.value.trace) == (str(file), 2, None)
    assert isinstance(caught.value, (ValueError, tautrope.TautropeError))
    with pytest.raises(ReadError) as caught:
        Scene.read(tmp_path / "none.svg")
    assert caught.value.file == str(tmp_path / "none.svg")
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value) and again.file == caught.value.file


def test_geometries_of_shapely_mean_what_a_file_of_them_means(tmp_path: Path) -> None:
    import geopandas
    import shapely

    shapes = [
        shapely.box(0, 0, 4, 3),
        shapely.Polygon([(6, 0), (9, 0), (9, 3)], [[(8, 0.5), (8.5, 0.5), (8.5, 1)]]),
        shapely.LineString([(0, 5), (3, 5.1), (4, 6)]),
        shapely.MultiPolygon([shapely.box(10, 10, 11, 11), shapely.box(12, 10, 13, 11)]),
    ]
    frame = geopandas.GeoDataFrame({"label": ["a", None, "c", "d"], "layer": ["x", "x", "y", None]}, geometry=shapes)
    frame = frame.set_crs(3035)
    frame.to_file(tmp_path / "shapes.geojson", driver="GeoJSON")
    read = Scene.read(tmp_path / "shapes.geojson", anchor=(-1, -1))
    made = Scene.from_geopandas(frame, (-1, -1), label="label", layer="layer")
    assert made == read and made.layers == read.layers == {"x": 10, "y": 2}
    assert Scene.from_shapely(shapes, (-1, -1), labels=["a", None, "c", "d"]) == read
    assert len(Scene.from_shapely(shapes[0]).walls) == 4 and Scene.from_shapely(shapes[0]).anchor is None
    assert len(Scene.from_shapely(np.array(shapes, dtype=object), shapely.Point(-1, -1)).walls) == len(read.walls)
    # A solid is one: whoever starts on its border cannot go inside.
    on_border = Scene.from_shapely(shapes[0], (2, 0))
    assert [v.kind for v in on_border.check([[(2, 0), (2, 1)], [(2, 0), (2, -1)]])] == ["enters a solid"]
    with pytest.raises(InputError, match="geometry 1"):
        Scene.from_shapely([shapes[0], shapely.LineString([(0, 0), (1, float("inf"))])])
    with pytest.raises(InputError, match="labels: 1 for 4"):
        Scene.from_shapely(shapes, labels=["a"])




def test_traces_are_checked_as_the_program_does(
    program: Program, tmp_path: Path, rooms: Scene, rooms_file: Path
) -> None:
    x, y = rooms.anchor or (0, 0)
    (tmp_path / "t.csv").write_text(f"trace,x,y\n0,{x},{y}\n0,{x + 0.1},{y}\n3,{x},{y}\n3,1000,1000\n")
    asked = "check", "--scene", rooms_file, "--traces", tmp_path / "t.csv", "--on-violation", "flag", "--json"
    told = json.loads(program(*asked))
    (found,) = rooms.check({"trace": [0, 0, 3, 3], "x": [x, x + 0.1, x, 1000], "y": [y, y, y, 1000]})
    (expected,) = told["traces"]["violations"]
    assert (found.trace, found.step, found.wall, found.kind) == (3, 1, expected["wall"], expected["kind"])
    assert [list(found.start), list(found.end)] == [expected["from"], expected["to"]]


def test_pictures(program: Program, tmp_path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    scene = Scene.read(FORMATS / "plan.svg")
    program("draw", "--scene", FORMATS / "plan.svg", "--out", tmp_path / "plan.svg")
    assert scene._repr_svg_() == (tmp_path / "plan.svg").read_text()
    ax = scene.plot()
    assert ax.yaxis_inverted() == scene.y_down
    assert len(ax.collections[0].get_segments()) == len(scene.walls)
    assert scene.plot(ax) is ax
