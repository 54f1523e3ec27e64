"""What the two sides send each other, and how large objects are sent once. A request is pickled. An
object of a type that is shared stands in it as a number; it comes, pickled itself, with the first
request that refers to it. Its arrays are sent as they are in memory."""

import io
import pickle
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pickle import PickleBuffer
from typing import Any, NamedTuple

STEP, DONE, FAILED = "step", "done", "failed"  # Answers: what a job yields, a result, and an error
CANCEL, FORGET, SET_UP = "cancel", "forget", "set up"
"""Besides requests: end a topic's job at its next step; forget objects by their numbers; call a
function before later requests are taken."""


class PackedObject(NamedTuple):
    """A shared object, pickled, and its arrays."""

    data: bytes
    arrays: list[PickleBuffer]


@dataclass(frozen=True, slots=True)
class Request:
    """A function and its arguments, pickled, and the shared objects that come with them. `number`
    rises with each request. Requests of one `lane` run one after the other."""

    number: int
    topic: str
    lane: str
    call: bytes
    shared: Mapping[int, PackedObject]


def send(connection: Connection, message: object) -> None:
    """Send a message: first how many arrays of shared objects follow it."""
    arrays: list[PickleBuffer] = []
    data = pickle.dumps(message, pickle.HIGHEST_PROTOCOL, buffer_callback=arrays.append)
    connection.send_bytes(pickle.dumps((len(arrays), data)))
    for each in arrays:
        connection.send_bytes(each.raw())


def received(connection: Connection) -> Any:
    """Return the next message; arrays in it can only be read."""
    count, data = pickle.loads(connection.recv_bytes())
    return pickle.loads(data, buffers=[connection.recv_bytes() for _ in range(count)])


def packed(
    content: object,
    number_of: Callable[[object], int | None],
    arrays: list[PickleBuffer] | None = None,
) -> bytes:
    """Pickle content; objects with a number are referred to by it, arrays put into a list."""
    file, aside = io.BytesIO(), None if arrays is None else arrays.append
    pickler = _Packer(file, pickle.HIGHEST_PROTOCOL, buffer_callback=aside)
    pickler.persistent_id = number_of  # type: ignore[method-assign]
    pickler.dump(content)
    return file.getvalue()


def unpacked(data: bytes, object_of: Callable[[int], Any], arrays: Iterable[Any] = ()) -> Any:
    """Return what was packed; numbers become objects again."""
    unpickler = _Unpacker(io.BytesIO(data), buffers=arrays)
    unpickler.persistent_load = object_of  # type: ignore[method-assign]
    return unpickler.load()


def steps_of(found: object) -> Iterator[tuple[str, Any]]:
    """Yield the steps of a job, and its result; the result alone of what is no iterator."""
    while isinstance(found, Iterator):
        try:
            step = next(found)
        except StopIteration as end:
            found = end.value
        else:
            yield STEP, step
    yield DONE, found


class _Packer(pickle.Pickler):
    """Has a dictionary, for `persistent_id`."""


class _Unpacker(pickle.Unpickler):
    """Has a dictionary, for `persistent_load`."""
