"""Checkpoints of a search: a file with its state, from which the search resumes."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.files import read_bytes
from pe_core.base.serialization import load_toml, parse_json
from pe_core.search import EvaluatedRig, Journal
from pe_core.study.file_names import SEARCH, STUDY
from pe_core.study.study import Study
from pe_core.study.study_file import study_from_dict
from pe_core.version import __version__

from .folder import FileSet, prepare_folder
from .score_and_optimize import OptimizeJob
from .study_export import fingerprint, inputs_of, study_writers

PROGRAM, KIND = "perception-entropy", "search"
STATE_BYTES = 1 << 30
"""Maximum size of a state file: about thirty million evaluated placements."""
KEYS = ("version", "inputs", "study", "study_sha256", "evaluated")
A_STATE = "the state of a search, as this program writes it"


def state_head(kind: str, study: Study) -> dict[str, Any]:
    """Return what the state files of all kinds begin with: program, version, and the study."""
    written = study_writers(study, STUDY)[STUDY]
    assert isinstance(written, bytes)
    return {
        PROGRAM: kind,
        "version": __version__,
        "study_sha256": fingerprint(study),
        "study": written.decode(),
    }


class SearchState:
    """The state of a search, which is saved in its folder while the search runs.

    Parameters
    ----------
    study : Study
        The study that is searched.
    inputs : dict, optional
        Provenance (`inputs_of`) at the beginning of the search, if file names have changed since.
    """

    def __init__(self, study: Study, inputs: dict[str, Any] | None = None) -> None:
        self._study, self._inputs = study, inputs

    @cached_property
    def _head(self) -> dict[str, Any]:
        """The constant part of the state: cached, because it is expensive for a large mesh."""
        inputs = self._inputs or inputs_of(self._study)
        return {**state_head(KIND, self._study), "inputs": inputs}

    def to_bytes(self, entries: Iterable[EvaluatedRig]) -> bytes:
        """Return the content of the state file."""
        return json.dumps({**self._head, "evaluated": list(entries)}, ensure_ascii=False).encode()

    def save(
        self, folder: Path, best: Study, entries: Iterable[EvaluatedRig], *, meshes: bool = True
    ) -> None:
        """Write state and best placement into a folder.

        Parameters
        ----------
        folder : path
        best : Study
            The study with the best placement so far.
        entries : iterable of EvaluatedRig
            Journal of the search.
        meshes : bool
            False if meshes and other files of the study are in the folder already.

        Raises
        ------
        InputError
            The folder cannot be written, or this program did not write one of the files in it.
            The folder then stays unchanged.
        """
        with FileSet(prepare_folder(folder)) as files:
            for name, write in study_writers(best, STUDY).items():
                if meshes or name == STUDY:
                    files.add(name, write)
            files.add(SEARCH, self.to_bytes(entries))


@dataclass(frozen=True, slots=True)
class BegunSearch:
    """An unfinished search, read from its state file.

    Attributes
    ----------
    path : path
        The state file.
    study : Study
        The study that is searched; its files have their names in the folder.
    inputs : dict
        Provenance at the beginning of the search, with the original file names.
    evaluated : tuple of EvaluatedRig
        Journal of the evaluated rigs.
    """

    path: Path
    study: Study
    inputs: dict[str, Any]
    evaluated: tuple[EvaluatedRig, ...]

    def journal_of(self, study: Study) -> Journal:
        """Return the journal with which a search of the study resumes.

        Raises
        ------
        InputError
            The state belongs to the search of another study.
        """
        if fingerprint(study) != fingerprint(self.study):
            expected = "the study and the options that it was begun with"
            raise InputError(self.path, "study", expected, "others")
        return Journal(self.evaluated, str(self.path))


def read_search(folder: str | Path) -> BegunSearch:
    """Read the state of a search from the folder of its results.

    Raises
    ------
    InputError
        There is no state, it is damaged or of another version, or a mesh or boxes beside it have
        changed since the search began.
    """
    path = Path(folder) / SEARCH
    data = _data_of(path)
    if data["version"] != __version__:
        expected = f"{__version__}, the version of this program"
        raise InputError(path, "version", expected, shown(data["version"]))
    entries = _entries_of(path, data["evaluated"])
    study = study_from_dict(load_toml(path, "study", data["study"]), str(path), path.parent)
    if fingerprint(study) != data["study_sha256"]:
        raise InputError(path, "study", "unchanged files beside the study", "changed files")
    return BegunSearch(path, study, data["inputs"], entries)


def _data_of(path: Path) -> dict[str, Any]:
    try:
        data: Any = parse_json(path, read_bytes(path, STATE_BYTES), infinite=True)
        typed = isinstance(data["study"], str) and isinstance(data["inputs"], dict)
        if data[PROGRAM] == KIND and typed:
            return {key: data[key] for key in KEYS}
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
    raise InputError(path, "file", A_STATE, "another file")


def _entries_of(path: Path, rows: Any) -> tuple[EvaluatedRig, ...]:
    rows = rows if isinstance(rows, list) else [rows]
    for number, row in enumerate(rows):
        kinds = [type(value) for value in row] if isinstance(row, list) else []
        if kinds != [float, bool, str]:
            raise InputError(
                path, f"evaluated[{number}]", "an entropy, a truth value, a digest", shown(row)
            )
    return tuple(EvaluatedRig(*row) for row in rows)


SAVE_EVERY_S = 10.0
"""Interval of saving [s]: a round may take hours, so its intermediate results are saved, too."""


class Checkpoint:
    """Saves the state of a search in a folder while the search runs.

    However the search ends, it can resume from the last checkpoint (`SearchState`).

    Parameters
    ----------
    job : OptimizeJob
        Its journal may hold the entries of an earlier part of the same search.
    """

    def __init__(self, job: OptimizeJob) -> None:
        self._job, self._state = job, SearchState(job.study, job.inputs)
        self._saved_s, self._seen = time.monotonic(), (-1, False)
        self._saved_entries = len(job.journal.entries)
        self._folder: Path | None = None

    def due(self) -> bool:
        """Whether to save now: after every round, every few seconds, and when the job is stopped.

        A True result restarts the interval, whether or not the caller saves.
        """
        job = self._job
        if not job.history or len(job.journal.entries) <= self._saved_entries:
            return False
        job_state = (job.round, job.stopped)
        if time.monotonic() - self._saved_s < SAVE_EVERY_S and job_state == self._seen:
            return False
        self._seen, self._saved_s = job_state, time.monotonic()
        return True

    def save(self, folder: Path) -> Path:
        """Write state and best placement into a folder; return the path of the best study.

        Raises
        ------
        InputError
            The folder cannot be written, or this program did not write one of the files in it.
            The folder then stays unchanged.
        """
        entries, best = self._job.journal.entries, self._job.best
        meshes = folder != self._folder or not (folder / SEARCH).exists()
        self._state.save(folder, best, entries, meshes=meshes)
        self._folder, self._saved_entries = folder, len(entries)
        return folder / STUDY
