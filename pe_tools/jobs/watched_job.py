"""A job that the engine's process runs, and the copy of it that the window looks at."""

import copy
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from .job import Job, Outcome, Progress
from .results import cache_result

KEEP_S = 2.0  # How often what a killed job would resume from is sent


@dataclass(frozen=True, slots=True)
class JobStep:
    """Progress of a job, and those of its attributes that have changed. `shown` are those that its
    driver looks at, `kept` those that a job like it would resume from."""

    progress: Progress
    shown: Mapping[str, Any]
    kept: Mapping[str, Any]


class JobRun:
    """In the engine's process: runs a job; yields a `JobStep` for each of its steps. It returns the
    attribute `outcome` of the job."""

    def __init__(self, job: Job, outcome: str = "outcome", keep_s: float = KEEP_S) -> None:
        self._job = job
        self._outcome = outcome
        self._steps = iter(job)
        self._keep_s = keep_s
        self._seen: object = None
        self._kept_at = time.monotonic()

    def __iter__(self) -> Iterator[JobStep]:
        return self

    def __next__(self) -> JobStep:
        try:
            progress = next(self._steps)
        except StopIteration:
            found = getattr(self._job, self._outcome)
            if isinstance(found, Outcome):
                cache_result(found)
            raise StopIteration(found) from None
        shown = {name: getattr(self._job, name) for name in self._job.shown}
        state = [len(each) if hasattr(each, "__len__") else each for each in shown.values()]
        if state == self._seen:
            shown = {}
        self._seen = state
        kept = {}
        if time.monotonic() - self._kept_at > self._keep_s:
            self._kept_at = time.monotonic()
            kept = {name: getattr(self._job, name) for name in self._job.kept}
        return JobStep(progress, shown, kept)

    def cancel(self, drop: bool) -> None:
        """Stop the job, or drop it."""
        (self._job.drop if drop else self._job.stop)()


class WatchedJob:
    """In the window's process: a job that runs elsewhere, as far as it is known here. `job` is
    never run here: with what was kept of it, it can be sent again. `seen` is a copy of it with the
    attributes that the running job has."""

    def __init__(self, job: Job) -> None:
        self.job = job
        self.seen = copy.copy(job)
        self.progress = Progress("starting", 0.0)

    def note(self, step: JobStep) -> None:
        """Take a step of the running job."""
        self.progress = step.progress
        vars(self.seen).update(step.shown)
        vars(self.job).update(step.kept)
