"""Output folders: write a set of files atomically, and never replace a file of the user. Each file
is listed with its SHA-256 in a small file of the folder before it is written. A file that is not
listed, or was changed since, belongs to the user and stays unchanged."""

from __future__ import annotations

import hashlib
import os
import secrets
from collections.abc import Callable, Collection, Iterable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from pe_core.base.errors import InputError
from pe_core.base.files import (
    put_in_place,
    read_bytes,
    reason_of,
    sync_file,
    write_bytes,
    write_synced,
)
from pe_core.base.input_files import not_noting_inputs
from pe_core.base.table_reader import dump_json, parse_json

LISTING = ".perception-entropy.json"
"""Name of the list of our files: ``{"perception-entropy": 1, "files": {name: [SHA-256, ...]}}``."""
PROGRAM = "perception-entropy"
VERSION = 1
DIGESTS_KEPT = 8  # Number of digests listed for each file: those of its latest versions
Write = Callable[[Path], None]
"""Writes a file to the given path, which has the final suffix and is in the final folder."""
Listed = dict[str, list[str]]


def prepare_folder(folder: str | Path, names: Iterable[str] = ()) -> Path:
    """Create the output folder; raise `InputError` early if the results could not be written.

    Each of the named files that will be written must be absent or written by this program.
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
        raise InputError(folder, "output", expected, reason_of(error)) from None
    check_files(folder, names)
    return folder


def check_files(folder: Path, names: Iterable[str], replaceable: Collection[str] = ()) -> None:
    """Check that files may be written: each is absent, or unchanged since this program wrote it.
    Those that are `replaceable` may be replaced in any case. `InputError` where a file with one of
    the names belongs to the user."""
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
    """Context manager that writes several files of one folder together, or none of them. `add`
    writes each file under a temporary name. Leaving the context renames the files in the order in
    which they were added. After an exception the folder stays unchanged. Files with a `replaceable`
    name the user has chosen to replace, whoever wrote them."""

    def __init__(self, folder: Path, replaceable: Collection[str] = ()) -> None:
        self._folder = folder
        self._replaceable = replaceable
        self._made: dict[str, tuple[Path, str]] = {}
        self._unwanted: tuple[str, ...] = ()

    def take_away(self, names: Collection[str]) -> None:
        """Remove files at the end of the context, if they are unchanged files of this program."""
        self._unwanted = tuple(names)

    def add(self, name: str, write: Write | bytes) -> None:
        """Write a file under a temporary name. `InputError` if that fails."""
        path = self._folder / name
        temporary = path.with_name(f".{secrets.token_hex(8)}{path.suffix}")
        self._made[name] = (temporary, "")
        try:
            if isinstance(write, bytes):
                write_synced(temporary, write)
            else:
                write(temporary)
                if temporary.exists():  # Blender may fail to write without an error
                    sync_file(temporary)
        except InputError as error:
            raise error.at(path) from None
        except (OSError, ValueError) as error:
            raise InputError(path, "file", "a path that can be written", reason_of(error)) from None
        digest = sha256_of(temporary)
        if not digest:
            raise InputError(path, "file", "a path that can be written", "nothing was written")
        self._made[name] = (temporary, digest)

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
                self._put()
        except OSError as failed:
            raise InputError(
                self._folder, "output", "a folder that can be written", reason_of(failed)
            ) from None
        finally:
            for temporary, _ in self._made.values():
                _unlink(temporary)

    def _put(self) -> None:
        # A file with the same content is not replaced: a file of the user stays the user's.
        new = {n: made for n, made in self._made.items() if sha256_of(self._folder / n) != made[1]}
        check_files(self._folder, new, self._replaceable)
        # New digests are listed before renaming: both are known if the process is killed.
        listed = _listed(self._folder)
        for name in new:
            listed.setdefault(name, []).append(self._made[name][1])
        recent = {name: digests[-DIGESTS_KEPT:] for name, digests in sorted(listed.items())}
        if new:
            data = {PROGRAM: VERSION, "files": recent}
            write_bytes(self._folder / LISTING, dump_json(data).encode())
        put_in_place({temporary: self._folder / name for name, (temporary, _) in new.items()})
        for name in set(self._unwanted) & set(our_files(self._folder)) - set(self._made):
            _unlink(self._folder / name)


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a regular file in hexadecimal; empty for any other file."""
    try:
        if path.is_symlink() or not path.is_file():  # a pipe would never end
            return ""
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def our_files(folder: Path) -> dict[str, str]:
    """Return the unchanged files of a folder that this program wrote, with their SHA-256."""
    pairs = {name: (sha256_of(folder / name), listed) for name, listed in _listed(folder).items()}
    return {name: digest for name, (digest, listed) in pairs.items() if digest in listed}


@not_noting_inputs()
def _listed(folder: Path) -> Listed:
    """Return the digests of all files that this program wrote to a folder, by name."""
    path = folder / LISTING
    if not os.path.lexists(path):
        return {}
    try:
        data: Any = parse_json(path, read_bytes(path))
        if data[PROGRAM] == VERSION:
            return {str(name): [str(d) for d in digests] for name, digests in data["files"].items()}
    except (AttributeError, KeyError, TypeError, ValueError):
        pass
    expected = "this program's list of the files it wrote here"
    raise InputError(path, "file", expected, "another; remove it, or choose another folder")


def _unlink(path: Path) -> None:
    with suppress(OSError):  # the folder is gone, or may no longer be written
        path.unlink(missing_ok=True)
