"""Tasks in worker processes, and results.json, to which each result is written at once."""

from __future__ import annotations

import itertools
import json
import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from concurrent.futures import as_completed
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
from pe_core import InputError
from pe_core.base import dump_json, parse_json, read_bytes, write_bytes
from pe_core.search import Processes
from pe_tools.cli import noted_when_interrupted, show

Json = dict[str, Any]
Values = Mapping[str, Any]
"""Values that were computed, by the name of their task."""

RESULTS = "results.json"
SCHEMA = 1


@dataclass(frozen=True)
class Task:
    """A function that worker processes can import, its arguments, and the name of its result."""

    name: str
    function: Callable[..., Json]
    arguments: Json = field(default_factory=dict)


class ResultsFile:
    """Results by task name, kept in results.json of a folder.

    Results of another commit, effort or NumPy are not gone on with: they are moved to a file of
    their own. `entries` has value and duration by task name, `loaded` is how many the file had.
    """

    def __init__(self, folder: Path, effort: Any) -> None:
        self.path = folder / RESULTS
        self.made = made_by(effort)
        self.entries: dict[str, Json] = {}
        data = read_json(self.path) if self.path.exists() else {}
        if data.get("made") == self.made:
            self.entries = data["results"]
        elif data:
            names = (folder / f"results-{k}.json" for k in itertools.count(2))
            self.path.rename(next(name for name in names if not name.exists()))
        self.loaded = len(self.entries)

    @property
    def values(self) -> Json:
        """The computed values, by task name."""
        return {name: entry["value"] for name, entry in self.entries.items()}

    def add(self, name: str, value: Json, seconds: float) -> None:
        """Add a result, and write the file."""
        self.entries[name] = {"value": value, "seconds": round(seconds, 3)}
        self.save()

    def save(self, **conclusions: Any) -> Json:
        """Write the file, with conclusions from the results as a whole; return its data."""
        ordered = dict(sorted(self.entries.items()))
        data = {"schema": SCHEMA, "made": self.made, **conclusions, "results": ordered}
        write_bytes(self.path, dump_json(data).encode())
        return data


def compute(
    folder: Path, effort: Any, ready: Callable[[Values], list[Task]], workers: int | None
) -> ResultsFile:
    """Compute all results that a folder does not have yet, in worker processes.

    `ready` takes the values and returns the tasks that can run now and have none. There are as many
    processes as processors, or fewer.
    """
    results = ResultsFile(folder, effort)
    if results.loaded:
        print_progress(f"going on from {results.path}, which has {results.loaded} results")
    note = f"{results.path} keeps the finished tasks; the same command goes on from them"
    processors = os.cpu_count() or 1
    with noted_when_interrupted(note), Processes(min(workers or processors, processors)) as pool:
        try:
            while tasks := ready(results.values):
                total = results.loaded + len(tasks)
                futures = {pool.submit(_timed, task): task.name for task in tasks}
                for future in as_completed(futures):
                    name = futures[future]
                    value, seconds = future.result()
                    results.add(name, value, seconds)
                    print_progress(f"[{len(results.entries)}/{total}] {name}  {seconds:.1f} s")
        except BaseException:  # Ctrl-C and SIGTERM end the workers in the middle of a task
            pool.shutdown(cancel_futures=True)
            raise
    return results


def _timed(task: Task) -> tuple[Json, float]:
    started = time.perf_counter()
    value = task.function(**task.arguments)
    return value, time.perf_counter() - started


def print_progress(line: str) -> None:
    """Write a line to stderr; a closed stderr does not end the work."""
    show(f"{line}\n", sys.stderr)


def made_by(effort: Any) -> Json:
    """Return what makes the results: commit, versions, machine, effort (a dataclass)."""
    made = {
        "commit": _commit(),
        "version": pe.__version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
        "machine": f"{_processor()}, {os.cpu_count()} processors",
        "effort": asdict(effort),
    }
    return plain(made)


def plain(data: Any) -> Any:
    """Return data as they are when they have been written to JSON and read again."""
    return json.loads(dump_json(data))


def read_json(path: Path) -> Json:
    """Read a file that holds a JSON object; `InputError` where it cannot be read, or does not."""
    data = parse_json(path, read_bytes(path))
    if not isinstance(data, dict):
        raise InputError(path, "file", "a JSON object", type(data).__name__)
    return data


def read_complete(path: Path, conclusions: Callable[[Json, Json], Json], *keys: str) -> Json:
    """Read a results.json whose conclusions, at some keys, follow from its values.

    `conclusions` takes the values and the effort. Any other file is an `InputError`.
    """
    data = read_json(path)
    if data.get("schema") != SCHEMA or not all(key in data for key in keys):
        raise InputError(path, "schema", f"complete results of schema {SCHEMA}", "other data")
    for key, value in conclusions(values_of(data), data["made"]["effort"]).items():
        if data[key] != plain(value):
            raise InputError(path, key, "those that follow from the results", "others")
    return data


def values_of(data: Mapping[str, Any]) -> Json:
    """Return the values of complete results, by task name."""
    return {name: entry["value"] for name, entry in data["results"].items()}


def _commit() -> str:
    """Return the commit of the checkout, marked when the code has changes that are not in it."""
    root = Path(__file__).resolve().parents[1]
    code = ("pe_core", "pe_tools", "studies", "blend_assets")
    git = ["git", "-C", str(root)]
    try:
        commit, changed = (
            subprocess.run([*git, *arguments], capture_output=True, text=True, check=True).stdout
            for arguments in (
                ("rev-parse", "--short=12", "HEAD"),
                ("status", "--porcelain", "--", *code),
            )
        )
    except (OSError, subprocess.CalledProcessError):
        return "not a checkout"
    return f"{commit.strip()}, changed since" if changed.strip() else commit.strip()


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
        return next(x.split(":")[1].strip() for x in lines if x.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
