"""Checkpoints of searches: a file with the state of one, or of all of a front, to resume from. A
search that resumes from its journal asks for the same placements and takes their values from it. So
a search or a front that was interrupted ends at the same bits as one that was not."""

import json
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.files import read_bytes
from pe_core.base.table_reader import load_toml, parse_json
from pe_core.search import EvaluatedRig, Journal
from pe_core.study.file_names import SEARCH, STUDY
from pe_core.study.study import Study
from pe_core.study.study_file import study_from_dict
from pe_core.version import __version__

from .folder import PROGRAM, FileSet, prepare_folder
from .front_files import write_front
from .front_job import FRONT_SEARCH, FrontJob, FrontJournals
from .job import Job
from .results import SEARCH_KIND, SearchState, state_head
from .score_and_optimize import OptimizeJob
from .study_export import fingerprint, study_writers

FRONT_KIND = "front search"
WHAT = {
    SEARCH_KIND: "the state of a search, as this program writes it",
    FRONT_KIND: "the checkpoint of a front, as this program writes it",
}
STATE_BYTES = 1 << 30  # Maximum size of a state file: about thirty million evaluated placements
SAVE_EVERY_S = 10.0
"""Interval of saving [s]: a round may take hours, so its intermediate results are saved, too."""


def _state_of(path: Path, kind: str, more: Mapping[str, type]) -> dict[str, Any]:
    """Return the data of a state file of this version; `more` has further keys and their types."""
    keys = {"version": str, "study_sha256": str, "study": str, **more}
    try:
        data: Any = parse_json(path, read_bytes(path, STATE_BYTES), infinite=True)
        is_one = data[PROGRAM] == kind and all(isinstance(data[k], t) for k, t in keys.items())
    except (KeyError, TypeError):
        is_one = False
    if not is_one:
        raise InputError(path, "file", WHAT[kind], "another file")
    if data["version"] != __version__:
        expected = f"{__version__}, the version of this program"
        raise InputError(path, "version", expected, shown(data["version"]))
    return data  # type: ignore[no-any-return]


def _study_of(path: Path, data: Mapping[str, Any]) -> Study:
    """Return the study of a state file; its files are those beside it."""
    study = study_from_dict(load_toml(path, "study", data["study"]), str(path), path.parent)
    if fingerprint(study) != data["study_sha256"]:
        raise InputError(path, "study", "unchanged files beside the study", "changed files")
    return study


def _entries_of(path: Path, field: str, rows: Any) -> tuple[EvaluatedRig, ...]:
    rows = rows if isinstance(rows, list) else [rows]
    for number, row in enumerate(rows):
        kinds = [type(value) for value in row] if isinstance(row, list) else []
        if kinds != [float, str]:
            expected = "an entropy, a digest"
            raise InputError(path, f"{field}[{number}]", expected, shown(row))
    return tuple(EvaluatedRig(*row) for row in rows)


def _check_same(path: Path, study: Study, digest: str) -> None:
    if fingerprint(study) != digest:
        expected = "the study and the options that it was begun with"
        raise InputError(path, "study", expected, "others")


@dataclass(frozen=True, slots=True)
class BegunSearch:
    """An unfinished search, read from its state file. The study's files have their names in the
    folder; `inputs` is the provenance at the beginning of the search, with the original file
    names."""

    path: Path
    study: Study
    inputs: dict[str, Any]
    evaluated: tuple[EvaluatedRig, ...]

    def journal_of(self, study: Study) -> Journal:
        """Return the journal with which a search of the study resumes. Raises `InputError` if the
        state belongs to the search of another study."""
        _check_same(self.path, study, fingerprint(self.study))
        return Journal(self.evaluated, str(self.path))


def read_search(folder: str | Path) -> BegunSearch:
    """Read the state of a search from the folder of its results. `InputError` if there is no state,
    it is damaged or of another version, or a mesh or boxes beside it have changed since the search
    began."""
    path = Path(folder) / SEARCH
    data = _state_of(path, SEARCH_KIND, {"inputs": dict, "evaluated": object})
    entries = _entries_of(path, "evaluated", data["evaluated"])
    return BegunSearch(path, _study_of(path, data), data["inputs"], entries)


