"""The runs of a sweep: tasks for the workers of any executor, and checkpoints of their searches."""

import os
import pickle
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from pathlib import Path

from pe_core import catalog
from pe_core.base.errors import InputError
from pe_core.base.lazy_threads import threads
from pe_core.scene.rig import Rig, SensorModel
from pe_core.search import Call, WorkerDied, run_tasks, start_processes
from pe_core.study import Study
from pe_core.version import __version__

from ..jobs import Checkpoint, OptimizeJob, Outcome, ScoreJob, read_search

WAIT_S = 0.2  # How often it is checked whether the sweep continues, while no result arrives
RunResult = Outcome | InputError
_last_scores: list[ScoreJob] = []
"""This worker's last score, or none: a task that begins takes it out, so that no two threads use
the same evaluators."""


@dataclass(frozen=True, slots=True)
class SweepRun:
    """A study with changes, by key as they were written; `name` is that of its results' folder."""

    name: str
    study_name: str
    changes: Mapping[str, str]
    study: Study


@dataclass(frozen=True, slots=True)
class RunTask:
    """The task of a run, as it is sent to a worker: all of it can be pickled. Without `optimize`
    the study is scored, by so many threads. A search leaves checkpoints in `folder`, and goes on
    from there. `version` is that of the engine that sends the task."""

    study: Study
    optimize: bool
    threads: int
    folder: Path | None = None
    version: str = __version__


def run_task(task: RunTask) -> RunResult:
    """Score or optimize a study, in a worker; an error is returned, because other runs continue."""
    if task.version != __version__:
        expected = f"{task.version}, the version of the program that sent the study"
        return InputError("worker", "version", expected, __version__)
    threads().keep_freed_memory()
    save: Callable[[], object] | None = None
    try:
        job: ScoreJob | OptimizeJob
        if not task.optimize:
            job = _score_job(task)
        else:
            job = OptimizeJob(task.study, task.threads)
            save = None if task.folder is None else _begun(job, task.folder)
        for _ in job:
            if save is not None:
                save()
        if isinstance(job, ScoreJob):
            _last_scores[:] = [job]
    except InputError as error:
        return error
    except Exception as error:  # some executors lose a worker's exception, and wait forever
        message = " ".join(f"{type(error).__name__}: {error}".split())
        return InputError("worker", "run", "to complete", message)
    assert job.outcome is not None
    return job.outcome


def _score_job(task: RunTask) -> ScoreJob:
    """Return the score of a task, with the evaluators of the last one where only the rig has
    changed since: what has not moved is not measured again."""
    job = ScoreJob(task.study, task.threads)
    with suppress(IndexError):
        last = _last_scores.pop()
        job = ScoreJob(_sharing_parts(task.study, last.study), task.threads)
        if last.evaluators.key == job.evaluators.key:
            job.evaluators = last.evaluators
    job.as_drawn = job.evaluators.as_drawn
    return job


def _sharing_parts(study: Study, last: Study) -> Study:
    """Return a study with the vehicle and the models of another one where they have the same
    content: caches know these by identity, and each task comes with copies of its own."""
    is_same = pickle.dumps(study.vehicle) == pickle.dumps(last.vehicle)
    models = [sensor.model for sensor in last.rig]
    rig = Rig([replace(each, model=_first_alike(each.model, models)) for each in study.rig])
    return replace(study, vehicle=last.vehicle if is_same else study.vehicle, rig=rig)


def _first_alike(own: SensorModel, others: Sequence[SensorModel]) -> SensorModel:
    """Return the first of other models that is the same as a model, else the model itself."""
    alike = (e for e in others if e.name == own.name and catalog.same_model(e, own))
    return next(alike, own)


def _begun(job: OptimizeJob, folder: Path) -> Callable[[], None]:
    """Let a search go on from its checkpoint in a folder; return what saves it there again."""
    with suppress(InputError):  # no checkpoint, a damaged one, or another study: a new search
        job.journal = read_search(folder).journal_of(job.study)
    checkpoint = Checkpoint(job)

    def save() -> None:
        if checkpoint.due():
            with suppress(InputError):  # the search continues
                checkpoint.save(folder)

    return save


class LocalWorkers:
    """Processes on this machine that run the tasks of a sweep; a thread where there are none. Other
    workers have the same methods. The executor accepts tasks even after a worker's death."""

    reaches_folders = True  # Whether the workers save checkpoints in the folders of the results

    def __init__(self, count: int) -> None:
        processes = start_processes(count)
        self._count = 1 if processes is None else count
        self.executor: Executor = processes or ThreadPoolExecutor(1)
        self.threads = max(1, (os.cpu_count() or 1) // self._count)
        """How many threads a task may use."""

    def width(self) -> int:
        """How many tasks are submitted at a time: a dead process tells which one killed it."""
        return self._count

    def check(self) -> None:
        """Raise `InputError` when the workers are gone; called several times a second."""

    def close(self) -> None:
        """Kill processes in the middle of their tasks; a thread finishes its task."""
        self.executor.shutdown(wait=self._count > 1, cancel_futures=True)


def run_all(
    names: Sequence[str],
    make_task: Callable[[str], RunTask],
    pool: LocalWorkers,
    on_result: Callable[[str, RunResult], None],
    should_continue: Callable[[], bool] = lambda: True,
) -> None:
    """Run tasks by name; `on_result` is called with each result as it arrives, in this thread.
    `make_task` is called when a worker is free. A task whose worker died is made and run once more,
    alone, after all others. `should_continue` is called several times a second; when it returns
    False, the remaining tasks are cancelled. `InputError` when the workers are gone."""

    def call_of(name: str) -> Call:
        return Call(run_task, (make_task(name),))

    with closing(
        run_tasks(pool.executor, deque(names), call_of, pool.width, wait_s=WAIT_S)
    ) as batches:
        pool.check()
        while should_continue():
            try:
                batch = next(batches, None)
            except Exception:  # an executor that is gone refuses tasks with an error of its own
                pool.check()
                raise
            if batch is None:
                return
            for name, result in batch:
                if isinstance(result, WorkerDied):
                    expected = "a worker that survives its task"
                    found = "two that died"
                    result = InputError(name, "worker", expected, f"{found} ({result.reason})")
                on_result(name, result)
            pool.check()
