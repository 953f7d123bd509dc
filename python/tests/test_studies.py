"""Studies: answers that are the program's, to the byte, as tables and arrays."""

from __future__ import annotations

import copy
import json
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tautrope
from conftest import Program, run_by
from tautrope import Answer, InputError, Scene, Study, StudyError

PLAN: dict[str, Any] = {
    "scene": {"built_in": "rooms"},
    "walk": {"kind": "persistent", "step": 0.25, "steps": 120, "turn": 0.4},
    "run": {"traces": 400, "block": 50, "seed": 7},
    "tallies": {"limits": [20.0], "map": 32},
    "outputs": {"traces": True},
}

TOML = """
[scene]
built_in = "rooms"
[walk]
kind = "persistent"
step = 0.25
steps = 120
turn = 0.4
[run]
traces = 400
block = 50
seed = 7
[tallies]
limits = [20.0]
map = 32
[outputs]
traces = true
"""


@pytest.fixture(scope="module")
def theirs(program: Program, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the study as the program runs it."""
    return run_by(program, TOML, tmp_path_factory.mktemp("study"))


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Answer:
    return Study(PLAN).run(tmp_path_factory.mktemp("own") / "out", progress=False, engine="cpu")


def test_the_folder_is_the_programs_to_the_byte(answer: Answer, theirs: Path, tmp_path: Path) -> None:
    import pyarrow.parquet

    (tmp_path / "plan.toml").write_text(TOML)
    from_file = Study(tmp_path / "plan.toml").run(tmp_path / "out", progress=False, engine="cpu")
    # What differs tells of time and machine.
    own = {"lock", "state.bin", "run.json", "report.html", "study.json"}
    for folder in (answer.folder, from_file.folder):
        assert {f.name for f in folder.iterdir()} == {f.name for f in theirs.iterdir()}
        for file in sorted(theirs.iterdir()):
            if file.name == "traces.parquet" and _commit(theirs) != _commit(folder):
                # The notes in it say which commit the program was built from.
                assert pyarrow.parquet.read_table(file).equals(pyarrow.parquet.read_table(folder / file.name))
            elif file.name not in own:
                assert file.read_bytes() == (folder / file.name).read_bytes(), file.name
    assert Answer(theirs).summary == answer.summary


def _commit(folder: Path) -> Any:
    return json.loads((folder / "run.json").read_text())["commit"]


def test_tables_say_what_the_summary_says(answer: Answer) -> None:
    summary = json.loads((answer.folder / "summary.json").read_text())
    for told in summary["scalars"]:
        row = answer.scalars.loc[told["name"]]
        assert (row["mean"], row["low"], row["max"]) == (told["mean"]["value"], told["mean"]["low"], told["max"])
        assert answer.mean(told["name"]) == (told["mean"]["value"], told["mean"]["low"], told["mean"]["high"])
        for quantile in told["quantiles"]:
            value = quantile["value"]
            assert answer.quantiles.loc[(told["name"], quantile["share"]), "value"] == value["value"]
            found = answer.quantile(told["name"], quantile["share"])
            assert found == (value["value"], value["low"], value["high"])
    for told in summary["histograms"]:
        table = answer.histogram(told["name"])
        assert table["count"].sum() == 400 and [*table.index] == [bin["bin"] for bin in told["bins"]]
        assert np.allclose(table["to"] - table["from"], told["width"])
    assert answer.contacts.index.tolist() == [c["vertex"] for c in summary["contacts"]]
    assert answer.contacts["share"].tolist() == [c["share"]["value"] for c in summary["contacts"]]
    assert answer.survival.loc[20.0]["value"].iloc[0] == 1.0
    for wrong in (lambda: answer.mean("weight"), lambda: answer.quantile("length", 0.3), lambda: answer.histogram("x")):
        with pytest.raises(InputError, match="there (is|are)|no quantile"):
            wrong()


def test_bins_hold_the_traces_that_lie_in_them(answer: Answer) -> None:
    for name in ("length", "max_length"):
        for _, bin in answer.histogram(name).iterrows():
            lengths = answer.traces[name]
            assert ((lengths >= bin["from"]) & (lengths < bin["to"])).sum() == bin["count"]


def test_the_map_lies_over_the_scene(answer: Answer, rooms: Scene) -> None:
    map = answer.map
    assert set(map.sizes) == {"x", "y"} and (map["contacts"].max() > 0).item()
    # Contacts in a cell are those with the vertices there; one wound round counts more than once in the map only.
    low_x, low_y, *_ = rooms.bounds
    cell = (map["x"][1] - map["x"][0]).item()
    contacts = answer.contacts
    busiest = contacts["share"].idxmax()
    column, row = ((contacts.loc[busiest, at] - low) // cell for at, low in (("x", low_x), ("y", low_y)))
    here = ((contacts["x"] - low_x) // cell == column) & ((contacts["y"] - low_y) // cell == row)
    found = map["contacts"][int(row), int(column)].item()
    assert found == pytest.approx(contacts.loc[here, "share"].sum(), rel=0.02)
    assert map["visits"].sum().item() > 0


def test_the_map_without_xarray(answer: Answer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    plain = Answer(answer.folder).map
    assert isinstance(plain, dict) and np.array_equal(plain["length"], answer.map["length"], equal_nan=True)
    assert plain["x"].shape == (32,)


def test_traces_are_rows(answer: Answer, theirs: Path) -> None:
    import pyarrow.parquet

    assert answer.traces.to_arrow().equals(pyarrow.parquet.read_table(theirs / "traces.parquet"))
    assert len(answer.traces.to_pandas()) == 400
    assert answer.traces["max_length"].mean() == pytest.approx(answer.mean("max_length").value)


def test_the_report_is_shown(answer: Answer) -> None:
    import html

    shown = answer._repr_html_()
    assert shown.startswith("<iframe srcdoc=") and html.escape((answer.folder / "report.html").read_text()) in shown
    bare = Study({**PLAN, "outputs": {"pictures": False}}).run(progress=False)
    assert bare._repr_html_().startswith("<pre>&lt;Answer: 400 traces")
    for missing in ("report", "traces"):
        with pytest.raises(StudyError, match="the study wrote no"):
            getattr(bare, missing)


def test_answers_pickle(answer: Answer) -> None:
    again = pickle.loads(pickle.dumps(answer))
    again.folder = Path("/nowhere")
    assert again.summary == answer.summary and again.report == answer.report and repr(again) == repr(answer)
    assert again.traces.to_arrow().equals(answer.traces.to_arrow())
    assert copy.deepcopy(again).scalars.equals(answer.scalars)


def test_a_study_in_a_scene_of_ones_own(program: Program, tmp_path: Path) -> None:
    scene = Scene([[[-1, 0], [1, 0]], [[3, 3], [5, 1]]], anchor=(0, -1))
    study = Study(scene=scene, walk={"kind": "uniform", "step": np.float64(0.3), "steps": 40}, run={"traces": 200})
    answer = study.run(tmp_path / "own", progress=False)
    # Without the program that began it, the folder is enough.
    del study
    assert json.loads(program("study", "resume", tmp_path / "own", "--json"))["scalars"] == answer.summary["scalars"]
    scene.write(tmp_path / "scene.geojson")
    plan = {"scene": {"file": "scene.geojson"}, "walk": answer.summary["study"]["walk"], "run": {"traces": 200}}
    assert Study(plan, base=tmp_path).run(progress=False)._text == answer._text
    moved = (tmp_path / "own").rename(tmp_path / "moved")
    assert Study.resume(moved, progress=False).summary == answer.summary


def test_differences_of_anchors() -> None:
    def longest(seed: int, anchor: tuple[float, float]) -> Answer:
        plan = {**PLAN, "scene": {"built_in": "rooms", "anchor": anchor}, "run": {"traces": 400, "seed": seed}}
        return Study(plan).run(progress=False)

    a, b = longest(1, (24.3, 9.2)), longest(2, (24.3, 9.2))
    near = a.difference(b)
    assert near.value == a.mean("max_length").value - b.mean("max_length").value
    assert near.low is not None and near.high is not None and near.low < near.value < near.high
    half = [(high - low) / 2 for _, low, high in (a.mean("max_length"), b.mean("max_length")) if low and high]
    assert near.high - near.low == pytest.approx(2 * np.hypot(*half))
    back = b.difference(a)
    assert (back.value, back.low, back.high) == (-near.value, -near.high, -near.low)
    a_tail, b_tail = a.quantile("max_length", 0.9), b.quantile("max_length", 0.9)
    tail = a.difference(b, share=0.9)
    assert tail.low is not None and a_tail.low is not None and b_tail.high is not None
    assert tail.value == a_tail.value - b_tail.value
    assert tail.value - tail.low == pytest.approx(np.hypot(a_tail.value - a_tail.low, b_tail.high - b_tail.value))
    with pytest.raises(InputError, match="no quantile 0.3"):
        a.difference(b, share=0.3)
    with pytest.raises(InputError, match="both studies have the seed 1"):
        a.difference(longest(1, (5.0, 5.0)))


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"walk": {"kind": "persistant", "step": 1.0, "steps": 5}}, "persistant"),
        ({"run": {"trases": 4}}, "trases"),
        ({"run": {"traces": 0}}, "at least 1"),
        ({"walk": {"kind": "uniform", "step": 1.0}}, "walk: missing field `steps`"),
        ({"walk": {"kind": "uniform", "step": "far", "steps": 5}}, "^walk.step: must be a number, .* and is \"far\"$"),
        ({"run": {"precision": 3}}, "^run.precision: must be \"certified\" or \"fast\", and is 3$"),
        ({"scene": "attic"}, "attic"),
        ({"scene": {"file": "nowhere.svg"}}, "nowhere.svg"),
        ({"run": {"traces": object()}}, "object cannot stand in a plan"),
        ({"walk": {"kind": "uniform", "step": float("nan"), "steps": 5}}, "line|expected|number|step"),
    ],
)
def test_plans_that_will_not_do(sections: dict[str, Any], message: str) -> None:
    with pytest.raises(StudyError, match=message):
        Study({**PLAN, **sections})


def test_errors_of_files_say_where(tmp_path: Path) -> None:
    (tmp_path / "plan.toml").write_text(TOML.replace("block", "blok"))
    with pytest.raises(StudyError, match="did you mean `block`") as caught:
        Study(tmp_path / "plan.toml")
    assert caught.value.file == str(tmp_path / "plan.toml") and caught.value.line == 11
    with pytest.raises(InputError, match="not both"):
        Study(tmp_path / "plan.toml", run={"traces": 3})
    with pytest.raises(StudyError, match="study"):
        Study.resume(tmp_path)
    with pytest.raises(StudyError, match="study"):
        Answer(tmp_path)
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken/summary.json").write_text("mine")
    with pytest.raises(StudyError, match="there already"):
        Study(PLAN).run(tmp_path / "taken", progress=False)
    assert (tmp_path / "taken/summary.json").read_text() == "mine"
    with pytest.raises(InputError, match="does not count the same events"):
        Study(PLAN).run(tmp_path / "new", progress=False, engine="note")
    assert not (tmp_path / "new").exists()


def test_an_interrupted_study_goes_on(tmp_path: Path, answer: Answer) -> None:
    plan = {**PLAN, "run": {"traces": 40_000, "block": 50, "seed": 7}}
    told = []

    def stop(done: int, of: int) -> None:
        told.append((done, of))
        if len(told) == 3:
            raise KeyboardInterrupt

    for study, out in ((Study(plan), tmp_path / "out"), (Study(plan), None)):
        told.clear()
        with pytest.raises(KeyboardInterrupt):
            study.run(out, progress=stop)
        assert told[0][1] == 40_000 * 120 and len(told) == 3
        if out is not None:
            there = Answer(out)
            assert there.summary["stopped"] == "unfinished" and there.summary["traces"] < 40_000
    # A study of fewer traces is another one.
    with pytest.raises(StudyError, match="run.traces is 40000 there and 400 here"):
        Study(PLAN).run(tmp_path / "out", progress=False)
    small = {**PLAN, "run": {"traces": 4000, "block": 50, "seed": 7}}
    told.clear()
    study = Study(small)
    try:
        study.run(progress=stop)
    except KeyboardInterrupt:
        pass
    assert study.run(progress=False)._text == Study(small).run(progress=False)._text


def test_progress_is_said_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    said = tautrope._progress.Said(True)
    with said as say:
        assert say is not None
        said._last -= 1
        say(25, 100)
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.startswith("\rtautrope: 25 %, ") and shown.err.endswith("\r")
    with tautrope._progress.Said(False) as say:
        assert say is None


def test_the_example(program: Program, tmp_path: Path) -> None:
    assert Study(scene="rooms", walk=PLAN["walk"]).plan["scene"] == {"built_in": "rooms"}
    assert Study.example().plan["scene"] == {"built_in": "rooms"}
    assert "10000 traces, walk persistent" in repr(Study.example())
