"""`InputError`, the one exception: for wrong input, and for work that takes too much memory.

A message may quote any input, so a quote is cut short and kept on one line, with control characters
escaped.
"""

import os
import reprlib
import sys
from collections.abc import Callable, Container, Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path
from typing import Any

MAX_FOUND_LENGTH = 80  # Maximum characters of a found value in a message
MAX_TEXT_LENGTH = 160
"""Maximum characters of the field and of what was expected: a list of all keys of a table fits."""
MAX_NAMES = 1000
"""Maximum names among which near ones are looked for: a hostile file may have any number."""
CUT = "..."
MANY_DIGITS = 40
"""An integer of more digits is shown by the number of its digits. (Python does not convert an
integer of more than 4,300 digits to text.)"""
LOG10_OF_2 = 0.30102999566398120
MEMINFO = Path("/proc/meminfo")
STATM = Path("/proc/self/statm")
GROUP_LIMITS = (
    Path("/sys/fs/cgroup/memory.max"),
    Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
)
"""Memory limit of a container, in version 2 and version 1 of Linux' control groups."""


class InputError(ValueError):
    """Wrong input, with a message of one line: source, field, what was expected, what was found.

    Parameters
    ----------
    source : object
        Where the input came from: a file's path, or the name of what was passed in.
    field : str
        Which field of it is wrong (``sensor[0].model``), or what was being read; "" for all of it.
    expected : str
        What would have been right; "" where `found` alone says it, as of a file that is missing.
    found : object
        What was there instead: a text that is shown unchanged, or the value itself.
    """

    def __init__(self, source: object, field: str, expected: str, found: object) -> None:
        self.source = str(source)
        self.field = field
        self.expected = expected
        self.found = found
        self._found_text = visible(found) if isinstance(found, str) else _short(found)
        message = _cut(self._found_text, MAX_FOUND_LENGTH)
        if expected:
            message = f"expected {_cut(visible(expected), MAX_TEXT_LENGTH)}, found {message}"
        where = (_middle_cut(visible(self.source)), _cut(visible(field), MAX_TEXT_LENGTH))
        super().__init__(": ".join([*filter(None, where), message]))

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.source, self.field, self.expected, self._found_text)

    def at(self, source: object) -> "InputError":
        """Return the same error with another source, such as the file of the value."""
        return InputError(source, self.field, self.expected, self.found)

    def within(self, source: object, of: str = "") -> "InputError":
        """Return the same error with another source; `of`, else its own, goes before the field."""
        field = ": ".join(filter(None, (of or self.source, self.field)))
        return InputError(source, field, self.expected, self.found)


def shown(value: object) -> str:
    """Return a value as messages quote it: like `repr`, but short, and it never fails."""
    return _cut(_SHORT.repr(value), MAX_FOUND_LENGTH)


def one_of(names: Iterable[object], given: object) -> str:
    """Return what is expected in place of an unknown name: the nearest names come first."""
    known = list(dict.fromkeys(str(name) for name in names))
    lowered = {name.lower(): name for name in known[:MAX_NAMES]}
    wanted = given[:MAX_FOUND_LENGTH].lower() if isinstance(given, str) else ""
    near = get_close_matches(wanted, lowered, cutoff=0.5)
    ordered = list(dict.fromkeys([*(lowered[name] for name in near), *known]))
    if sum(len(name) + 2 for name in ordered) > MAX_TEXT_LENGTH - 20:
        return f"one of {len(known)} names, such as {', '.join(ordered[:3])}"
    if near and len(ordered) > 1:
        return f"{ordered[0]}, or one of {', '.join(ordered[1:])}"
    return f"one of {', '.join(ordered)}" if ordered else "no name at all"


