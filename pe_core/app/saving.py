"""A search's state and its best so far, kept in the output folder while it runs."""

from __future__ import annotations

import time
from pathlib import Path

from ..errors import InputError
from ..study import SEARCH, STUDY, Job, OptimizeJob, SearchState
from .elsewhere import another_folder
from .terminal import tell

SAVE_EVERY_S = 10.0
"""A round may take hours: what it found so far is kept as well."""


class Saver:
    """Keeps a search's state, and its best so far as a study, in the output folder.

    Whatever ends the search at whatever moment, it goes on from there: see `SearchState`.
    """

    def __init__(self, job: Job, output: Path | None) -> None:
        self._job = job if isinstance(job, OptimizeJob) else None
        self._output, self._saved_s = output, time.monotonic()
        self._state = SearchState(job.study, self._job.inputs if self._job else None)
        self._seen = (-1, False)
        self._known = len(self._job.journal.entries) if self._job else 0
        self._folder: Path | None = None
        self._warned = False

    def save_when_due(self) -> None:
        """Save after every round, every few seconds, and when the search is stopped.

        Who stopped it may not wait.
        """
        job = self._job
        if self._output is None or job is None or not job.history:
            return
        seen = (job.round, job.stopped)
        late = time.monotonic() - self._saved_s >= SAVE_EVERY_S
        if (late or seen != self._seen) and len(job.journal.entries) > self._known:
            self._seen, self._saved_s = seen, time.monotonic()
            try:
                self._save(self._output)
            except InputError as error:
                if not self._warned:
                    tell(f"{error}; the search goes on")
                self._warned = True

    def save_at_last(self) -> None:
        """Save now, where that can be done, and say where."""
        if self._output is None or self._job is None or len(self._job.history) < 2:
            return
        for place in (self._output, None):
            try:
                tell(f"the best placement so far is in {self._save(place or another_folder())}")
                return
            except InputError as error:
                tell(str(error))

    def _save(self, folder: Path) -> Path:
        assert self._job is not None
        entries, best = self._job.journal.entries, self._job.best
        meshes = folder != self._folder or not (folder / SEARCH).exists()
        self._state.save(folder, best, entries, meshes=meshes)
        self._folder, self._known = folder, len(entries)
        return folder / STUDY
