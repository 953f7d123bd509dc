"""Folders of studies and sweeps."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from . import _tautrope as _core

#: What a scene of one's own is called in a study's folder.
SCENE = "scene.geojson"

#: What a sweep's folder has, and no other.
SWEEP = "sweep.json"


def base_of(folder: Path, base: str | os.PathLike[str] | None) -> Path | None:
    """From where a study's files are named: one with a scene of its own has that in its folder, and a sweep in that
    of all."""
    if base is not None:
        return Path(base)
    if (folder / SCENE).exists():
        return folder
    return folder.parent if (folder.parent / SWEEP).exists() and (folder.parent / SCENE).exists() else None


def status(*folders: str | os.PathLike[str]) -> Any:
    """How far the studies and sweeps in folders are, also while others write there: a DataFrame of pandas by folder,
    with a row for each point of a sweep.

    Columns: ``part`` (which part of the study is there), ``done`` and ``blocks``, ``stopped`` (``unfinished``, or why
    there is nothing left to do), ``traces_per_second``, ``seconds_left``, ``holder`` (who writes there, ``host:
    process``), and ``fault`` (what is wrong with a folder that holds nothing of this).
    """
    import pandas

    found = json.loads(_core.status_of([Path(folder) for folder in folders]))
    rows: list[dict[str, Any]] = []
    for of in [*found.get("sweeps", []), *found["studies"]]:
        for one in of.get("studies", of.get("folders")):
            holder = one["holder"] and f"{one['holder']['host']}: {one['holder']['process']}"
            rows.append({**one, "part": one.pop("shard"), "holder": holder, "fault": None})
    rows += [{"folder": folder, "fault": fault} for folder, fault in found["others"]]
    columns = ["part", "done", "blocks", "stopped", "traces_per_second", "seconds_left", "holder", "fault"]
    return pandas.DataFrame(rows, columns=["folder", *columns]).set_index("folder")
