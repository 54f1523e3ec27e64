"""Streams and signals of a Blender that runs one command and ends."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import tempfile
from collections.abc import Iterator
from typing import TextIO

from ..engine import app


@contextlib.contextmanager
def quiet_blender() -> Iterator[None]:
    """Keep back what Blender and the graphics driver print, unless the work fails."""
    flush(sys.stderr)
    shown = os.dup(2)
    with tempfile.TemporaryFile() as kept:
        os.dup2(kept.fileno(), 1)
        os.dup2(kept.fileno(), 2)
        try:
            yield
        except BaseException:
            with contextlib.suppress(OSError):
                kept.seek(0)
                os.write(shown, kept.read())
            raise
        finally:
            flush(sys.stderr)
            os.dup2(shown, 1)
            os.dup2(shown, 2)
            os.close(shown)


def take_over_process() -> TextIO:
    """Make Ctrl-C Python's and stdout ours; return the stream that results go to.

    Blender prints what it reads, renders and saves on stdout: that goes to stderr from now on.
    Its own handler of Ctrl-C would leave the results behind. A pipe that nobody reads, or a file
    that may not grow, is an error where we write and not the end of the process.
    """
    app.open_missing_streams()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for name in ("SIGPIPE", "SIGXFSZ"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    flush(sys.stdout)
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return out


def flush(stream: TextIO | None) -> None:
    """Hand on what a stream still holds, where it goes anywhere."""
    if stream is not None:
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
