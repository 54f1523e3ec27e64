"""results.json: written after every task, so that an interrupted run goes on where it stopped."""

from __future__ import annotations

import itertools
import json
import os
import platform
import re
import subprocess
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
from pe_core.text import dump_json, write_bytes

from .read import SCHEMA, checked_results, read_json

RESULTS = "results.json"
LONGEST_COMMIT = 40
Checked = Callable[[Path, Any], dict[str, dict[str, Any]]]


class Ledger:
    """Results by task name, kept in a file.

    Parameters
    ----------
    folder : Path
        Where results.json is, or will be.
    effort : dataclass
        Results of another effort, commit or NumPy are not gone on with: they are kept under a name
        of their own.
    checked : callable, optional
        Takes the file and its results, and returns them when they are whole: those of ``pe
        reproduce`` by default.

    Attributes
    ----------
    found : int
        Results that were there.
    aside : Path or None
        Where the results of another run go once there is one of this run.

    Raises
    ------
    InputError
        When the file is no JSON, or one of this run that is damaged.
    """

    def __init__(self, folder: Path, effort: Any, checked: Checked = checked_results) -> None:
        self.path = folder / RESULTS
        self.made = made_by(effort)
        self.results: dict[str, dict[str, Any]] = {}
        self.aside: Path | None = None
        if self.path.exists():
            before = read_json(self.path)
            if before.get("schema") == SCHEMA and before.get("made") == self.made:
                self.results = checked(self.path, before.get("results"))
            else:
                self.aside = _free_name(folder, before.get("made"))
        self.found = len(self.results)

    @property
    def values(self) -> dict[str, Any]:
        """What was computed, by task name."""
        return {name: entry["value"] for name, entry in self.results.items()}

    def note(self, name: str, value: dict[str, Any], seconds: float) -> None:
        """Keep a result, and write the file."""
        self.results[name] = {"value": value, "seconds": round(seconds, 3)}
        self.save()

    def save(self, **more: Any) -> dict[str, Any]:
        """Write the file, with whatever is said of the results as a whole; return its data."""
        ordered = dict(sorted(self.results.items()))
        data = {"schema": SCHEMA, "made": self.made, **more, "results": ordered}
        if self.aside is not None:
            _rename(self.path, self.aside)
            self.aside = None
        write_bytes(self.path, dump_json(data).encode())
        return data


def made_by(effort: Any) -> dict[str, Any]:
    """Say what makes the results: commit, versions, machine, effort."""
    data: dict[str, Any] = json.loads(
        dump_json(
            {
                "commit": _commit(),
                "version": pe.__version__,
                "numpy": np.__version__,
                "python": platform.python_version(),
                "machine": f"{_processor()}, {os.cpu_count()} processors",
                "effort": asdict(effort),
            }
        )
    )
    return data


def _free_name(folder: Path, made: object) -> Path:
    """Return the name that results of another run are kept by: results-COMMIT.json."""
    commit = made.get("commit") if isinstance(made, dict) else None
    words = re.findall(r"[0-9A-Za-z]+", str(commit or "unknown")[:LONGEST_COMMIT])
    stem = "-".join(["results", *words])
    endings = itertools.chain([""], (f"-{k}" for k in itertools.count(2)))
    names = (folder / f"{stem}{ending}.json" for ending in endings)
    return next(name for name in names if not name.exists())


def _rename(path: Path, name: Path) -> None:
    try:
        path.rename(name)
    except OSError as error:
        raise pe.InputError(name, "file", "a place to write to", error.strerror) from None


def _commit() -> str:
    """Return the commit of the checkout, marked when its code was changed since."""
    root = Path(__file__).resolve().parent.parent
    try:
        commit = _git(root, "rev-parse", "--short=12", "HEAD")
        changed = _git(root, "status", "--porcelain", "--", "pe_core", "pe_report", "blend_assets")
    except (OSError, subprocess.CalledProcessError):
        return "not a checkout"
    return f"{commit}, changed since" if changed else commit


def _git(root: Path, *arguments: str) -> str:
    found = subprocess.run(
        ["git", "-C", str(root), *arguments], capture_output=True, text=True, check=True
    )
    return found.stdout.strip()


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
        return next(x.split(":")[1].strip() for x in lines if x.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
