"""Sweeps: answers that are the program's, to the byte, side by side."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tautrope
from conftest import Program, run_by
from tautrope import Answer, InputError, Scene, Study, StudyError, Sweep, SweepAnswer

PLAN: dict[str, Any] = {
    "scene": {"built_in": "rooms"},
    "walk": {"kind": "persistent", "step": 0.25, "steps": 60, "turn": 0.4},
    "run": {"traces": 300, "block": 50},
    "tallies": {"limits": [4.0, 6.5]},
    "outputs": {"pictures": False},
    "sweep": {"walk.step": [0.25, 0.5], "run.seed": [1, 2, 3], "against": 1},
}

TOML = """
[scene]
built_in = "rooms"
[walk]
kind = "persistent"
step = 0.25
steps = 60
turn = 0.4
[run]
traces = 300
block = 50
[tallies]
limits = [4.0, 6.5]
[outputs]
pictures = false
[sweep]
walk.step = [0.25, 0.5]
run.seed = [1, 2, 3]
against = 1
"""


@pytest.fixture(scope="module")
def theirs(program: Program, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the sweep as the program runs it."""
    return run_by(program, TOML, tmp_path_factory.mktemp("sweep"))


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> SweepAnswer:
    sweep = Study(PLAN)
    assert isinstance(sweep, Sweep) and sweep.keys == ["walk.step", "run.seed"] and len(sweep.plans) == 6
    return sweep.run(tmp_path_factory.mktemp("own") / "out", progress=False, engine="cpu")


def same_sweep(own: Path, theirs: Path) -> None:
    for name in ("sweep.csv", "sweep.parquet", "sweep.svg", *(f"point-{i:03}/summary.json" for i in range(6))):
        assert (own / name).read_bytes() == (theirs / name).read_bytes(), name


def test_the_folder_is_the_programs_to_the_byte(
    answer: SweepAnswer, theirs: Path, program: Program, tmp_path: Path
) -> None:
    same_sweep(answer.folder, theirs)
    (tmp_path / "plan.toml").write_text(TOML)
    from_file = Study(tmp_path / "plan.toml")
    assert isinstance(from_file, Sweep)
    out = from_file.run(tmp_path / "out", progress=False, engine="cpu")
    same_sweep(out.folder, theirs)
    assert out.summary == json.loads(program("study", "show", theirs, "--json")) == SweepAnswer(theirs).summary


def test_tables_say_what_the_points_say(answer: SweepAnswer) -> None:
    import pandas

    rows = pandas.read_csv(answer.folder / "sweep.csv")
    for name in rows.columns:
        told = answer.points[name].to_numpy()
        assert np.array_equal(rows[name].to_numpy(), told, equal_nan=rows[name].dtype == float), name
    values = [(step, seed) for step in (0.25, 0.5) for seed in (1, 2, 3)]
    assert [*answer.mean().index] == values and answer.against == 1 and len(answer) == 6
    for number, (point, at) in enumerate(zip(answer, values, strict=True)):
        own = point.summary["study"]
        assert (own["walk"]["step"], own["run"]["seed"]) == at
        assert answer[number] is point is answer[dict(zip(answer.keys, at, strict=True))]
        told = tuple(answer.mean("depth").loc[at, ["value", "low", "high"]])
        assert told == point.mean("depth")
        assert answer.scalars.loc[(*at, "length"), "max"] == point.scalars.loc["length", "max"]
        assert tuple(answer.quantile("max_length", 0.9).loc[at]) == point.quantile("max_length", 0.9)
        quantile = answer.quantiles.loc[(*at, "max_length", 0.9)]
        assert tuple(quantile) == point.quantile("max_length", 0.9)
        difference = answer.differences().loc[(*at, "max_length")]
        assert difference["value"] == pytest.approx(point.mean("max_length").value - answer[1].mean("max_length").value)
        assert difference["value"] == answer.points.loc[number, "max_length_mean_difference"]
        within = answer.differences().loc[(*at, "within_6.5"), "value"]
        assert within == answer.points.loc[number, "within_6.5_difference"]
    with pytest.raises(InputError, match="there is no weight"):
        answer.mean("weight")
    with pytest.raises(InputError, match="no quantile 0.3"):
        answer.quantile("length", 0.3)


