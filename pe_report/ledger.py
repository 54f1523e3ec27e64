"""results.json: written after every task, so that an interrupted run goes on where it stopped."""

from __future__ import annotations

import json
import os
import platform
import subprocess
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
from pe_core.text import dump_json, read_bytes, write_bytes

from .effort import Effort

RESULTS = "results.json"
SCHEMA = 1


class Ledger:
    """Results by task name, kept in a file.

    Parameters
    ----------
    folder : Path
        Where results.json is, or will be.
    effort : Effort
        Results of another effort, commit or NumPy are not gone on with.
    """

    def __init__(self, folder: Path, effort: Effort) -> None:
        self.path = folder / RESULTS
        self.made = made_by(effort)
        self.results: dict[str, dict[str, Any]] = {}
        before = _read(self.path) if self.path.exists() else {}
        if before.get("schema") == SCHEMA and before.get("made") == self.made:
            self.results = before["results"]
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
        write_bytes(self.path, dump_json(data).encode())
        return data


def read_results(path: Path) -> dict[str, Any]:
    """Read a complete results.json.

    Raises
    ------
    InputError
        When it is not one, or of another version.
    """
    data = _read(path)
    if data.get("schema") != SCHEMA or "claims" not in data:
        raise pe.InputError(str(path), "schema", f"complete results of schema {SCHEMA}", "others")
    return data


def made_by(effort: Effort) -> dict[str, Any]:
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


def _read(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(read_bytes(path))
    except ValueError as error:
        raise pe.InputError(str(path), "file", "valid JSON", error) from None
    if not isinstance(data, dict):
        raise pe.InputError(str(path), "file", "a JSON object", type(data).__name__)
    return data


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
