"""The one rule for outputs and inputs: no output replaces a file that the same command has read.

A command notes its inputs: every file that is read is one, whichever verb or option named it. What
writes a file asks `refuse_input` first.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import InputError

FileId = tuple[int, int]
"""Device and number of a file: the same for all of its names."""
_noted: list[set[FileId] | None] = []
"""The inputs of each command that runs; files are noted in the last one, unless that is None."""


@contextmanager
def noting_inputs() -> Iterator[None]:
    """Note all files that are read within as inputs of one command."""
    with _noting_in(set()):
        yield


@contextmanager
def not_noting_inputs() -> Iterator[None]:
    """Note no file that is read within: it is read to be changed, or to be continued."""
    with _noting_in(None):
        yield


@contextmanager
def _noting_in(inputs: set[FileId] | None) -> Iterator[None]:
    _noted.append(inputs)
    try:
        yield
    finally:
        _noted.pop()


def note_input(path: str | Path) -> None:
    """Note a file as an input, where inputs are noted."""
    with suppress(OSError, ValueError):
        status = os.stat(path)
        if _noted and (inputs := _noted[-1]) is not None:
            inputs.add((status.st_dev, status.st_ino))


def refuse_input(path: str | Path) -> None:
    """Raise `InputError` where an output would replace an input of the command."""
    try:
        status = os.stat(path)
    except (OSError, ValueError):  # there is no such file
        return
    if any((status.st_dev, status.st_ino) in inputs for inputs in _noted if inputs):
        raise InputError(path, "file", "another file than the input", "the input")
