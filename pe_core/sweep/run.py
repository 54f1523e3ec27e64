"""One run of a sweep: what it is, what a worker does, and the checkpoints of its search."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from ..errors import InputError
from ..study import Checkpoint, OptimizeJob, Outcome, ScoreJob, Study, read_search
from ..version import __version__


@dataclass(frozen=True, slots=True)
class SweepRun:
    """A study to be scored or optimized.

    Attributes
    ----------
    name : str
        Of the folder for its results.
    study_name : str
    changes : mapping of str to str
        Values by key, as they were written.
    study : Study
        With the changes made.
    """

    name: str
    study_name: str
    changes: Mapping[str, str]
    study: Study


class RunCheckpoints(Protocol):
    """Checkpoints of the search of one run; sent to the worker with the task, so it is pickled."""

    def begin(self, job: OptimizeJob) -> Callable[[], None]:
        """Give the job the journal of an earlier part; return what is called after every step."""


@dataclass(frozen=True, slots=True)
class FolderCheckpoints:
    """Checkpoints that the worker itself saves in the folder of the run's results.

    Attributes
    ----------
    folder : path
    """

    folder: Path

    def begin(self, job: OptimizeJob) -> Callable[[], None]:
        """Continue the search whose checkpoint is in the folder, if it is one of the same study."""
        with suppress(InputError):  # none there, a damaged one, or of another study: begin anew
            job.journal = read_search(self.folder).journal_of(job.study)
        checkpoint = Checkpoint(job)

        def save() -> None:
            if checkpoint.due():
                with suppress(InputError):  # the search goes on; its results are written elsewhere
                    checkpoint.save(self.folder)

        return save


@dataclass(frozen=True, slots=True)
class RunTask:
    """What a worker is sent: all of it can be pickled.

    Attributes
    ----------
    study : Study
    optimize : bool
        Search, too; else score alone.
    threads : int
        Of a grid score; the result does not depend on them.
    checkpoints : RunCheckpoints, optional
        Of a search; without them a run that is broken off leaves nothing.
    version : str
        Of the engine that sends it.
    """

    study: Study
    optimize: bool
    threads: int
    checkpoints: RunCheckpoints | None = None
    version: str = __version__


def carried_out(task: RunTask) -> Outcome | InputError:
    """Score or optimize a study, in a worker; an error is returned, as others go on."""
    if task.version != __version__:
        expected = f"{task.version}, the version of the program that sent the study"
        return InputError("worker", "version", expected, __version__)
    try:
        outcome = _run_job(task)
    except InputError as error:
        return error
    except Exception as error:  # what a worker raises, some executors lose, and wait for ever
        message = " ".join(f"{type(error).__name__}: {error}".split())
        return InputError("worker", "run", "to run to its end", message)
    assert outcome is not None
    return outcome


def _run_job(task: RunTask) -> Outcome | None:
    if not task.optimize:
        job = ScoreJob(task.study, task.threads)
        for _ in job:
            pass
        return job.outcome
    search = OptimizeJob(task.study, task.threads)
    save = task.checkpoints.begin(search) if task.checkpoints else lambda: None
    for _ in search:
        save()
    return search.outcome
