"""Progress of a job on stderr: a bar with the time left on a terminal, lines in a log."""

from __future__ import annotations

import time
from typing import Any, Protocol, TextIO

from pe_core.base.plugins import optional_package

from ..jobs import Progress
from .terminal import is_terminal, show

REPORT_EVERY_S = {True: 0.2, False: 5.0}
"""How often progress is shown: on a terminal, where it overwrites itself, and in a log."""
BAR = "{desc} {percentage:3.0f}% |{bar:24}| {elapsed}<{remaining}{postfix}"
"""Time gone and time left stand behind the bar."""


class Display(Protocol):
    """Shows the progress of a job, and removes it at the end."""

    def show(self, progress: Progress, new_stage: bool) -> None:
        """Show the progress; `new_stage` is True at the first call for a stage."""

    def clear(self) -> None:
        """Remove an incomplete line."""


class Reporter:
    """Reports the progress of a job. Errors of the stream are ignored."""

    def __init__(self, stream: TextIO | None) -> None:
        on_terminal = is_terminal(stream)
        self._pause_s = REPORT_EVERY_S[on_terminal]
        self._display = _display(Sure(stream), on_terminal)
        self._reported, self._stage = 0.0, ""

    def report(self, progress: Progress) -> None:
        """Show the progress for a new stage, or if the last report is old enough."""
        now, new_stage = time.monotonic(), progress.stage != self._stage
        if now - self._reported < self._pause_s and not new_stage:
            return
        self._reported, self._stage = now, progress.stage
        self._display.show(progress, new_stage)

    def clear(self) -> None:
        """Remove an incomplete line."""
        self._display.clear()


def _display(stream: Sure, on_terminal: bool) -> Display:
    if not on_terminal:
        return LogLines(stream)
    tqdm = optional_package("tqdm")
    return OneLine(stream) if tqdm is None else Bar(stream, tqdm)


class Sure:
    """A stream without errors: after the first failed write, it discards all text."""

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self.encoding = getattr(stream, "encoding", None) or "utf-8"

    def write(self, text: str) -> int:
        """Write text; discard it after an error."""
        if show(text, self._stream) is not None:
            self._stream = None
        return len(text)

    def flush(self) -> None:
        """Do nothing: `write` flushes."""

    def isatty(self) -> bool:
        """Whether the stream is an interactive terminal."""
        return is_terminal(self._stream)

    def fileno(self) -> int:
        """Return the file descriptor, from which tqdm reads the width of the terminal."""
        if self._stream is None:
            raise OSError("no stream")
        return self._stream.fileno()


class LogLines:
    """A line each time, for a log or a pipe."""

    def __init__(self, stream: Sure) -> None:
        self._stream = stream

    def show(self, progress: Progress, new_stage: bool) -> None:
        """Write a line."""
        self._stream.write(f"{_text(progress)}\n")

    def clear(self) -> None:
        """Lines stay."""


class OneLine:
    """A line that overwrites itself, for a terminal without a progress library."""

    def __init__(self, stream: Sure) -> None:
        self._stream = stream

    def show(self, progress: Progress, new_stage: bool) -> None:
        """Overwrite the line."""
        self._stream.write(f"\r\x1b[K{_text(progress)}")

    def clear(self) -> None:
        """Remove the line."""
        self._stream.write("\r\x1b[K")


class Bar:
    """A bar with the time gone and the time left, for a terminal, by tqdm."""

    def __init__(self, stream: Sure, tqdm: Any) -> None:
        tqdm.tqdm.monitor_interval = 0  # no monitor thread: progress is reported often enough
        self._tqdm, self._stream = tqdm, stream
        self._bar: Any = None

    def show(self, progress: Progress, new_stage: bool) -> None:
        """Update the bar; a new stage gets a new bar and a new clock."""
        if new_stage:
            self.clear()
        if self._bar is None:
            self._bar = self._tqdm.tqdm(
                total=1.0, file=self._stream, bar_format=BAR, leave=False, dynamic_ncols=True
            )
        self._bar.set_description_str(progress.stage, refresh=False)
        if progress.entropy is not None:
            self._bar.set_postfix_str(progress.value_text, refresh=False)
        self._bar.update(max(0.0, min(1.0, progress.fraction) - self._bar.n))
        self._bar.refresh()

    def clear(self) -> None:
        """Remove the line."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def _text(progress: Progress) -> str:
    value = progress.value_text
    return f"{progress.stage} {progress.fraction:4.0%}{'  ' if value else ''}{value}"
