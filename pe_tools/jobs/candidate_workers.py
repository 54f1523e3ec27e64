"""The workers that evaluate the candidates of a job's searches: an executor, or processes here."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager, suppress
from itertools import chain

from pe_core.search import LazyProcesses, Objective, Unreadable, send_payload

from .job import Job

ExecutorSource = Callable[[], Executor | None]


@contextmanager
def candidate_workers(
    job: Job, objectives: Iterable[Objective], others: Iterable[object] = ()
) -> Iterator[ExecutorSource]:
    """Yield the source of the executor that evaluates candidates of a job. The job's executor does,
    if it has one. Otherwise processes are started, which end here. They are sent what the
    objectives share, the models of the study's rig, and `others` that searches have in common. All
    of it is known from the first: what came later would start all processes anew."""
    parts = (part for objective in objectives for part in objective.shared_parts())
    models = (sensor.model for sensor in job.study.rig)
    common = chain(parts, models, others)  # read when the processes start, if they do
    if job.executor is not None:
        given = job.executor
        with suppress(Unreadable):  # such candidates are evaluated here
            send_payload(given, common)
        yield lambda: given
        return
    helpers = LazyProcesses(job.workers, common)
    try:
        yield helpers
    finally:
        helpers.end()
