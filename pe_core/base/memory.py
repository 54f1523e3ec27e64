"""Available memory, and the refusal of work that needs more."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import InputError

MEMINFO = Path("/proc/meminfo")
STATM = Path("/proc/self/statm")
GROUP_LIMITS = (
    Path("/sys/fs/cgroup/memory.max"),
    Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
)
"""Memory limit of a container, in version 2 and version 1 of Linux' control groups."""


def available_bytes() -> int | None:
    """Return how many bytes this process can still allocate; None where that is unknown."""
    return min(_limits(), default=None)


def require_memory(source: object, field: str, needed: int) -> None:
    """Refuse work that needs more than the available memory.

    `InputError` With the needed and the available memory.
    """
    available = available_bytes()
    if available is not None and needed > available:
        expected = f"what fits in the {size_text(available)} of memory that are free"
        raise InputError(source, field, expected, f"about {size_text(needed)}")


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
