"""Progress of a job on stderr: a bar with the time left on a terminal, lines in a log. Of a stage
that takes long, one line tells the time left, as soon as its progress shows it."""

import shutil
import time
from typing import TextIO

from ..jobs import Progress
from .terminal import is_terminal, show

REPORT_EVERY_S = {True: 0.2, False: 5.0}
"""How often progress is shown: on a terminal, where it overwrites itself, and in a log."""
ESTIMATE_AFTER_S = 3.0
LONG_S = 20.0
"""How long a stage runs before its time is estimated; more time left than that is told."""
BAR_WIDTH = 24
CLEAR = "\r\x1b[K"


class Reporter:
    """Reports the progress of a job. After an error of the stream it says no more."""

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self._on_terminal = is_terminal(stream)
        self._pause_s = REPORT_EVERY_S[self._on_terminal]
        self._reported = 0.0
        self._stage = ""
        self._began = 0.0
        self._first: tuple[float, float] | None = None
        """Time and fraction of the stage at its first progress: what is prepared before counts as
        none."""
        self._told = False

    def report(self, progress: Progress) -> None:
        """Show the progress for a new stage, or if the last report is old enough."""
        now = time.monotonic()
        new_stage = progress.stage != self._stage
        if new_stage:
            self._stage = progress.stage
            self._began = now
            self._first = None
            self._told = False
        if self._first is None and progress.fraction > 0.0:
            self._first = now, progress.fraction
        left_s: float | None = None  # as long as the stage's progress does not show it
        if self._first is not None and progress.fraction > self._first[1]:
            passed_s = now - self._first[0]
            done = progress.fraction - self._first[1]
            left_s = passed_s * (1.0 - progress.fraction) / done
            if not self._told and passed_s >= ESTIMATE_AFTER_S:
                self._told = True
                if left_s > LONG_S:
                    self.clear()
                    self._write(f"{self._stage}: about {duration_text(left_s)} left\n")
        if now - self._reported < self._pause_s and not new_stage:
            return
        self._reported = now
        value = progress.value_text
        done = min(max(progress.fraction, 0.0), 1.0)
        if not self._on_terminal:
            self._write(f"{progress.stage} {done:4.0%}{'  ' if value else ''}{value}\n")
            return
        bar = ("#" * round(BAR_WIDTH * done)).ljust(BAR_WIDTH)
        clock = f"{_clock(now - self._began)}<{'?' if left_s is None else _clock(left_s)}"
        line = f"{progress.stage} {done:4.0%} |{bar}| {clock}{', ' if value else ''}{value}"
        self._write(CLEAR + line[: shutil.get_terminal_size().columns - 1])

    def clear(self) -> None:
        """Remove an incomplete line."""
        if self._on_terminal:
            self._write(CLEAR)

    def _write(self, text: str) -> None:
        if show(text, self._stream) is not None:
            self._stream = None


def _clock(seconds: float) -> str:
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes:02d}:{rest:02d}" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d}"


def duration_text(seconds: float) -> str:
    """Return a duration in the unit that suits it: "40 s", "7 min", "2.6 h"."""
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.1f} h"
