"""Checkpoints of searches: a file with the state of one, or of all of a front, to resume from. A
search that resumes from its journal asks for the same placements and takes their values from it. So
a search or a front that was interrupted ends at the same bits as one that was not."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.files import read_bytes
from pe_core.base.input_files import not_noting_inputs
from pe_core.base.table_reader import load_toml, parse_json
from pe_core.search import EvaluatedRig, Journal, checked_entries
from pe_core.study.file_names import SEARCH, STUDY
from pe_core.study.study import Study
from pe_core.study.study_file import study_from_dict
from pe_core.version import __version__

from .folder import PROGRAM
from .front_files import write_front
from .front_job import FrontJob, FrontJournals
from .job import Job
from .optimize_job import OptimizeJob
from .results import SearchState
from .study_export import fingerprint

EXPECTED = "the state of a search, as this program writes it"
STATE_BYTES = 1 << 30  # Maximum size of a state file: about thirty million evaluated placements
SAVE_EVERY_S = 10.0
"""Interval of saving [s]: a round may take hours, so its intermediate results are saved, too."""
KEYS = {"version": str, "study_sha256": str, "study": str, "inputs": dict, "journals": dict}


@dataclass(frozen=True, slots=True)
class BegunSearch:
    """Unfinished searches, read from their state file: their journals by name. The study's files
    have their names in the folder; `inputs` is the provenance at the beginning of the search, with
    the original file names."""

    path: Path
    study: Study
    inputs: dict[str, Any]
    journals: Mapping[str, tuple[EvaluatedRig, ...]]

    @property
    def evaluated(self) -> tuple[EvaluatedRig, ...]:
        """The entries of a single search."""
        return self.journals.get("", ())

    def of_study(self, study: Study) -> "BegunSearch":
        """Return itself; `InputError` if the state belongs to the searches of another study."""
        if fingerprint(study) != fingerprint(self.study):
            expected = "the study and the options that it was begun with"
            raise InputError(self.path, "study", expected, "others")
        return self

    def journal_of(self, study: Study) -> Journal:
        """Return the journal with which a search of the study resumes; `InputError` as above."""
        return Journal(self.of_study(study).evaluated, str(self.path))


@not_noting_inputs()
def read_search(folder: str | Path) -> BegunSearch:
    """Read the state of a search, or of those of a front, from the folder of its results.
    `InputError` if there is no state, it is damaged or of another version, or a mesh or boxes
    beside it have changed since the search began."""
    path = Path(folder) / SEARCH
    try:
        data: Any = parse_json(path, read_bytes(path, STATE_BYTES), infinite=True)
        is_one = data[PROGRAM] == "search" and all(isinstance(data[k], t) for k, t in KEYS.items())
    except (KeyError, TypeError):
        is_one = False
    if not is_one:
        raise InputError(path, "file", EXPECTED, "another file")
    if data["version"] != __version__:
        expected = f"{__version__}, the version of this program"
        raise InputError(path, "version", expected, shown(data["version"]))
    rows_of = data["journals"].items()
    journals = {n: checked_entries(rows, str(path), n or "evaluated") for n, rows in rows_of}
    study = study_from_dict(load_toml(path, "study", data["study"]), str(path), path.parent)
    if fingerprint(study) != data["study_sha256"]:
        raise InputError(path, "study", "unchanged files beside the study", "changed files")
    return BegunSearch(path, study, data["inputs"], journals)


class Checkpoint:
    """Saves the state of a search in a folder while the search runs. However the search ends, it
    can resume from the last checkpoint (`SearchState`). The journal of the job may hold the entries
    of an earlier part of the same search."""

    file = STUDY  # Of the best so far

    def __init__(self, job: OptimizeJob) -> None:
        self._job = job
        self._state = SearchState(job.study, job.inputs)
        self._saved_s = time.monotonic()
        self._seen = (-1, False)
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
        self._seen = job_state
        self._saved_s = time.monotonic()
        return True

    def save(self, folder: Path) -> None:
        """Write state and best placement into a folder; raises as `SearchState.save`."""
        entries = self._job.journal.entries
        best = self._job.best
        is_new = folder != self._folder or not (folder / SEARCH).exists()
        self._state.save(folder, best, {self._job.journal_name: entries}, other=is_new)
        self._folder = folder
        self._saved_entries = len(entries)


class FrontCheckpoint:
    """Saves the checkpoint of a front in its folder while the job runs, with the front so far."""

    file = SEARCH

    def __init__(self, job: FrontJob, host: Mapping[str, str] | None = None) -> None:
        self._job = job
        self._host = host
        self._state = SearchState(job.study, job.inputs)
        self._folder: Path | None = None
        self._saved_s = time.monotonic()
        self._searched = 0

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
        journals = self._job.journals.entries()
        self._state.save(folder, self._job.study, journals, own=False, other=folder != self._folder)
        self._folder = folder
        found = None if self._job.is_done else self._job.trade_off
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
    begun = read_search(folder).of_study(job.study)
    job.inputs = begun.inputs
    if isinstance(job, FrontJob):
        job.journals = FrontJournals(begun.journals)
    elif extra := [name for name in begun.journals if name != job.journal_name]:
        expected = f"the journal of one search by {job.figure.label}"
        raise InputError(begun.path, "journals", expected, shown(extra[0]))
    else:
        job.journal = Journal(begun.journals.get(job.journal_name, ()), str(begun.path))
    return sum(map(len, begun.journals.values()))