def test_any_point_may_be_compared_with(answer: SweepAnswer, program: Program, tmp_path: Path) -> None:
    (tmp_path / "plan.toml").write_text(TOML.replace("against = 1", "against = 5"))
    program("study", "run", tmp_path / "plan.toml", "--engine", "cpu", "--out", tmp_path / "out")
    theirs = SweepAnswer(tmp_path / "out").differences()
    for against in (5, -1, {"walk.step": 0.5, "run.seed": 3}):
        assert answer.differences(against).equals(theirs)
    for wrong, message in (({"walk.turn": 1}, "walk.turn is not swept"), ({"run.seed": 1}, "2 points have")):
        with pytest.raises(InputError, match=message):
            answer.differences(wrong)
    with pytest.raises(IndexError, match="no point 6"):
        answer[6]


def test_sweeps_are_shown_and_pickle(answer: SweepAnswer) -> None:
    assert answer.svg() in answer._repr_html_() and answer.svg() == (answer.folder / "sweep.svg").read_text()
    again = pickle.loads(pickle.dumps(answer))
    again.folder = Path("/nowhere")
    assert again.points.equals(answer.points) and again.differences().equals(answer.differences())
    assert again[4].summary == answer[4].summary and again._repr_html_() == answer._repr_html_()
    sweep = pickle.loads(pickle.dumps(Study(PLAN)))
    assert sweep.plans == Study(PLAN).plans and sweep.identity == Study(PLAN).identity


def test_a_sweep_goes_on(answer: SweepAnswer, program: Program, tmp_path: Path) -> None:
    told = []

    def stop(done: int, of: int) -> None:
        told.append((done, of))
        if done > 0.4 * of:
            raise KeyboardInterrupt

    plan = {**PLAN, "run": {"traces": 20_000, "block": 50}}
    with pytest.raises(KeyboardInterrupt):
        Study(plan).run(tmp_path / "out", progress=stop)
    assert told[-1][1] == 6 * 20_000 * 60
    table = tautrope.status(tmp_path / "out", tmp_path / "nowhere")
    assert table["blocks"].tolist()[:6] == [400] * 6 and "unfinished" in table["stopped"].tolist()
    assert table.iloc[0]["stopped"] == "complete" and "nowhere" in table.iloc[6]["fault"]
    half = SweepAnswer(tmp_path / "out")
    assert 0 < len(half.mean()) < 6 and "done>" in repr(half)
    with pytest.raises(StudyError, match="20000 there and 300 here"):
        Study(PLAN).run(tmp_path / "out", progress=False)
    with pytest.raises(StudyError, match="holds a sweep"):
        Answer(tmp_path / "out")
    # The program and the package go on with what the other began.
    with pytest.raises(KeyboardInterrupt):
        Study(plan).run(tmp_path / "small", progress=lambda *_: stop(1, 1))
    program("study", "resume", tmp_path / "small", "--engine", "cpu")
    resumed = Study.resume(tmp_path / "small", progress=False)
    assert isinstance(resumed, SweepAnswer) and all(point.summary["traces"] == 20_000 for point in resumed)
    again = Sweep(PLAN).run(answer.folder, progress=False)
    assert again.summary == answer.summary


def test_a_sweep_in_a_scene_of_ones_own(tmp_path: Path) -> None:
    scene = Scene([[[-1, 0], [1, 0]], [[3, 3], [5, 1]]], anchor=(0, -1))
    walk = {"kind": "uniform", "step": 0.3, "steps": 40}
    sweep = Study(scene=scene, walk=walk, run={"traces": 200}, sweep={"scene": {"anchor": [[0.0, -1.0], [2.0, 1.0]]}})
    answer = sweep.run(tmp_path / "own", progress=False)
    del sweep
    moved = (tmp_path / "own").rename(tmp_path / "moved")
    resumed = Study.resume(moved, progress=False)
    assert isinstance(resumed, SweepAnswer) and resumed.summary == answer.summary
    one = Study(scene=scene.tied((2, 1)), walk=walk, run={"traces": 200}).run(progress=False)
    for named in ([2.0, 1.0], (2, 1), "[2, 1]", np.array([2, 1])):
        assert resumed[{"scene.anchor": named}].scalars.equals(one.scalars)
    assert resumed[1].replay(3)["max_length"][0] == one.replay(3)["max_length"][0]
    assert answer.mean().index.tolist() == ["[0, -1]", "[2, 1]"]
    assert pickle.loads(pickle.dumps(Study(scene=scene, walk=walk, sweep={"run.seed": [1, 2]}))).keys == ["run.seed"]


