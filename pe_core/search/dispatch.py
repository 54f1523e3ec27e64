"""Dispatch of candidates: evaluated here or by an executor's workers, with the same result."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Executor
from contextlib import closing, suppress
from itertools import chain
from typing import Protocol, runtime_checkable

from ..base.errors import InputError
from ..scene.rig import Rig
from ..scoring.protocol import Evaluation, Objective
from .payload import PackedPayload, Unreadable, send_payload, unpickled
from .worker_pool import Call, WorkerDied, run_tasks


@runtime_checkable
class BatchObjective(Protocol):
    """An objective that evaluates several rigs itself, because it knows some of them already."""

    def evaluate_all(
        self, rigs: Sequence[Rig], cutoff: float, executor: Executor | None
    ) -> list[Evaluation]:
        """Evaluate several rigs, as the function of this name does."""


@runtime_checkable
class WrappingObjective(Protocol):
    """An objective of little content round others that workers are to be sent once."""

    def shared_parts(self) -> tuple[object, ...]:
        """Return its parts that do not change; the rest is sent with each candidate."""


def shared_parts(objective: Objective) -> tuple[object, ...]:
    """Return what a worker is sent once to evaluate an objective: its parts, or the objective."""
    if isinstance(objective, WrappingObjective):
        return objective.shared_parts()
    return (objective,)


def evaluate_all(
    objective: Objective,
    rigs: Sequence[Rig],
    cutoff: float = math.inf,
    executor: Executor | None = None,
) -> list[Evaluation]:
    """Evaluate several rigs; the result depends neither on the workers nor on earlier calls.

    Parameters
    ----------
    objective : Objective
        Its `shared_parts` are sent to each worker once, so they must not change. Where it cannot be
        pickled, or a worker cannot unpickle it, the rigs are evaluated here.
    rigs : sequence of Rig
    cutoff : float
        Entropies are needed only below this value [nats]; all of them, by default.
    executor : concurrent.futures.Executor, optional
        Its workers evaluate; by default this thread does. `Processes` replaces dead workers.

    Returns
    -------
    list of Evaluation
        For each rig its entropy where that is below `cutoff`; otherwise `cutoff` as a lower bound,
        even where the entropy is known. `InputError` when two workers died with the same rig.
    """
    if isinstance(objective, BatchObjective):
        return objective.evaluate_all(rigs, cutoff, executor)
    if executor is not None and rigs:
        with suppress(Unreadable):
            return _evaluate_by_workers(objective, rigs, cutoff, executor)
    return [_reproducible(objective.evaluate(rig, cutoff), cutoff) for rig in rigs]


def _reproducible(evaluation: Evaluation, cutoff: float) -> Evaluation:
    """Replace any value that is not below the cutoff: which one it is depends on caches."""
    return evaluation if evaluation.entropy < cutoff else Evaluation(cutoff, True)


def _evaluate_by_workers(
    objective: Objective, rigs: Sequence[Rig], cutoff: float, executor: Executor
) -> list[Evaluation]:
    models = (sensor.model for rig in rigs for sensor in rig)
    sent = send_payload(executor, (*shared_parts(objective), *models))
    candidates = [sent.payload.pickled((objective, rig)) for rig in rigs]
    tried: set[int] = set()

    def call_of(number: int) -> Call:
        """A second attempt brings the payload: perhaps it was lost with the first one's worker."""
        payload = sent.payload.packed if number in tried else sent.argument
        tried.add(number)
        return Call(_evaluate_in_worker, (payload, candidates[number], cutoff))

    evaluations: dict[int, Evaluation] = {}
    with closing(run_tasks(executor, deque(range(len(rigs))), call_of)) as batches:
        for number, result in chain.from_iterable(batches):
            if isinstance(result, WorkerDied):
                places = [(s.name, [round(w, 3) for w in s.pose.position]) for s in rigs[number]]
                found = f"two that died with {', '.join(f'{n} at {at}' for n, at in places)}"
                raise InputError("workers", "process", "a worker that survives its task", found)
            evaluations[number] = result
    return [evaluations[number] for number in range(len(rigs))]


def _evaluate_in_worker(payload: PackedPayload, candidate: bytes, cutoff: float) -> Evaluation:
    objective, rig = unpickled(payload, candidate)
    return _reproducible(objective.evaluate(rig, cutoff), cutoff)
