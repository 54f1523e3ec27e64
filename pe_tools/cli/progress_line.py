"""Progress of a job on stderr: a bar with the time left on a terminal, lines in a log.

Of a stage that takes long, one line tells the time left, as soon as its progress shows it.
"""

from __future__ import annotations

import time
from typing import Any, Protocol, TextIO

from pe_core.base.plugins import optional_package

from ..jobs import Progress
from .terminal import is_terminal, show

REPORT_EVERY_S = {True: 0.2, False: 5.0}
"""How often progress is shown: on a terminal, where it overwrites itself, and in a log."""
ESTIMATE_AFTER_S, LONG_S = 3.0, 20.0
"""How long a stage runs before its time is estimated; more time left than that is told."""
BAR = "{desc} {percentage:3.0f}% |{bar:24}| {elapsed}<{remaining}{postfix}"
"""Time gone and time left stand behind the bar."""


class Display(Protocol):
    """Shows the progress of a job, and removes it at the end."""

    def show(self, progress: Progress, new_stage: bool) -> None:
        """Show the progress; `new_stage` is True at the first call for a stage."""

    def tell(self, line: str) -> None:
        """Write a line that stays."""

    def clear(self) -> None:
        """Remove an incomplete line."""


class Reporter:
    """Reports the progress of a job. Errors of the stream are ignored."""

    def __init__(self, stream: TextIO | None) -> None:
        on_terminal = is_terminal(stream)
        self._pause_s = REPORT_EVERY_S[on_terminal]
        self._display = _display(Sure(stream), on_terminal)
        self._reported, self._stage = 0.0, ""
        self._first: tuple[float, float] | None = None
        """Time and fraction of the stage at its first progress: what is prepared before counts as
        none."""
        self._estimated = False

    def report(self, progress: Progress) -> None:
        """Show the progress for a new stage, or if the last report is old enough."""
        now, new_stage = time.monotonic(), progress.stage != self._stage
        if new_stage:
            self._first, self._estimated = None, False
        self._estimate(progress, now)
        if now - self._reported < self._pause_s and not new_stage:
            return
        self._reported, self._stage = now, progress.stage
        self._display.show(progress, new_stage)

    def _estimate(self, progress: Progress, now: float) -> None:
        """Tell once how much time a stage still takes, if that is long."""
        if self._first is None and progress.fraction > 0.0:
            self._first = now, progress.fraction
        if self._estimated or self._first is None:
            return
        passed_s, done = now - self._first[0], progress.fraction - self._first[1]
        if passed_s < ESTIMATE_AFTER_S or done <= 0.0:
            return
        self._estimated = True
        left_s = passed_s * (1.0 - progress.fraction) / done
        if left_s > LONG_S:
            self._display.tell(f"{progress.stage}: about {duration_text(left_s)} left")

    def clear(self) -> None:
        """Remove an incomplete line."""
        self._display.clear()


def duration_text(seconds: float) -> str:
    """Return a duration in the unit that suits it: "40 s", "7 min", "2.6 h"."""
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.1f} h"


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

    def tell(self, line: str) -> None:
        """Write a line."""
        self._stream.write(f"{line}\n")

    def clear(self) -> None:
        """Lines stay."""


class OneLine:
    """A line that overwrites itself, for a terminal without a progress library."""

    def __init__(self, stream: Sure) -> None:
        self._stream = stream

    def show(self, progress: Progress, new_stage: bool) -> None:
        """Overwrite the line."""
        self._stream.write(f"\r\x1b[K{_text(progress)}")

    def tell(self, line: str) -> None:
        """Write a line in the place of the one that overwrites itself."""
        self._stream.write(f"\r\x1b[K{line}\n")

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

    def tell(self, line: str) -> None:
        """Write a line above the bar."""
        self._tqdm.tqdm.write(line, file=self._stream)

    def clear(self) -> None:
        """Remove the line."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def _text(progress: Progress) -> str:
    value = progress.value_text
    return f"{progress.stage} {progress.fraction:4.0%}{'  ' if value else ''}{value}"
