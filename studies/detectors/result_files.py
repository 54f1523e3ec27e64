"""The results of runs: a file each, so that what is done is never done again."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from pe_core import InputError
from pe_core.base import Number, Table, dump_json, write_bytes

from ..results_file import read_json
from .posed_sensors import PosedSensors

Json = dict[str, Any]

RUNS = "runs"
"""Folder of the results."""
SCHEMA = 1
CODE = ("pe_core", "studies.detectors")
"""Packages of which a run is made; they have the prior, the catalogue and the plans, too."""
DIGITS = 16
SHARE = Number(0.0, 1.0)


def digest_of_files(folder: Path) -> str:
    """Return the SHA-256 of the results in a folder, 16 digits: of their names and contents."""
    return _digest_of((path.name, path.read_bytes()) for path in sorted(folder.glob("*.json")))


def run_digest(plan: str, versions: Mapping[str, str]) -> str:
    """Return the digest of what makes a run: plan, code with prior and catalogue, and versions.

    Parameters
    ----------
    plan : str
        Digest of the plan.
    versions : mapping
        Of Python and the libraries, by name.
    """
    code = sorted(
        (f"{package}/{path.relative_to(root).as_posix()}", path)
        for package in CODE
        for root in [Path(str(resources.files(package)))]
        for path in root.rglob("*")
        if path.suffix in (".py", ".toml")
    )
    parts = [("plan", plan.encode()), ("versions", dump_json(dict(versions)).encode())]
    return _digest_of(itertools.chain(parts, ((name, path.read_bytes()) for name, path in code)))


def _digest_of(parts: Iterable[tuple[str, bytes]]) -> str:
    total = hashlib.sha256()
    for name, content in parts:
        total.update(f"{name} {len(content)}\n".encode() + content)
    return total.hexdigest()[:DIGITS]


class NamedRun(Protocol):
    """A run, whose name is that of its file."""

    @property
    def name(self) -> str:
        """Its name."""


class PlacementRun(NamedRun, Protocol):
    """A run with one placement, or (None) with many."""

    @property
    def placement(self) -> PosedSensors | None:
        """Its placement."""


R = TypeVar("R", bound=NamedRun)


class ResultFiles(Generic[R]):
    """The results of runs in a folder.

    Parameters
    ----------
    folder : Path
        The folder of the study.
    digest : str
        Of the plan.
    planned : sequence of runs
        In their order.

    Attributes
    ----------
    folder : Path
    all : list of runs
        In their order.
    """

    def __init__(self, folder: Path, digest: str, planned: Sequence[R]) -> None:
        self.folder, self._folder, self._digest = folder, folder / RUNS, digest
        self.all = list(planned)

    def path(self, run: R) -> Path:
        """Return the file of a run."""
        return self._folder / f"{run.name}.json"

    def missing(self) -> list[R]:
        """Return the runs without a file, in their order."""
        return [run for run in self.all if not self.path(run).exists()]

    def write(self, run: R, data: Json) -> None:
        """Write a run's results atomically."""
        self._folder.mkdir(parents=True, exist_ok=True)
        head = {"schema": SCHEMA, "plan": self._digest, "run": run.name}
        write_bytes(self.path(run), dump_json({**head, **data}).encode())

    def read(self) -> dict[str, Json]:
        """Return the results that are there, by the name of the run, in the order of the plan.

        Raises
        ------
        InputError
            When a file is damaged, or of another plan or run.
        """
        return {run.name: self._checked(run) for run in self.all if self.path(run).exists()}

    def _checked(self, run: R) -> Json:
        path = self.path(run)
        data = read_json(path)
        table = Table(data, str(path))
        for key, expected in (("schema", SCHEMA), ("plan", self._digest), ("run", run.name)):
            if table.raw(key) != expected:
                raise InputError(path, key, str(expected), table.raw(key))
        self._check(run, table)
        return data

    def _check(self, run: R, table: Table) -> None:
        """Raise `InputError` unless the results of a run are as they can be."""
        check_ap(table)


def check_ap(table: Table) -> None:
    """Raise `InputError` unless there is an average precision."""
    table.number("ap", rule=SHARE)
