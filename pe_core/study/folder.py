"""Folders that results are written to: a set of files at once, and over no file of a user's own.

What we write is listed with its SHA-256 in a small file of the folder, before it is written. A file
that is not listed, or that has been changed since, is somebody's own and stays as it is.
"""

from __future__ import annotations

import hashlib
import json
import os
import secrets
import time
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from ..errors import InputError
from ..text.files import read_bytes, write_bytes
from ..text.json_text import dump_json
from .older_folder import files_of_0_1

try:
    import fcntl
except ImportError:  # on Windows two runs into one folder may refuse each other's files
    fcntl = None  # type: ignore[assignment]

LISTING = ".perception-entropy.json"
"""Name of the list of our files: ``{"perception-entropy": 1, "files": {name: [SHA-256, ...]}}``."""
PROGRAM, VERSION = "perception-entropy", 1
DIGESTS_KEPT = 8
"""Of each file: of the last times that it was written."""
LOCK_TRIES, LOCK_PAUSE_S = 200, 0.01
"""How long to wait for another run that writes to the folder: it does so for milliseconds."""
Write = Callable[[Path], None]
"""Writes a file to the path it is given, which has the right suffix and is in the right folder."""
Listed = dict[str, list[str]]


def prepare_folder(folder: str | Path, names: Iterable[str] = ()) -> Path:
    """Make the output folder, or raise `InputError` now rather than after the work is done.

    Parameters
    ----------
    folder : path
    names : iterable of str
        Files that will be written to it; each must not be there yet, or be ours.

    Raises
    ------
    InputError
        The folder cannot be made or written to, or a file in it is somebody else's.
    """
    if not str(folder):
        raise InputError("command line", "output", "the name of a folder", "an empty text")
    folder = Path(folder)
    probe = folder / f".{secrets.token_hex(8)}.tmp"  # never the name of a user's own file
    try:
        folder.mkdir(parents=True, exist_ok=True)
        try:
            probe.touch(exist_ok=False)
        finally:
            probe.unlink(missing_ok=True)
    except OSError as error:
        expected = "a folder that can be written"
        raise InputError(folder, "output", expected, _reason(error)) from None
    check_files(folder, names)
    return folder


def check_files(folder: Path, names: Iterable[str], replaceable: Collection[str] = ()) -> None:
    """Raise `InputError` for the first of these files that is there and is not ours."""
    listed = _listed(folder)
    for name in names:
        path = folder / name
        if name in replaceable and not path.is_dir():
            continue
        if os.path.lexists(path) and sha256_of(path) not in listed.get(name, ()):
            expected = "no file, or one that was written here by this program and not changed since"
            found = "another; it stays as it is, choose another folder or name"
            raise InputError(path, "output", expected, found)


class FileSet:
    """Files of one folder that appear together, or not at all.

    A context: `add` writes each file beside its place; leaving the context puts them there in the
    order in which they were added. Leaving it by an exception leaves the folder as it was.

    Parameters
    ----------
    folder : path
    replaceable : collection of str
        Names of files that the user has chosen to replace, whoever wrote them.
    """

    def __init__(self, folder: Path, replaceable: Collection[str] = ()) -> None:
        self._folder, self._replaceable = folder, replaceable
        self._made: dict[str, tuple[Path, str]] = {}
        self._unwanted: tuple[str, ...] = ()

    def take_away(self, names: Collection[str]) -> None:
        """Have files gone once the set is there: those that are ours and that nobody changed."""
        self._unwanted = tuple(names)

    def add(self, name: str, write: Write | bytes) -> str:
        """Write a file beside its place; return its SHA-256."""
        path = self._folder / name
        temporary = path.with_name(f".{path.stem}.{secrets.token_hex(4)}{path.suffix}")
        self._made[name] = (temporary, "")
        try:
            if isinstance(write, bytes):
                temporary.write_bytes(write)
            else:
                write(temporary)
        except InputError as error:
            raise error.at(path) from None
        except (OSError, ValueError) as error:
            raise InputError(path, "file", "a place to write to", _reason(error)) from None
        digest = sha256_of(temporary)
        if not digest:  # Blender may write nothing and say nothing
            raise InputError(path, "file", "a place to write to", "that nothing was written")
        self._made[name] = (temporary, digest)
        return digest

    def __enter__(self) -> FileSet:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            if kind is None:
                with _alone_in(self._folder):
                    self._put()
        except OSError as failed:
            raise InputError(
                self._folder, "output", "a folder that can be written", _reason(failed)
            ) from None
        finally:
            for temporary, _ in self._made.values():
                _unlink(temporary)

    def _put(self) -> None:
        # The same bytes are left alone: nothing is lost, and what is a user's own stays his own.
        new = {n: made for n, made in self._made.items() if sha256_of(self._folder / n) != made[1]}
        check_files(self._folder, new, self._replaceable)
        self._list(new)
        for name, (temporary, _) in new.items():
            os.replace(temporary, self._folder / name)
        for name in set(self._unwanted) & set(our_files(self._folder)) - set(self._made):
            _unlink(self._folder / name)

    def _list(self, new: Collection[str]) -> None:
        """List the files before they are there: if we are killed meanwhile, both are ours."""
        listed = _listed(self._folder)
        for name in new:
            listed.setdefault(name, []).append(self._made[name][1])
        recent = {name: known[-DIGESTS_KEPT:] for name, known in sorted(listed.items())}
        data = {PROGRAM: VERSION, "files": recent}
        if new:
            write_bytes(self._folder / LISTING, dump_json(data).encode())


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Let no other run list and replace files of the folder meanwhile.

    It is asked for a moment only: who holds it has been stopped, or the system has no such thing.
    """
    if fcntl is None:
        yield
        return
    number = os.open(folder, os.O_RDONLY)
    try:
        for _ in range(LOCK_TRIES):
            with suppress(OSError):
                fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            time.sleep(LOCK_PAUSE_S)
        yield
    finally:
        os.close(number)


def sha256_of(path: Path) -> str:
    """SHA-256 of a regular file in hexadecimal; empty for anything else, or what cannot be read."""
    try:
        if path.is_symlink() or not path.is_file():  # a pipe would never end
            return ""
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def our_files(folder: Path) -> dict[str, str]:
    """Files of a folder that we wrote and nobody changed since, with their SHA-256."""
    found = {name: (sha256_of(folder / name), known) for name, known in _listed(folder).items()}
    return {name: digest for name, (digest, known) in found.items() if digest in known}


def _listed(folder: Path) -> Listed:
    """Return what we ever wrote here, by name."""
    path = folder / LISTING
    if not os.path.lexists(path):
        return files_of_0_1(folder, sha256_of)
    try:
        data: Any = json.loads(read_bytes(path))
        if data[PROGRAM] == VERSION:
            return {str(name): [str(d) for d in known] for name, known in data["files"].items()}
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError):
        pass
    expected = "this program's list of the files it wrote here"
    raise InputError(path, "file", expected, "another; remove it, or choose another folder")


def _unlink(path: Path) -> None:
    with suppress(OSError):  # the folder is gone, or may no longer be written
        path.unlink(missing_ok=True)


def _reason(error: OSError | ValueError) -> str:
    return str(getattr(error, "strerror", None) or error).lower()
