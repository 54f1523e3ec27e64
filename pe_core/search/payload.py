"""The payload of a search: what its tasks have in common, sent to every worker once.

Our own processes get it by their initializer, the workers of a Dask client by a plugin; to others
it comes with every task. Each worker unpickles it once.
"""

import hashlib
import io
import pickle
from collections.abc import Iterable
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cache
from typing import Any
from weakref import WeakKeyDictionary

from ..base.lazy_threads import threads
from ..base.plugins import optional_package

MAX_OBJECTS = 12
"""How many objects an executor's payload grows to, as further objectives are evaluated."""
_SENT: "WeakKeyDictionary[Executor, SentPayload]" = WeakKeyDictionary()
"""The payload that the workers of each executor have."""
_INITIAL: dict[str, bytes] = {}
"""In a worker: the payloads that came before their tasks, by key."""
MAX_PAYLOADS = 4
"""How many of them a worker of a cluster keeps: several searches may share it."""


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

    payload: "Payload"
    argument: PackedPayload


class Payload:
    """Objects that tasks have in common, pickled together: what they share is sent once. The
    objects must not change; `Unreadable` is raised for one that cannot be pickled."""

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
    """Send objects to all workers of an executor, unless they have them. Raises `Unreadable` when
    an object cannot be pickled."""
    sent = _SENT.get(executor)
    needed = {id(part): part for part in objects}
    if sent is None or not sent.payload.covers(needed.values()):
        earlier = () if sent is None else sent.payload.objects
        both = {id(part): part for part in earlier} | needed  # levels of a search take turns
        payload = Payload((both if len(both) <= MAX_OBJECTS else needed).values())
        sent = _SENT[executor] = SentPayload(payload, _argument(executor, payload.packed))
    return sent


def _argument(executor: Any, packed: PackedPayload) -> PackedPayload:
    """Send a payload in the way of the executor; return the argument that refers to it."""
    if hasattr(executor, "start_with"):  # `Processes`
        executor.start_with(packed.key, packed.data)
    elif (client := getattr(executor, "_client", None)) is not None:  # of Dask
        client.register_plugin(_plugin(packed), plugin_name(client))
    else:
        return packed
    return PackedPayload(packed.key)


def plugin_name(client: Any) -> str:
    """Return the name of the plugin of a Dask client: of this name the newest alone stays."""
    return f"payload of {client.id}"


def _plugin(packed: PackedPayload) -> Any:
    """Return a plugin that brings a payload to each worker of a cluster, to later ones, too. As an
    argument that tasks depend on it would be sent many times: every two seconds Dask's memory
    manager drops all copies but one."""
    distributed = optional_package("distributed")
    assert distributed is not None, "a client of Dask asks for it"

    class PayloadPlugin(distributed.WorkerPlugin):  # type: ignore[name-defined,misc]
        """Has a worker keep a payload, and freed memory."""

        def setup(self, worker: Any) -> None:
            """Called in each worker, before its first task if it joins later."""
            threads().keep_freed_memory()
            receive(packed.key, packed.data)

    return PayloadPlugin()


def receive(key: str, data: bytes) -> None:
    """Keep a payload that comes before its tasks; of several the newest ones."""
    _INITIAL[key] = data
    while len(_INITIAL) > MAX_PAYLOADS:
        del _INITIAL[next(iter(_INITIAL))]


@cache
def _worker() -> Any:
    """Return the payload that this worker has unpickled, and its key. Threads share none of it, so
    that no thread waits for another."""
    return threads().local()


def unpickled(packed: PackedPayload, content: bytes) -> Any:
    """Return content that refers to a payload, in a worker. Raises `Unreadable` when the worker
    lacks the payload, or does not know a class of it."""
    try:
        worker = _worker()
        if getattr(worker, "key", None) != packed.key:
            data = packed.data or _INITIAL[packed.key]
            worker.objects = pickle.loads(data)
            worker.key = packed.key
        return _Unpickler(io.BytesIO(content)).load()
    except Exception as error:  # whatever unpickling raises
        raise Unreadable(str(error)) from None


def _pickled(content: object, numbers: dict[int, int]) -> bytes:
    file = io.BytesIO()
    pickler = _Pickler(file, protocol=pickle.HIGHEST_PROTOCOL)
    pickler.numbers = numbers
    try:
        pickler.dump(content)
    except Exception as error:  # whatever a foreign class raises where it cannot be pickled
        raise Unreadable(str(error)) from None
    return file.getvalue()


class _Pickler(pickle.Pickler):
    """Pickles content; objects with a number are referred to by it."""

    numbers: dict[int, int]

    def persistent_id(self, part: object) -> int | None:
        return self.numbers.get(id(part))


class _Unpickler(pickle.Unpickler):
    """Unpickles content that refers to objects of this worker's payload by number."""

    def persistent_load(self, number: Any) -> Any:
        return _worker().objects[number]
