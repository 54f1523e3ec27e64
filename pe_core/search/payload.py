"""The payload of a search: what its tasks have in common, sent to every worker once.

Executors with a method `start_with` bring it to their workers: our own processes by their
initializer, the cluster of ``pe --scheduler`` by a plugin. An executor of Dask without it has the
client scatter it. To workers of others it comes with every task. Each worker unpickles it once.
"""

from __future__ import annotations

import hashlib
import io
import pickle
import threading
from collections.abc import Iterable
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

MAX_OBJECTS = 12
"""How many objects an executor's payload grows to, as further objectives are evaluated."""

_SENT: WeakKeyDictionary[Executor, SentPayload] = WeakKeyDictionary()
"""The payload that the workers of each executor have."""
_INITIAL: dict[str, bytes] = {}
"""In a worker: the payloads that came before their tasks, by key."""
MAX_PAYLOADS = 4
"""How many of them a worker of a cluster keeps: several searches may share it."""
_WORKER = threading.local()
"""The payload that this worker has unpickled, and its key. Threads share none of it, so that no
thread waits for another."""


class Unreadable(TypeError):
    """An objective or a rig cannot be pickled, or a worker cannot unpickle it."""


@dataclass(frozen=True, slots=True)
class PackedPayload:
    """A payload as tasks bring it: named by a hash; no data where the worker has it already."""

    key: str
    data: bytes = b""


@dataclass(frozen=True, slots=True)
class SentPayload:
    """A payload, and the argument by which tasks refer to it on one executor."""

    payload: Payload
    argument: Any


class Payload:
    """Objects that tasks have in common, pickled together: what they share is sent once.

    Parameters
    ----------
    objects : iterable
        They must not change.

    Raises
    ------
    Unreadable
        When an object cannot be pickled.
    """

    def __init__(self, objects: Iterable[object]) -> None:
        self.objects = tuple(objects)
        self._numbers = {id(part): number for number, part in enumerate(self.objects)}
        data = _pickled(self.objects, {})
        self.packed = PackedPayload(hashlib.sha256(data).hexdigest(), data)

    def covers(self, objects: Iterable[object]) -> bool:
        """Whether it has all of these objects."""
        return all(id(part) in self._numbers for part in objects)

    def pickled(self, content: object) -> bytes:
        """Return pickled content; its parts that are in the payload are referred to by number."""
        return _pickled(content, self._numbers)


def send_payload(executor: Executor, objects: Iterable[object]) -> SentPayload:
    """Send objects to all workers of an executor, unless they have them.

    Raises
    ------
    Unreadable
        When an object cannot be pickled.
    """
    sent, needed = _SENT.get(executor), {id(part): part for part in objects}
    if sent is None or not sent.payload.covers(needed.values()):
        earlier = () if sent is None else sent.payload.objects
        both = {id(part): part for part in earlier} | needed  # levels of a search take turns
        payload = Payload((both if len(both) <= MAX_OBJECTS else needed).values())
        sent = _SENT[executor] = SentPayload(payload, _argument(executor, payload.packed))
    return sent


def _argument(executor: Any, packed: PackedPayload) -> Any:
    """Send a payload in the way of the executor; return the argument that refers to it."""
    if hasattr(executor, "start_with"):  # `Processes`, for example
        executor.start_with(packed.key, packed.data)
        return PackedPayload(packed.key)
    scatter = getattr(getattr(executor, "_client", None), "scatter", None)
    if scatter is None:
        return packed
    try:
        return scatter([packed], broadcast=True, hash=False)[0]
    except Exception:  # a cluster without workers, for example: whoever joins gets it with its task
        return packed


def receive(key: str, data: bytes) -> None:
    """Keep a payload that comes before its tasks; of several the newest ones."""
    _INITIAL[key] = data
    while len(_INITIAL) > MAX_PAYLOADS:
        del _INITIAL[next(iter(_INITIAL))]


def unpickled(packed: PackedPayload, content: bytes) -> Any:
    """Return content that refers to a payload, in a worker.

    Raises
    ------
    Unreadable
        When the worker lacks the payload, or knows a class of it not.
    """
    try:
        if getattr(_WORKER, "key", None) != packed.key:
            data = packed.data or _INITIAL[packed.key]
            _WORKER.objects, _WORKER.key = pickle.loads(data), packed.key
        return _Unpickler(io.BytesIO(content)).load()
    except Exception as error:  # whatever unpickling raises
        raise Unreadable(str(error)) from None


def _pickled(content: object, numbers: dict[int, int]) -> bytes:
    file = io.BytesIO()
    try:
        _Pickler(file, numbers).dump(content)
    except Exception as error:  # whatever a foreign class raises where it cannot be pickled
        raise Unreadable(str(error)) from None
    return file.getvalue()


class _Pickler(pickle.Pickler):
    """Pickles content; objects with a number are referred to by it."""

    def __init__(self, file: io.BytesIO, numbers: dict[int, int]) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._numbers = numbers

    def persistent_id(self, part: object) -> int | None:
        return self._numbers.get(id(part))


class _Unpickler(pickle.Unpickler):
    """Unpickles content that refers to objects of this worker's payload by number."""

    def persistent_load(self, number: Any) -> Any:
        return _WORKER.objects[number]
