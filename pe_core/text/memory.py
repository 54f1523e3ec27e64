"""How much memory there is, so that work that cannot fit is refused before it begins."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import InputError

MEMINFO = Path("/proc/meminfo")
STATM = Path("/proc/self/statm")
GROUP_LIMITS = (
    Path("/sys/fs/cgroup/memory.max"),
    Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
)
"""What a container may use, in either generation of Linux' control groups."""


def available_bytes() -> int | None:
    """Return how much more memory this process can have, None where the system does not tell."""
    return min(_limits(), default=None)


def require_memory(source: object, field: str, needed: int) -> None:
    """Refuse work that takes `needed` bytes when there are not so many.

    Raises
    ------
    InputError
        One line with how much it takes and how much there is.
    """
    there = available_bytes()
    if there is not None and needed > there:
        expected = f"what fits in the {size_text(there)} of memory that are free"
        raise InputError(source, field, expected, f"about {size_text(needed)}")


@contextmanager
def told_if_too_much(source: object) -> Iterator[None]:
    """Tell in one line what no look ahead foresaw: no memory left, or data nested too deep."""
    try:
        yield
    except MemoryError:
        raise InputError(source, "file", "data that fit in memory", "more") from None
    except RecursionError:
        raise InputError(source, "file", "data less deeply nested", "too many levels") from None


def size_text(count: int) -> str:
    """A number of bytes as people say it: ``1.2 GB``."""
    if count >= 10**18:  # such counts stand in hostile headers alone, and can be any length
        return "more than a million TB"
    for exponent, unit in ((12, "TB"), (9, "GB"), (6, "MB"), (3, "kB")):
        if count >= 10**exponent:
            tenths = count // 10 ** (exponent - 1)
            return f"{tenths // 10:,}.{tenths % 10} {unit}"
    return f"{count} bytes"


def _limits() -> Iterator[int]:
    yield from _free()
    yield from (int(text) for text in map(_text, GROUP_LIMITS) if text.strip().isdecimal())
    yield from _address_space()


def _free() -> Iterator[int]:
    """Memory that is free or can be had by dropping caches."""
    for line in _text(MEMINFO).splitlines():
        if line.startswith("MemAvailable:"):
            yield int(line.split()[1]) * 1024
            return
    if hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        yield os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def _address_space() -> Iterator[int]:
    """What is left of the limit that `ulimit -v` sets."""
    if sys.platform != "win32":
        import resource

        limit, _ = resource.getrlimit(resource.RLIMIT_AS)
        used = _text(STATM).split()
        if limit != resource.RLIM_INFINITY and used:
            yield max(0, limit - int(used[0]) * resource.getpagesize())


def _text(path: Path) -> str:
    try:
        return path.read_text("ascii")
    except (OSError, ValueError):
        return ""