def require_kind(source: object, field: str, value: object, kind: type) -> None:
    """Raise `InputError` for a value that is not of a class."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise InputError(source, field, f"{article} {kind.__name__}", type(value).__name__)


def require_name(source: object, field: str, name: object, names: Iterable[str]) -> None:
    """Raise `InputError` for a name that is none of several."""
    if name not in (known := tuple(names)):
        raise InputError(source, field, one_of(known, name), shown(name))


def require_keys(source: object, of: str, table: Iterable[str], known: Iterable[str]) -> None:
    """Raise `InputError` for the first key of a table, named after `of`, that is not known."""
    for key in sorted(set(map(str, table)).difference(known := sorted(known))):
        raise InputError(source, f"{of}{key}", one_of(known, key), "an unknown key")


def plural(count: float, noun: str) -> str:
    """Return "1 beam", "7 beams", "1,310 pixels"; small fractions have two significant digits."""
    many = "" if count == 1 else "s"
    number = f"{count:,.0f}" if float(count).is_integer() or count >= 100.0 else f"{count:.2g}"
    return f"{number} {noun}{many}"


def visible(text: str) -> str:
    """Return a text with unprintable characters escaped: controls, line ends, text direction."""
    if text.isprintable():
        return text
    shown_part = text[: 10 * MAX_TEXT_LENGTH]
    escaped = (c if c.isprintable() else c.encode("unicode_escape").decode() for c in shown_part)
    return "".join(escaped)


class _Short(reprlib.Repr):
    """`repr` of plain data, cut if long or deeply nested."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel = 3
        self.maxstring = self.maxother = MAX_FOUND_LENGTH

    def repr(self, x: Any) -> str:
        if getattr(x, "ndim", None) == 0 and hasattr(x, "item"):
            x = x.item()  # NumPy 2 would write np.float64(1.0)
        return super().repr(x)

    def repr_int(self, x: int, level: int) -> str:
        digits = int(abs(x).bit_length() * LOG10_OF_2) + 1
        return f"a whole number of {digits:,} digits" if digits > MANY_DIGITS else repr(x)

    def repr_str(self, x: str, level: int) -> str:
        return repr(x[: self.maxstring + 1])

    def repr_instance(self, x: Any, level: int) -> str:
        try:
            text = " ".join(str(x).split()) if isinstance(x, Exception) else repr(x)
        except Exception:  # the repr of a foreign object may fail; the message must not
            return f"an object of type {type(x).__name__}"
        return text


_SHORT = _Short()


def _short(found: object) -> str:
    """Return a value as text: plain data as `shown`, a path or an exception by its `str`."""
    plain = found is None or isinstance(found, (bool, int, float, list, tuple, dict, set, bytes))
    if plain or hasattr(found, "ndim"):
        return visible(shown(found))
    try:
        return visible(" ".join(str(found).split()))
    except Exception:
        return f"an object of type {type(found).__name__}"


def _cut(text: str, longest: int) -> str:
    return text if len(text) <= longest else text[: longest - len(CUT)] + CUT


def _middle_cut(text: str) -> str:
    """Cut a long source in its middle: both ends of a path are of use."""
    if len(text) <= MAX_TEXT_LENGTH:
        return text
    half = (MAX_TEXT_LENGTH - len(CUT)) // 2
    return text[:half] + CUT + text[-half:]


def available_bytes() -> int | None:
    """Return how many bytes this process can still allocate; None where that is unknown."""
    return min(_limits(), default=None)


@contextmanager
def report_memory_errors(source: object) -> Iterator[None]:
    """Turn a `MemoryError` or `RecursionError` into an `InputError` of one line."""
    try:
        yield
    except MemoryError:
        raise InputError(source, "file", "data that fit in memory", "more") from None
    except RecursionError:
        raise InputError(source, "file", "data less deeply nested", "too many levels") from None


def size_text(count: int) -> str:
    """Return a number of bytes with a unit: ``1.2 GB``."""
    if (
        count >= 10**18
    ):  # only a damaged or hostile header says so; it can have any number of digits
        return "more than a million TB"
    for exponent, unit in ((12, "TB"), (9, "GB"), (6, "MB"), (3, "kB")):
        if count >= 10**exponent:
            tenths = count // 10 ** (exponent - 1)
            return f"{tenths // 10:,}.{tenths % 10} {unit}"
    return f"{count} bytes"


def _limits() -> Iterator[int]:
    yield from _free_memory()
    yield from (int(text) for text in map(_content, GROUP_LIMITS) if text.strip().isdecimal())
    if sys.platform != "win32":
        import resource

        limit, _ = resource.getrlimit(resource.RLIMIT_AS)
        used = _content(STATM).split()
        if limit != resource.RLIM_INFINITY and used:
            yield max(0, limit - int(used[0]) * resource.getpagesize())


def _free_memory() -> Iterator[int]:
    """Memory that is free, or that the system can free by dropping its caches."""
    for line in _content(MEMINFO).splitlines():
        if line.startswith("MemAvailable:"):
            yield int(line.split()[1]) * 1024
            return
    if hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        yield os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def _content(path: Path) -> str:
    try:
        return path.read_text("ascii")
    except (OSError, ValueError):
        return ""


@contextmanager
def naming_table(
    source: str, path: str, tables: Container[str] = (), key_of: Callable[[str], str] = str
) -> Iterator[None]:
    """Name a table of a document in errors about what is made of it; errors about the document
    stay as they are.

    Parameters
    ----------
    source : str
        Name of the document.
    path : str
        Key of the table in the document; empty for all of it.
    tables : container of str
        Names of tables inside: an error about one of them names it.
    key_of : callable
        Returns the key of a field.
    """
    try:
        yield
    except InputError as error:
        if error.source == source:
            raise
        own = path.rpartition(".")[2].partition("[")[0]
        key = key_of(error.field.removeprefix(f"{own}."))
        inside = error.source if error.source in tables else ""
        field = ".".join(filter(None, (path, inside, key)))
        raise InputError(source, field, error.expected, error.found) from None
