"""Dispatch of candidates: evaluated here or by the workers of any executor, with the same result.

What candidates have in common is sent to a worker once and cached there by a hash of its content:
an objective, the vehicle and sensors' models are large, a candidate is small. A message names such
payloads by their keys; a worker that lacks one replies so, and gets it with the next attempt.
"""

from __future__ import annotations

import hashlib
import io
import math
import pickle
import threading
from collections import OrderedDict, deque
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing, suppress
from itertools import chain
from typing import Any, Protocol, runtime_checkable
from weakref import WeakKeyDictionary

from ..base.errors import InputError
from ..scene.rig import Rig, SensorModel
from ..scene.vehicle import Vehicle
from ..scoring.protocol import Judgement, Objective
from .worker_pool import Call, Reply, WorkerDied, run_tasks

MAX_CACHED = 32
"""How many payloads a worker keeps: those that were used last."""

_PAYLOADS: WeakKeyDictionary[Any, Payload] = WeakKeyDictionary()
"""Payloads by content, as long as the content is referenced elsewhere."""
_WORKER = threading.local()
"""The cache of this worker. Threads share none of it, so that no thread waits for another."""


class Unreadable(TypeError):
    """An objective or a rig cannot be pickled, or a worker cannot unpickle it."""


class MissingPayloads(LookupError):
    """A worker lacks payloads; `keys` names them."""

    def __init__(self, keys: Iterable[str]) -> None:
        super().__init__(*keys)
        self.keys = tuple(keys)


@runtime_checkable
class BatchObjective(Protocol):
    """An objective that evaluates several rigs itself, because it knows some of them already."""

    def evaluate_all(
        self, rigs: Sequence[Rig], cutoff: float, executor: Executor | None
    ) -> list[Judgement]:
        """Evaluate several rigs, as the function of this name does."""


def evaluate_all(
    objective: Objective,
    rigs: Sequence[Rig],
    cutoff: float = math.inf,
    executor: Executor | None = None,
) -> list[Judgement]:
    """Evaluate several rigs; the result depends neither on the workers nor on earlier calls.

    Parameters
    ----------
    objective : Objective
        It is sent to each worker once, so it must not change. Where it cannot be pickled, or a
        worker cannot unpickle it, the rigs are evaluated here.
    rigs : sequence of Rig
    cutoff : float
        Entropies are needed only below this value [nats]; all of them, by default.
    executor : concurrent.futures.Executor, optional
        Its workers evaluate; by default this thread does. `Processes` replaces dead workers.

    Returns
    -------
    list of Judgement
        One for each rig: its entropy where that is below `cutoff`; otherwise `cutoff` as a lower
        bound, even where the entropy is known.

    Raises
    ------
    InputError
        When two workers died with the same rig, and whatever the objective raises.
    """
    if isinstance(objective, BatchObjective):
        return objective.evaluate_all(rigs, cutoff, executor)
    if executor is not None and rigs:
        with suppress(Unreadable):
            return _evaluate_by_workers(objective, rigs, cutoff, executor)
    return [_reproducible(objective.judge(rig, cutoff), cutoff) for rig in rigs]


def _reproducible(judgement: Judgement, cutoff: float) -> Judgement:
    """Replace any value that is not below the cutoff: which one it is depends on caches."""
    return judgement if judgement.entropy < cutoff else Judgement(cutoff, True)


def _evaluate_by_workers(
    objective: Objective, rigs: Sequence[Rig], cutoff: float, executor: Executor
) -> list[Judgement]:
    try:
        common, candidates = payload_of(objective), [Payload(rig) for rig in rigs]
    except Exception as error:  # whatever a foreign class raises where it cannot be pickled
        raise Unreadable(str(error)) from None

    def call_of(number: int, missing: tuple[str, ...]) -> Call:
        candidate = candidates[number]
        payloads = {**candidate.inner, **common.all}
        data = {key: payload.data for key, payload in payloads.items() if key in missing}
        arguments = (data, common.key, tuple(payloads), candidate.data, cutoff)
        return Call(_evaluate_in_worker, arguments)

    judgements: dict[int, Judgement] = {}
    with closing(run_tasks(executor, deque(range(len(rigs))), call_of)) as batches:
        for number, result in chain.from_iterable(batches):
            if isinstance(result, WorkerDied):
                expected = "a worker that survives its task"
                found = f"two that died with {_rig_text(rigs[number])}"
                raise InputError("workers", "process", expected, found)
            judgements[number] = result
    return [judgements[number] for number in range(len(rigs))]


