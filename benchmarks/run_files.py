"""A file for each run of a search benchmark: what is there is not run again."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

Json = dict[str, Any]


def run_once(path: Path, run: Callable[[], Json], unit: str) -> None:
    """Run a search unless its file is there; the file comes last, and whole."""
    if path.exists():
        return
    found = run()
    scratch = path.with_suffix(".part")
    scratch.write_text(json.dumps(found), "utf-8")
    os.replace(scratch, path)
    result = f"{found['entropy']:.4f} on the grid after {found['seconds']:.1f} s{unit}"
    print(f"{path.stem}: {result}", flush=True)


def restore(
    folder: Path, summary: Path, path_of: Callable[[Json], Path], again: Sequence[str]
) -> None:
    """Write the runs of a summary that have no file; forget those of the methods in `again`."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.glob("*.json"):
        if json.loads(path.read_text("utf-8"))["method"] in again:
            path.unlink()
    for run in json.loads(summary.read_text("utf-8")) if summary.exists() else []:
        path = path_of(run)
        if run["method"] not in again and not path.exists():
            path.write_text(json.dumps(run), "utf-8")


def summarise(folder: Path, summary: Path) -> list[Json]:
    """Put all runs of a folder into one file, one a line; return them."""
    runs = [json.loads(each.read_text("utf-8")) for each in sorted(folder.glob("*.json"))]
    summary.write_text("[\n" + ",\n".join(json.dumps(run) for run in runs) + "\n]\n", "utf-8")
    return runs
