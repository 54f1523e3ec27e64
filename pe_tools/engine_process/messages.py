"""What the two sides send each other, and how large objects are sent once.

A request is pickled. An object of a type that is shared stands in it as a number; it comes, pickled
itself, with the first request that refers to it.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

STEP, DONE, FAILED = "step", "done", "failed"
"""Answers: what a job yields, a result, and an error."""
CANCEL, FORGET, SET_UP = "cancel", "forget", "set up"
"""Besides requests: end a topic's job at its next step; forget objects by their numbers; call a
function before later requests are taken."""


@dataclass(frozen=True, slots=True)
class Request:
    """A function and its arguments, pickled, and the shared objects that come with them.

    `number` rises with each request. Requests of one `lane` run one after the other.
    """

    number: int
    topic: str
    lane: str
    call: bytes
    shared: Mapping[int, bytes]


def packed(content: object, number_of: Callable[[object], int | None]) -> bytes:
    """Pickle content; objects with a number are referred to by it."""
    file = io.BytesIO()
    pickler = _Packer(file, pickle.HIGHEST_PROTOCOL)
    pickler.persistent_id = number_of  # type: ignore[method-assign]
    pickler.dump(content)
    return file.getvalue()


def unpacked(data: bytes, object_of: Callable[[int], Any]) -> Any:
    """Return what was packed; numbers become objects again."""
    unpickler = _Unpacker(io.BytesIO(data))
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