def _evaluate_in_worker(
    data: Mapping[str, bytes], key: str, needed: Sequence[str], candidate: bytes, cutoff: float
) -> Reply[Judgement]:
    """Evaluate a candidate in a worker."""
    try:
        objective = cached_payload(key, data, needed)
        rig = _unpickled(candidate)
    except MissingPayloads as error:
        return Reply(missing=error.keys)
    except Exception as error:  # an unknown class, or whatever its unpickling raises
        return Reply(error=Unreadable(str(error)))
    try:
        return Reply(_reproducible(objective.judge(rig, cutoff), cutoff))
    except Exception as error:
        return Reply(error=error)


def _rig_text(rig: Rig) -> str:
    """Return the sensors of a rig and their positions, for messages."""
    positions = (f"{s.name} at {[round(w, 3) for w in s.pose.position]}" for s in rig)
    return ", ".join(positions)


class Payload:
    """Pickled content, named by a hash of it.

    Parameters
    ----------
    content : object
        A vehicle or a sensor's model inside it becomes a payload of its own, so that objectives
        of one vehicle share it in a worker.

    Attributes
    ----------
    data : bytes
    key : str
        SHA-256 of the data.
    inner : dict of str to Payload
        The payloads that the data refers to, theirs included, by key.
    """

    def __init__(self, content: object) -> None:
        file = io.BytesIO()
        pickler = _Pickler(file, content)
        pickler.dump(content)
        self.data, self.inner = file.getvalue(), pickler.inner
        self.key = hashlib.sha256(self.data).hexdigest()

    @property
    def all(self) -> dict[str, Payload]:
        """The inner payloads and this one, by key; a payload comes after those it refers to."""
        return {**self.inner, self.key: self}


class _Pickler(pickle.Pickler):
    """Pickles content; vehicles and sensors' models inside it become payloads of their own."""

    def __init__(self, file: io.BytesIO, content: object) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._content = content
        self.inner: dict[str, Payload] = {}

    def persistent_id(self, part: Any) -> str | None:
        if part is self._content or not isinstance(part, (Vehicle, SensorModel)):
            return None
        payload = payload_of(part)
        self.inner.update(payload.all)
        return payload.key


class _Unpickler(pickle.Unpickler):
    """Unpickles content; the payloads that it refers to are in the cache."""

    def persistent_load(self, key: Any) -> Any:
        return _cache()[key]


def payload_of(content: Any) -> Payload:
    """Return the payload of something that does not change; it is pickled once."""
    try:
        payload = _PAYLOADS.get(content)
    except TypeError:  # it has no hash, or cannot be referred to weakly
        return Payload(content)
    if payload is None:
        payload = _PAYLOADS[content] = Payload(content)
    return payload


def cached_payload(key: str, data: Mapping[str, bytes], needed: Iterable[str]) -> Any:
    """Return the content of a payload, in a worker.

    Parameters
    ----------
    key : str
    data : mapping of str to bytes
        Payloads that came with the task, each after those that it refers to.
    needed : iterable of str
        Keys of all payloads that the task needs.

    Raises
    ------
    MissingPayloads
        When the worker lacks some of them.
    """
    cache = _cache()
    for new_key, pickled in data.items():
        if new_key not in cache:
            cache[new_key] = _unpickled(pickled)
    if missing := [name for name in needed if name not in cache]:
        raise MissingPayloads(missing)
    for name in needed:
        cache.move_to_end(name)
    content = cache[key]
    while len(cache) > MAX_CACHED:
        cache.popitem(last=False)
    return content


def _unpickled(data: bytes) -> Any:
    return _Unpickler(io.BytesIO(data)).load()


def _cache() -> OrderedDict[str, Any]:
    if not hasattr(_WORKER, "payloads"):
        _WORKER.payloads = OrderedDict()
    payloads: OrderedDict[str, Any] = _WORKER.payloads
    return payloads
