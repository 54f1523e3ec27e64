"""Whole files, read with size limits and written atomically; their lines, numbers, names and CSV.

A spreadsheet computes what begins with ``=``, ``+``, ``-`` or ``@``, and a name may come from
anybody's file. Such a text gets an apostrophe in front (OWASP, "CSV injection"), as does one that
begins with ``#`` and would be a comment; our own readers take it off again.
"""

import codecs
import csv
import io
import math
import os
import re
import secrets
import stat
import time
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from difflib import SequenceMatcher
from pathlib import Path

from .errors import InputError, size_text
from .input_files import note_input, refuse_input

MESH_BYTES = 2 << 30
LABEL_BYTES = 2 << 30
"""Maximum size of a mesh file and of a file of labelled boxes."""
TEXT_BYTES = 16 << 20  # Maximum size of a study, a file of channel angles or a table
UTF_16_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
"""First bytes of a text in UTF-16: spreadsheets save "Unicode text" so."""
MAX_NAME_BYTES = 255
"""Most bytes of a name of a file or folder on the usual file systems."""
CHUNK = 1 << 20
BINARY = getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)
"""Flags of every file that is opened: no line ends changed, no child process inherits it."""
_FILE_TYPES = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
_writing_files: set[object] = set()
"""A mark for each call that is writing files, or `ENDING`."""
ENDING = "ending"
END_WAIT_S = 5.0
END_POLL_S = 0.01
"""How long a process that ends at once waits for a file that a thread is writing."""
NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
"""Each digit can match in one way only: otherwise the time would grow with the square of a text."""
LINES = re.compile(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+")
"""Lines with their ends; at other characters, as U+2028, no file of ours has lines."""
MAX_QUOTE = 40
MARK = "'"
_FORMULA = re.compile(rf"{MARK}*[#=+\-@\t\r\uff1d\uff0b\uff0d\uff20]")
"""Apostrophes count: a text that has one already gets another, so that it can be told apart."""
_NUMBERS = re.compile(rf"{NUMBER.pattern}( {NUMBER.pattern})*", re.ASCII)
MAX_STEM = 100


def read_bytes(path: Path, max_bytes: int = TEXT_BYTES) -> bytes:
    """Return the bytes of a regular file (after following links) of at most `max_bytes`.

    A pipe, a terminal or a device is refused without being opened. A file that grows while it is
    read is read no further than `max_bytes`.

    `InputError` when the file is missing, not a regular file, too large or not readable.
    """
    try:
        _require_regular(path, os.stat(path), "a readable file")
        note_input(path)
        return _read(path, max_bytes)
    except FileNotFoundError as error:
        raise InputError(str(path), "", "", "no such file") from error
    except InputError:
        raise
    except (OSError, ValueError) as error:  # ValueError: no path may hold a NUL
        raise InputError(str(path), "file", "a readable file", reason_of(error)) from error


def named_path(source: object, field: str, text: str) -> Path:
    """Return the path of a file or folder that somebody named, in a name that can be. `InputError`
    when the text is empty, has a NUL, or a name in it has more bytes than file systems take."""
    if not text:
        raise InputError(source, field, "the name of a file or folder", "an empty text")
    longest = max(len(part.encode("utf-8", "surrogatepass")) for part in text.split("/"))
    if longest > MAX_NAME_BYTES or "\0" in text:
        expected = f"names of at most {MAX_NAME_BYTES} bytes, without NUL"
        raise InputError(source, field, expected, f"one of {longest:,} bytes")
    return Path(text)


def require_new(path: Path, *, replace: bool) -> None:
    """Refuse an output that would replace a file unasked: the one rule for files that a user names.

    Whatever has the name counts, a link that leads nowhere, too. (A folder of results has
    `FileSet`, which also replaces what this program wrote there.)

    `replace`: Whether the user has agreed to replace a file of that name.

    `InputError` when there is something of that name, or the command has read it.
    """
    refuse_input(path)
    if os.path.lexists(path) and not replace:
        found = "an existing file" if os.path.exists(path) else "a link that leads nowhere"
        raise InputError(path, "file", "a new file, or --replace", found)


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file atomically: all of `data`, or the old file stays as it was.

    A folder, pipe or device of that name is refused, not replaced. The file is on the disk, not in
    its cache, when the function returns.

    `InputError` when the file cannot be written.
    """
    write_all_bytes({path: data})


def write_all_bytes(files: Mapping[Path, bytes]) -> None:
    """Write several files; if one of them cannot be written, all old files stay as they were.

    A folder, pipe or device of such a name is refused, not replaced. A link to a file stays: the
    file that it leads to is written. All files are on the disk when the function returns.

    `InputError` for the first file that cannot be written.
    """
    # Not the tempfile module: only the owner may read its files, and os.replace keeps that mode.
    files = {_followed(path): data for path, data in files.items()}
    token = secrets.token_hex(4)
    temporaries = {p: p.with_name(f".{token}{number}.tmp") for number, p in enumerate(files)}
    with _before_the_end():
        try:
            for path, data in files.items():
                with _writing(path):
                    if path.exists():
                        _require_regular(path, os.stat(path), "a path that can be written")
                    write_synced(temporaries[path], data)
            put_in_place({temporary: path for path, temporary in temporaries.items()})
        finally:
            for temporary in temporaries.values():
                with suppress(OSError, ValueError):
                    temporary.unlink(missing_ok=True)


def _followed(path: Path) -> Path:
    """Return the file that a link leads to; any other path unchanged."""
    return path.resolve() if path.is_symlink() and path.is_file() else path


def finish_writing() -> None:
    """Wait until no file is being written, and let none begin: the process is about to end."""
    _writing_files.add(ENDING)
    until = time.monotonic() + END_WAIT_S
    while len(_writing_files) > 1 and time.monotonic() < until:
        time.sleep(END_POLL_S)


@contextmanager
def _before_the_end() -> Iterator[None]:
    """Have `finish_writing` wait for what is written; write nothing after it."""
    mark = object()
    _writing_files.add(mark)  # before the look, so that one of the two sees the other
    try:
        while ENDING in _writing_files:
            _writing_files.discard(mark)
            time.sleep(END_WAIT_S)
        yield
    finally:
        _writing_files.discard(mark)


def put_in_place(moves: Mapping[Path, Path]) -> None:
    """Rename whole files, final by temporary path, all of them or none, and wait for the disk. Each
    keeps the permissions of the file that it replaces.

    The files are on the disk, each in the folder of its new name. Where the file system has no hard
    links, a rename that fails leaves the earlier ones. `InputError` when one of them cannot be
    renamed, or would replace an input: the old files are back then.
    """
    for path in moves.values():
        refuse_input(path)
    old: dict[Path, Path] = {}
    new: list[Path] = []
    try:
        for temporary, path in moves.items():
            is_new = not os.path.lexists(path)
            if len(moves) > 1 and not is_new:
                old[path] = temporary.with_name(f"{temporary.name}.old")
                with suppress(OSError):
                    os.link(path, old[path], follow_symlinks=False)
            with _writing(path):
                _keep_mode(temporary, path)
                os.replace(temporary, path)
            new += [path] if is_new else []
    except BaseException:  # Ctrl-C, too
        for path, kept in old.items():
            with suppress(OSError):
                os.replace(kept, path)
        for path in new:
            with suppress(OSError):
                path.unlink()
        raise
    finally:
        for kept in old.values():
            with suppress(OSError):
                kept.unlink(missing_ok=True)
    for folder in {path.parent for path in moves.values()}:
        sync_folder(folder)


def _keep_mode(temporary: Path, path: Path) -> None:
    """Give a file the permissions of the one that it is to replace; a new one has the user's."""
    with suppress(FileNotFoundError):
        status = os.lstat(path)
        if stat.S_ISREG(status.st_mode):
            os.chmod(temporary, stat.S_IMODE(status.st_mode))


def write_synced(path: Path, data: bytes) -> None:
    """Write a file that is on the disk, not in its cache, when the function returns. `OSError` when
    the disk is full or fails."""
    number = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | BINARY, 0o666)
    try:
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(number, rest) :]
        os.fsync(number)
    finally:
        os.close(number)


