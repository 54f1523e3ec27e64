"""How work is timed, beside its yardstick."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from dataclasses import dataclass

REPEATS = 5
Work = Callable[[], object]


@dataclass(frozen=True)
class Timing:
    """One line of the table: what was done, our seconds and memory; the yardstick, its seconds."""

    work: str
    ours_s: float
    peak_mb: float
    yardstick: str
    yardstick_s: float | None


def peak_mb() -> float:
    """The most memory this process has had so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def best(work: Work, repeats: int = REPEATS) -> tuple[float, object]:
    """Shortest time of some, and the result."""
    each = [timed(work) for _ in range(repeats)]
    return min(seconds for seconds, _ in each), each[0][1]


def best_in_turn(work: Work, yardstick: Work, repeats: int = REPEATS) -> tuple[float, float]:
    """Shortest times of two, run in turn."""
    times = [(timed(yardstick)[0], timed(work)[0]) for _ in range(repeats)]
    return min(ours for _, ours in times), min(theirs for theirs, _ in times)


def timed(work: Work) -> tuple[float, object]:
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def best_of_processor(work: Work, repeats: int = REPEATS) -> float:
    """Least processor time of some: what others do on the machine is not in it."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)
