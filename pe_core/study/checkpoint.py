"""Checkpoints of a search: its state and its best placement so far, saved while it runs."""

from __future__ import annotations

import time
from pathlib import Path

from .jobs import OptimizeJob
from .names import SEARCH, STUDY
from .search_state import SearchState

SAVE_EVERY_S = 10.0
"""A round may take hours: what it found so far is saved as well."""


class Checkpoint:
    """Saves the state of a search in a folder while the search runs.

    Whatever ends the search at whatever moment, it goes on from the last checkpoint:
    see `SearchState`.

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

        The next answer counts from this one on, whether or not the caller saved.
        """
        job = self._job
        if not job.history or len(job.journal.entries) <= self._saved_entries:
            return False
        seen = (job.round, job.stopped)
        if time.monotonic() - self._saved_s < SAVE_EVERY_S and seen == self._seen:
            return False
        self._seen, self._saved_s = seen, time.monotonic()
        return True

    def save(self, folder: Path) -> Path:
        """Write state and best placement into a folder; return the path of the best study.

        Raises
        ------
        InputError
            The folder cannot be written, or a file in it is not ours: all stays as it was.
        """
        entries, best = self._job.journal.entries, self._job.best
        meshes = folder != self._folder or not (folder / SEARCH).exists()
        self._state.save(folder, best, entries, meshes=meshes)
        self._folder, self._saved_entries = folder, len(entries)
        return folder / STUDY
