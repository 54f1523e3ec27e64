"""A search's state and its best so far, kept in the output folder while it runs."""

from __future__ import annotations

from pathlib import Path

from ..errors import InputError
from ..study import Checkpoint, Job, OptimizeJob
from .fallback_folder import folder_or_fallback
from .terminal import tell


class Saver:
    """Saves the checkpoints of a search in the output folder, and says what goes wrong."""

    def __init__(self, job: Job, output: Path | None) -> None:
        self._job = job if isinstance(job, OptimizeJob) else None
        self._checkpoint = Checkpoint(self._job) if self._job else None
        self._output = output
        self._warned = False

    def save_when_due(self) -> None:
        """Save after every round, every few seconds, and when the search is stopped.

        Who stopped it may not wait.
        """
        if self._output is None or self._checkpoint is None or not self._checkpoint.due():
            return
        try:
            self._checkpoint.save(self._output)
        except InputError as error:
            if not self._warned:
                tell(f"{error}; the search goes on")
            self._warned = True

    def save_at_last(self) -> None:
        """Save now, where that can be done, and say where."""
        if self._output is None or self._job is None or len(self._job.history) < 2:
            return
        assert self._checkpoint is not None
        for place in (self._output, None):
            try:
                with folder_or_fallback(place) as folder:
                    saved = self._checkpoint.save(folder)
                tell(f"the best placement so far is in {saved}")
                return
            except InputError as error:
                tell(str(error))
