"""The file results.json of a study: each result is written as soon as it is there."""

from __future__ import annotations

import itertools
import json
import os
import platform
import subprocess
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
from pe_core import InputError
from pe_core.base import dump_json, parse_json, read_bytes, write_bytes

RESULTS = "results.json"
SCHEMA = 1


class ResultsFile:
    """Results by task name, kept in a file.

    Results of another commit, effort or NumPy are not gone on with: they are moved to a file of
    their own.

    Parameters
    ----------
    folder : Path
        Folder of results.json.
    effort : dataclass
        How much is computed.

    Attributes
    ----------
    entries : dict
        Value and duration ("seconds") by task name.
    loaded : int
        Number of results that the file had already.

    Raises
    ------
    InputError
        When the file is no JSON.
    """

    def __init__(self, folder: Path, effort: Any) -> None:
        self.path = folder / RESULTS
        self.made = made_by(effort)
        self.entries: dict[str, dict[str, Any]] = {}
        data = read_json(self.path) if self.path.exists() else {}
        if data.get("made") == self.made:
            self.entries = data["results"]
        elif data:
            self.path.rename(_unused_name(folder))
        self.loaded = len(self.entries)

    @property
    def values(self) -> dict[str, Any]:
        """The computed values, by task name."""
        return {name: entry["value"] for name, entry in self.entries.items()}

    def add(self, name: str, value: dict[str, Any], seconds: float) -> None:
        """Add a result, and write the file."""
        self.entries[name] = {"value": value, "seconds": round(seconds, 3)}
        self.save()

    def save(self, **conclusions: Any) -> dict[str, Any]:
        """Write the file, with conclusions from the results as a whole; return its data."""
        ordered = dict(sorted(self.entries.items()))
        data = {"schema": SCHEMA, "made": self.made, **conclusions, "results": ordered}
        write_bytes(self.path, dump_json(data).encode())
        return data


def made_by(effort: Any) -> dict[str, Any]:
    """Return what makes the results: commit, versions, machine, effort."""
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


def read_json(path: Path) -> dict[str, Any]:
    """Read a file that holds a JSON object.

    Raises
    ------
    InputError
        When the file cannot be read, or holds something else.
    """
    data = parse_json(path, read_bytes(path))
    if not isinstance(data, dict):
        raise InputError(path, "file", "a JSON object", type(data).__name__)
    return data


def read_complete(path: Path, *conclusions: str) -> dict[str, Any]:
    """Read a results.json that has all its conclusions; `InputError` for any other file."""
    data = read_json(path)
    if data.get("schema") != SCHEMA or not all(key in data for key in conclusions):
        raise InputError(path, "schema", f"complete results of schema {SCHEMA}", "other data")
    return data


def values_of(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of complete results, by task name."""
    return {name: entry["value"] for name, entry in data["results"].items()}


def _unused_name(folder: Path) -> Path:
    """Return a name for the results of another run: results-2.json, or the next that is free."""
    names = (folder / f"results-{k}.json" for k in itertools.count(2))
    return next(name for name in names if not name.exists())


def _commit() -> str:
    """Return the commit of the checkout, marked when the code has changes that are not in it."""
    root = Path(__file__).resolve().parents[1]
    try:
        commit = _git(root, "rev-parse", "--short=12", "HEAD")
        changed = _git(
            root, "status", "--porcelain", "--", "pe_core", "pe_tools", "studies", "blend_assets"
        )
    except (OSError, subprocess.CalledProcessError):
        return "not a checkout"
    return f"{commit}, changed since" if changed else commit


def _git(root: Path, *arguments: str) -> str:
    command = ["git", "-C", str(root), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
        return next(x.split(":")[1].strip() for x in lines if x.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


class CompleteResults:
    """Complete results, and the verdicts that a page draws from them.

    Parameters
    ----------
    data : mapping
        The content of results.json.

    Attributes
    ----------
    seconds : dict
        Durations by task.
    verdicts : dict
        Every verdict that the page has drawn from the results, by name.
    """

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.made: Mapping[str, Any] = data["made"]
        self.seconds = {name: entry["seconds"] for name, entry in data["results"].items()}
        self.verdicts: dict[str, str] = {}

    def verdict(self, name: str, text: str) -> str:
        """Note a verdict by name, and return its text."""
        self.verdicts[name] = text
        return text