class Checkpoint:
    """Saves the state of a search in a folder while the search runs. However the search ends, it
    can resume from the last checkpoint (`SearchState`). The journal of the job may hold the entries
    of an earlier part of the same search."""

    file = STUDY  # Of the best so far

    def __init__(self, job: OptimizeJob) -> None:
        self._job, self._state = job, SearchState(job.study, job.inputs)
        self._saved_s, self._seen = time.monotonic(), (-1, False)
        self._saved_entries = len(job.journal.entries)
        self._folder: Path | None = None

    @property
    def has_more(self) -> bool:
        """Whether there is a placement to save beside the start."""
        return len(self._job.history) > 1

    def due(self) -> bool:
        """Whether to save now: after every round, every few seconds, and when the job is stopped. A
        True result restarts the interval, whether or not the caller saves."""
        job = self._job
        if not job.history or len(job.journal.entries) <= self._saved_entries:
            return False
        job_state = (job.round, job.stopped)
        if time.monotonic() - self._saved_s < SAVE_EVERY_S and job_state == self._seen:
            return False
        self._seen, self._saved_s = job_state, time.monotonic()
        return True

    def save(self, folder: Path) -> None:
        """Write state and best placement into a folder; raises as `SearchState.save`."""
        entries, best = self._job.journal.entries, self._job.best
        meshes = folder != self._folder or not (folder / SEARCH).exists()
        self._state.save(folder, best, entries, meshes=meshes)
        self._folder, self._saved_entries = folder, len(entries)


class FrontCheckpoint:
    """Saves the checkpoint of a front in its folder while the job runs, with the front so far."""

    file = FRONT_SEARCH

    def __init__(self, job: FrontJob, host: Mapping[str, str] | None = None) -> None:
        self._job, self._host = job, host
        self._folder: Path | None = None
        self._saved_s, self._searched = time.monotonic(), 0

    @cached_property
    def _head(self) -> dict[str, Any]:
        """The constant part: cached, because it is expensive for a large mesh."""
        return state_head(FRONT_KIND, self._job.study)

    @property
    def has_more(self) -> bool:
        """Whether placements were evaluated."""
        return self._job.journals.count > 0

    def due(self) -> bool:
        """Whether to save now: every few seconds, and at the end."""
        now = time.monotonic()
        if self._job.is_done or now - self._saved_s >= SAVE_EVERY_S:
            self._saved_s = now
            return self.has_more
        return False

    def save(self, folder: Path) -> None:
        """Write the checkpoint into the front's folder; once also the files that the study names.
        `InputError` if the folder cannot be written, or another program wrote such a file."""
        state = {**self._head, "journals": self._job.journals.entries()}
        with FileSet(prepare_folder(folder, (FRONT_SEARCH,))) as files:
            if folder != self._folder:
                for name, write in study_writers(self._job.study, STUDY).items():
                    if name != STUDY:
                        files.add(name, write)
            files.add(FRONT_SEARCH, json.dumps(state, ensure_ascii=False).encode())
        self._folder, found = folder, None if self._job.is_done else self._job.trade_off
        if found is not None and found.searched > self._searched:
            self._searched = found.searched
            write_front(found, folder, self._host)


def checkpoint_of(
    job: Job, host: Mapping[str, str] | None = None
) -> Checkpoint | FrontCheckpoint | None:
    """Return what saves the state of a job while it runs; None for one that does not search."""
    if isinstance(job, FrontJob):
        return FrontCheckpoint(job, host)
    return Checkpoint(job) if isinstance(job, OptimizeJob) else None


def resume(job: OptimizeJob | FrontJob, folder: Path) -> int:
    """Let a job go on where the one in a folder ended; return how many placements are known.
    `InputError` where the folder has no checkpoint of such a job, or that of another study."""
    if isinstance(job, FrontJob):
        job.journals = read_front_search(job.study, folder)
        return job.journals.count
    begun = read_search(folder)
    job.journal, job.inputs = begun.journal_of(job.study), begun.inputs
    return len(begun.evaluated)


def front_study(folder: str | Path) -> Study | None:
    """Return the study of a front's checkpoint; None for a folder with the state of one search.
    Raises `InputError` if it is damaged, or files that the study names have changed."""
    path = Path(folder) / FRONT_SEARCH
    if (Path(folder) / SEARCH).exists() or not path.exists():
        return None
    return _study_of(path, _state_of(path, FRONT_KIND, {"journals": dict}))


def read_front_search(study: Study, folder: Path) -> FrontJournals:
    """Read the checkpoint of the front of a study. Raises `InputError` if there is none, it is
    damaged or of another version, or it belongs to another study."""
    path = folder / FRONT_SEARCH
    data = _state_of(path, FRONT_KIND, {"journals": dict})
    _check_same(path, study, data["study_sha256"])
    journals = data["journals"].items()
    return FrontJournals({name: _entries_of(path, name, rows) for name, rows in journals})
