"""What the two sides send each other, and how large objects are sent once. A request is pickled. An
object of a type that is shared stands in it as a number; it comes, pickled itself, with the first
request that refers to it. Its arrays are sent as they are in memory."""

import io
import os
import pickle
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pickle import PickleBuffer
from struct import pack
from typing import Any, NamedTuple

# Answers: what a job yields, a result, and an error
STEP = "step"
DONE = "done"
FAILED = "failed"
CANCEL = "cancel"
FORGET = "forget"
SET_UP = "set up"
"""Besides requests: end a topic's job at its next step; forget objects by their numbers; call a
function before later requests are taken."""


CAN_QUEUE = os.name == "posix"
MAX_SHORT = 0x7FFFFFFF
"""Frames of more bytes have a longer head [bytes]."""
WRITE_BYTES = 1 << 20
PAUSE_S = 0.0002
"""How much is written at a time [bytes], and how long a full pipe is left to the other side."""


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


class Writer:
    """Sends messages without waiting for the other side: what the pipe has no room for waits here,
    until `flush` is called again. (Windows' pipes of `multiprocessing` have no such mode: there a
    message waits until the other side takes it.)"""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._waiting: deque[memoryview] = deque()
        if CAN_QUEUE:
            os.set_blocking(connection.fileno(), False)

    @property
    def is_waiting(self) -> bool:
        """Whether something is not sent yet."""
        return bool(self._waiting)

    def put(self, message: object) -> None:
        """Send a message: first how many arrays of shared objects follow it. Arrays must not change
        until they are sent. `OSError` where the other side is gone."""
        arrays: list[PickleBuffer] = []
        data = pickle.dumps(message, pickle.HIGHEST_PROTOCOL, buffer_callback=arrays.append)
        parts = [memoryview(pickle.dumps((len(arrays), data))), *(each.raw() for each in arrays)]
        for part in parts:
            if CAN_QUEUE:
                self._waiting += [memoryview(_frame_head(part.nbytes)), part]
            else:
                self._connection.send_bytes(part)
        self.flush()

    def flush(self, patience_s: float = 0.0) -> None:
        """Send what the pipe has room for; as the other side reads, go on for so long. `OSError`
        where it is gone."""
        until = time.monotonic() + patience_s
        while self._waiting:
            try:
                sent = os.write(self._connection.fileno(), self._waiting[0][:WRITE_BYTES])
            except BlockingIOError:
                if time.monotonic() >= until:
                    return
                time.sleep(PAUSE_S)
                continue
            rest = self._waiting.popleft()[sent:]
            if rest:
                self._waiting.appendleft(rest)

    def close(self) -> None:
        """Close the connection; what is not sent is dropped."""
        self._waiting.clear()
        self._connection.close()


def _frame_head(size: int) -> bytes:
    """Return what `multiprocessing.Connection` writes before so many bytes."""
    return pack("!i", size) if size <= MAX_SHORT else pack("!iQ", -1, size)


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
    file = io.BytesIO()
    aside = None if arrays is None else arrays.append
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