@pytest.mark.parametrize(
    ("swept", "message"),
    [
        ({}, "names no key"),
        ({"walk.stepp": [1, 2]}, "stepp"),
        ({"walk.step": 0.2}, "give a list of values"),
        ({"walk.step": []}, "the list is empty"),
        ({"walk.step": [0.2, -1]}, "value 2 of 2"),
        ({"walk.step": [0.2, 0.2]}, "one study"),
        ({"walk.step": [0.2, float("nan")]}, "not finite"),
        ({"run.seed": [1, None]}, "None"),
        ([1, 2], "give keys with a list"),
        ({"against": 7, "run.seed": [1, 2]}, "7 is the number of no point"),
        ({'a "b\n': [1]}, "unknown"),
    ],
)
def test_sweeps_that_will_not_do(swept: Any, message: str, tmp_path: Path) -> None:
    with pytest.raises((StudyError, InputError), match=message) as caught:
        Study({**PLAN, "sweep": swept})
    assert isinstance(caught.value, ValueError) and caught.value.line is None


def test_errors_of_files_say_where(tmp_path: Path) -> None:
    (tmp_path / "plan.toml").write_text(TOML.replace("[1, 2, 3]", "[1, -2]"))
    with pytest.raises(StudyError, match="value 2 of 2") as caught:
        Study(tmp_path / "plan.toml")
    assert caught.value.file == str(tmp_path / "plan.toml") and caught.value.line == 18
    (tmp_path / "one.toml").write_text(TOML[: TOML.index("[sweep]")])
    assert type(Study(tmp_path / "one.toml")) is Study
    with pytest.raises(StudyError, match="no section sweep"):
        Sweep(tmp_path / "one.toml")
    with pytest.raises(StudyError, match="sweep"):
        SweepAnswer(tmp_path)


def test_which_of_two_anchors() -> None:
    plan = {**PLAN, "scene": {"built_in": "rooms", "anchor": [(24.3, 9.2), (5.0, 5.0)]}, "run": {"traces": 800}}
    plan = {**plan, "tallies": {"anchors": True, "limits": [6.5]}}
    del plan["sweep"]
    answer = Study(plan).run(progress=False)
    anchors = answer.anchors
    for number, told in enumerate(answer.summary["anchors"]):
        row = anchors.loc[(number, "max_length")]
        assert [row["x"], row["y"]] == told["at"] == list(plan["scene"]["anchor"][number]) and row["traces"] == 400
        (scalar,) = (s for s in told["scalars"] if s["name"] == "max_length")
        assert row["value"] == scalar["mean"]["value"] and row["low"] == scalar["mean"]["low"]
        assert anchors.loc[(number, "within_6.5"), "value"] == told["within"][0]["share"]["value"]
        for quantile in scalar["quantiles"]:
            found = answer.anchor_quantiles.loc[(number, "max_length", quantile["share"])]
            assert found["value"] == quantile["value"]["value"]
    both = anchors.loc[([0, 1], "max_length"), "value"].to_numpy()
    second = anchors.loc[(1, "max_length")]
    assert second["difference"] == both[1] - both[0]
    assert second["difference_low"] < second["difference"] < second["difference_high"]
    assert np.isnan(anchors.loc[(0, "max_length"), "difference"])
    with pytest.raises(StudyError, match="anchors"):
        Study(scene="rooms", walk=PLAN["walk"], run={"traces": 50}).run(progress=False).anchors
