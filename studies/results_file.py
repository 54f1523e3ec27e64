"""results.json: written after every task, so that an interrupted run can go on from it.

The file may be damaged or written by someone else, so all of it is checked before it is used, with
the engine's rules for values (`Table`, `Number`, `Name`): the first wrong value is named in an
`InputError`.
"""

from __future__ import annotations

import itertools
import json
import os
import platform
import re
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
from pe_core import InputError
from pe_core.base import Name, Number, Table, dump_json, parse_json, read_bytes, write_bytes

RESULTS = "results.json"
SCHEMA = 1
MAX_COMMIT = 40
"""Characters of a commit in the name of a file."""

MAX_NUMBER = 1e12
"""A larger number comes from a damaged file."""
NUMBER, NOT_NEGATIVE = Number(-MAX_NUMBER, MAX_NUMBER), Number(0.0, MAX_NUMBER)
ENTROPY, SHARE = Number(-1e3, 1e3), Number(0.0, 1.0)
LINE = Name("a printable line without | and `", 200)
"""A text that stands in a table of the page."""
MADE_KEYS = ("commit", "version", "numpy", "python", "machine")
"""What made the results, besides the effort."""

CheckValue = Callable[[str, Table], None]
"""Takes a task's name and its value, and raises `InputError` unless they belong together."""


class ResultsFile:
    """Results by task name, kept in a file.

    Parameters
    ----------
    folder : Path
        Folder of results.json.
    effort : dataclass
        How much is computed. Results of another effort, commit or NumPy are not gone on with: they
        are kept in a file of their own.
    check_value : callable
        Checks the values that the file has already.

    Attributes
    ----------
    entries : dict
        Value and duration ("seconds") by task name.
    loaded : int
        Number of results that the file had already.
    old_results : Path or None
        Where the results of another run go when the first result of this run is written.

    Raises
    ------
    InputError
        When the file is no JSON, or is of this run and damaged.
    """

    def __init__(self, folder: Path, effort: Any, check_value: CheckValue) -> None:
        self.path = folder / RESULTS
        self.made = made_by(effort)
        self.entries: dict[str, dict[str, Any]] = {}
        self.old_results: Path | None = None
        if self.path.exists():
            data = read_json(self.path)
            if data.get("schema") == SCHEMA and data.get("made") == self.made:
                self.entries = checked_entries(Table(data, str(self.path)), check_value)
            else:
                self.old_results = _unused_name(folder, data.get("made"))
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
        if self.old_results is not None:
            _rename(self.path, self.old_results)
            self.old_results = None
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


def read_complete(path: Path, conclusions: tuple[str, ...]) -> Table:
    """Read a results.json that has all its conclusions; `InputError` for any other file."""
    data = read_json(path)
    if data.get("schema") != SCHEMA or not all(key in data for key in conclusions):
        raise InputError(path, "schema", f"complete results of schema {SCHEMA}", "other data")
    table = Table(data, str(path))
    for key in ("schema", "made", *conclusions, "results"):
        table.raw(key)
    table.finish()
    return table


def checked_effort(table: Table, efforts: dict[str, Any], verb: str) -> str:
    """Check what made the results, and return the name of its effort.

    Parameters
    ----------
    table : Table
        The file.
    efforts : dict
        The efforts of the verb as JSON data, by name.
    verb : str
        The command that writes such files, for the message.
    """
    made = table.table("made")
    for key in MADE_KEYS:
        check_line(made, key, made.raw(key))
    effort = made.raw("effort")
    made.finish()
    for name, data in efforts.items():
        if effort == data:
            return name
    raise made.error("effort", f"that of {verb}, or with --quick", "another")


def checked_entries(table: Table, check_value: CheckValue) -> dict[str, dict[str, Any]]:
    """Return a file's results by task name, each with its value and duration, all checked."""
    results = table.table("results")
    for name in results.names:
        check_line(table, "results", name)
        entry = results.table(name)
        entry.number("seconds", rule=NOT_NEGATIVE)
        check_value(name, entry.table("value"))
        entry.finish()
    return dict(results.data)


def check_line(table: Table, key: str, value: Any) -> None:
    """Check a text that the page shows as it is, in a table of Markdown."""
    LINE.checked(table.source, table.field(key), value)
    if "|" in value or "`" in value:
        raise table.error(key, LINE.expected, value)


def check_list(table: Table, key: str, rule: Number, count: int | None = None) -> list[Any]:
    """Return a list of numbers of one rule: `count` of them, or at least one."""
    values = list_of(table, key, count)
    for k, value in enumerate(values):
        rule.checked(table.source, f"{table.field(key)}[{k}]", value)
    return values


def list_of(table: Table, key: str, count: int | None = None) -> list[Any]:
    """Return a list with `count` items, or with at least one."""
    values = table.raw(key)
    if not (isinstance(values, list) and values and count in (None, len(values))):
        raise table.error(key, f"a list of {count or 'one or more'} items", values)
    return values


def named_items(table: Table, key: str) -> Table:
    """Return a table of one or more items, whose names are texts that the page can show."""
    items = table.table(key)
    check_names(items)
    return items


def check_names(items: Table) -> None:
    """Check that a table has one or more items, whose names are texts that the page can show."""
    if not items.names:
        raise InputError(items.source, items.path, "one or more items", "none")
    for name in items.names:
        check_line(items, "name", name)


def check_same_length(table: Table, *keys: str) -> None:
    """Check that lists that belong together are equally long."""
    if len({len(table.raw(key)) for key in keys}) > 1:
        raise table.error(keys[0], f"as many items as in {', '.join(keys[1:])}", "another number")


def _unused_name(folder: Path, made: object) -> Path:
    """Return the name for the results of another run: results-COMMIT.json, numbered if taken."""
    commit = made.get("commit") if isinstance(made, dict) else None
    words = re.findall(r"[0-9A-Za-z]+", str(commit or "unknown")[:MAX_COMMIT])
    stem = "-".join(["results", *words])
    endings = itertools.chain([""], (f"-{k}" for k in itertools.count(2)))
    names = (folder / f"{stem}{ending}.json" for ending in endings)
    return next(name for name in names if not name.exists())


def _rename(path: Path, name: Path) -> None:
    try:
        path.rename(name)
    except OSError as error:
        raise InputError(name, "file", "a path that can be written", error.strerror) from None


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