def sync_file(path: Path) -> None:
    """Have the disk hold a file's bytes before its name counts; a power failure would empty it.
    `OSError` when the disk is full or fails: some file systems tell only here."""
    number = os.open(path, os.O_RDWR | BINARY)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def sync_folder(folder: Path) -> None:
    """Have the disk hold the names of a folder's files. Not all systems can; then nothing is done.
    The files are whole in any case: they were synchronised before they got their names."""
    with suppress(OSError):  # Windows opens no folders, some file systems synchronise none
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Turn an error while writing into an `InputError` that names the file."""
    try:
        yield
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(
            str(path), "file", "a path that can be written", reason_of(error)
        ) from error


def is_binary(data: bytes) -> bool:
    """Whether bytes are no text: one of them is 0, and they do not begin as UTF-16."""
    return b"\0" in data and not data.startswith(UTF_16_MARKS)


def decode_text(data: bytes) -> str:
    """Decode UTF-16 with its mark, UTF-8, or else Latin-1, with every line ending turned into a
    newline."""
    return _decoded(data).replace("\r\n", "\n").replace("\r", "\n")


def _decoded(data: bytes) -> str:
    encoding = "utf-16" if data.startswith(UTF_16_MARKS) else "utf-8-sig"
    try:
        return data.decode(encoding)
    except UnicodeDecodeError:
        return data.decode("latin-1")


def encode_like(text: str, old: bytes) -> bytes:
    """Encode a changed text as UTF-8 with the byte order mark and the line ends of its old file:
    each line that is as before keeps its own, others get those of most lines."""
    before = [_line_and_end(line) for line in LINES.findall(_decoded(old))]
    after = [_line_and_end(line) for line in LINES.findall(text)]
    ends = [end for _, end in before if end]
    usual = max([*ends, "\n"], key=ends.count)
    lines = [line + (end and usual) for line, end in after]
    for block in SequenceMatcher(
        None, [line for line, _ in before], [line for line, _ in after], autojunk=False
    ).get_matching_blocks():
        for number in range(block.size):
            line, end = after[block.b + number]
            lines[block.b + number] = line + (end and (before[block.a + number][1] or usual))
    mark = codecs.BOM_UTF8 if old.startswith(codecs.BOM_UTF8) else b""
    return mark + "".join(lines).encode()


def _line_and_end(line: str) -> tuple[str, str]:
    text = line.rstrip("\r\n")
    return text, line[len(text) :]


def _require_regular(path: Path, status: os.stat_result, expected: str) -> None:
    if not stat.S_ISREG(status.st_mode):
        found = _FILE_TYPES.get(stat.S_IFMT(status.st_mode), "something else")
        raise InputError(str(path), "file", expected, found)


def _read(path: Path, max_bytes: int) -> bytes:
    # Another process may have replaced the file since it was checked: open it such that a pipe
    # does not block and a terminal does not become the controlling one, and check again.
    flags = sum(getattr(os, name, 0) for name in ("O_NONBLOCK", "O_NOCTTY"))
    handle = os.open(path, os.O_RDONLY | flags | BINARY)
    try:
        status = os.fstat(handle)
        _require_regular(path, status, "a readable file")
        _require_size(path, status.st_size, max_bytes)
        data = b"".join(_chunks(handle, status.st_size, max_bytes))
    finally:
        os.close(handle)
    _require_size(path, len(data), max_bytes)
    return data


def _chunks(handle: int, size: int, max_bytes: int) -> Iterator[bytes]:
    """Yield the file in chunks, up to one byte more than `max_bytes`."""
    left = max_bytes + 1
    wanted = size + 1
    while left > 0 and (chunk := os.read(handle, min(left, wanted))):
        yield chunk
        left = left - len(chunk)
        wanted = max(size + 1 - len(chunk), CHUNK)


def _require_size(path: Path, size: int, max_bytes: int) -> None:
    if size > max_bytes:
        expected = f"a file of at most {max_bytes:,} bytes"
        found = size_text(size) if size > max_bytes + 1 else "more"
        raise InputError(str(path), "size", expected, found)


def reason_of(error: OSError | ValueError) -> str:
    """Return why a file cannot be read or written, in a few words of the system's."""
    return str(getattr(error, "strerror", None) or error).lower()


