"""What the papers show works, and the package needs numpy alone."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import tautrope
from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "examples/notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("paper", ["python/README.md", "docs/python.md"])
def test_blocks_of_papers_run(paper: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib

    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / paper).read_text(), flags=re.DOTALL)
    assert len(blocks) >= 2
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, paper, "exec"), names)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run(notebook: Path, tmp_path: Path) -> None:
    import nbformat
    from nbclient import NotebookClient

    book = nbformat.read(notebook, as_version=4)
    nbformat.validate(book)
    NotebookClient(book, timeout=120, resources={"metadata": {"path": tmp_path}}).execute()
    assert len(NOTEBOOKS) == 4


def test_nothing_but_numpy_is_needed() -> None:
    """Neither to import the package nor to evaluate ropes and run a study."""
    others = ["pandas", "polars", "pyarrow", "shapely", "geopandas", "xarray", "matplotlib"]
    program = f"""
import sys
for name in {others}:
    sys.modules[name] = None
import numpy, tautrope
scene = tautrope.Scene([[[-1, 0], [1, 0]]], anchor=(0, -1))
ropes = scene.evaluate([[(0, -1), (3, -1), (1, 1)]])
assert ropes["depth"].tolist() == [1] and len(ropes.lengths) == 1 and ropes.svg(0) and ropes.to_numpy()
walk = dict(kind="uniform", step=0.1, steps=9)
answer = tautrope.Study(scene=scene, walk=walk, run=dict(traces=30)).run(progress=False)
assert answer.mean("length").value > 0 and isinstance(answer.map, dict) and answer._repr_html_()
try:
    answer.scalars
except ImportError as error:
    print("pandas" in str(error))
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert ended.stdout == "True\n"


def test_nothing_is_said_on_stderr() -> None:
    """Not even by the drivers that are looked for, on a machine without a window system."""
    program = "import tautrope; s = tautrope.Scene.built_in('rooms'); print(len(s.evaluate(s.walks(3, steps=5))))"
    bare = {name: value for name, value in os.environ.items() if name not in ("NODEVICE_SELECT", "XDG_RUNTIME_DIR")}
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, env=bare)
    assert (ended.stdout, ended.stderr) == ("3\n", "")


def test_everything_public_is_explained() -> None:
    for name in tautrope.__all__:
        thing = getattr(tautrope, name)
        if not isinstance(thing, type):
            continue
        assert thing.__doc__, name
        for key, member in vars(thing).items():
            if not key.startswith("_") and (callable(member) or isinstance(member, (property, classmethod))):
                assert getattr(member, "__doc__", None), f"{name}.{key}"
