"""One run of a sweep: what it is, and what a worker does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..errors import InputError
from ..study import OptimizeJob, Outcome, ScoreJob, Study
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
    version : str
        Of the engine that sends it.
    """

    study: Study
    optimize: bool
    threads: int
    version: str = __version__


def carried_out(task: RunTask) -> Outcome | InputError:
    """Score or optimize a study, in a worker; an error is returned, as others go on."""
    if task.version != __version__:
        expected = f"{task.version}, the version of the program that sent the study"
        return InputError("worker", "version", expected, __version__)
    try:
        job = (OptimizeJob if task.optimize else ScoreJob)(task.study, task.threads)
        for _ in job:
            pass
    except InputError as error:
        return error
    except Exception as error:  # what a worker raises, some executors lose, and wait for ever
        told = " ".join(f"{type(error).__name__}: {error}".split())
        return InputError("worker", "run", "to run to its end", told)
    assert job.outcome is not None
    return job.outcome