def parse_number(source: str, where: str, what: str, text: str) -> float:
    """Return a finite number of a text; `what` names it in the message."""
    value = float(text) if NUMBER.fullmatch(text) else math.nan
    if not math.isfinite(value):
        expected = f"a finite number, with a decimal point, for {what}"
        raise InputError(source, where, expected, quoted(text))
    return value


def quoted(text: str) -> str:
    """Return a text in quotes and cut short, or ``nothing`` if it is empty."""
    return repr(text[:MAX_QUOTE]) if text else "nothing"


def numbered_lines(text: str) -> list[tuple[int, str]]:
    """Return lines and their numbers from 1, without comments, blank lines and trailing blanks."""
    lines = ((n, raw.split("#", 1)[0].rstrip()) for n, raw in enumerate(text.split("\n"), 1))
    return [(n, line) for n, line in lines if line]


def csv_text(rows: Iterable[Iterable[object]], *, quote_texts: bool = False) -> str:
    """Return rows as CSV: None is an empty cell, texts that look like formulas are marked.
    `quote_texts`: Whether every text is in quotes, not only those that need them."""
    text = io.StringIO()
    if quote_texts:
        writer = csv.writer(text, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC)
    else:
        writer = csv.writer(text, lineterminator="\n")
    writer.writerows([marked(c) if isinstance(c, str) else c for c in row] for row in rows)
    return text.getvalue()


def marked(text: str) -> str:
    """Return a text as a cell: with an apostrophe in front of what looks like a formula or a
    comment."""
    is_formula = _FORMULA.match(text) and not _NUMBERS.fullmatch(text)
    return MARK + text if is_formula else text


def unmarked(cell: str) -> str:
    """Return the text of a cell that `marked` made."""
    return cell[1:] if cell.startswith(MARK) and _FORMULA.match(cell) else cell


def file_stem(name: str, default: str, *, joint: str = "_", max_length: int = MAX_STEM) -> str:
    """Return a name as that of a file, without suffix: ASCII letters, digits, ``-`` and ``_``.
    `default` says what the thing is; it stands for a name without such letters, and `joint` for one
    or several other characters."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    stem = re.sub("[^A-Za-z0-9_-]+" if joint == "_" else "[^A-Za-z0-9]+", joint, plain)
    return stem.strip(joint)[:max_length].strip(joint) or default
