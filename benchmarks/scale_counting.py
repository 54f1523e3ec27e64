"""What a search on workers costs beside time: unpickled meshes, bytes on the loopback, processor.

Workers import this file, so it is none that is run as a script.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pe_core as pe
from pe_core.search import Journal, Objective, Value

LOOPBACK = Path("/proc/net/dev")


class CountedFigure:
    """The entropy of a rig by an evaluator; it leaves a file each time a worker unpickles it, with
    the mesh.

    Parameters
    ----------
    folder : str
        Where the files are left.
    evaluator : pe.Evaluator
    """

    def __init__(self, folder: str, evaluator: pe.Evaluator) -> None:
        self.folder = folder
        self.evaluator = evaluator

    def __setstate__(self, state: dict[str, object]) -> None:
        vars(self).update(state)
        (Path(self.folder) / f"unpickled {os.getpid()} {time.monotonic_ns()}").touch()

    def __call__(self, rig: pe.Rig) -> float:
        """Return the entropy of a rig [nats]."""
        return self.evaluator.entropy(rig)


class BatchNotes(Journal):
    """A journal that notes how many candidates a search asks for at once."""

    def __init__(self) -> None:
        super().__init__()
        self.sizes: list[int] = []

    def evaluate_all(
        self, objective: Objective, rigs: Sequence[pe.Rig], *more: Any, **options: Any
    ) -> list[Value]:
        """Evaluate several rigs, as any journal does."""
        self.sizes.append(len(rigs))
        return super().evaluate_all(objective, rigs, *more, **options)


def unpickled_by(folder: Path) -> list[int]:
    """Return how many times each process unpickled an objective, and remove the files."""
    files = list(folder.glob("unpickled *"))
    processes = [path.name.split()[1] for path in files]
    for path in files:
        path.unlink()
    return [processes.count(each) for each in sorted(set(processes))]


def loopback_bytes() -> int:
    """Return the bytes that went over the loopback since the machine was started."""
    line = next(x for x in LOOPBACK.read_text("utf-8").splitlines() if x.strip().startswith("lo:"))
    return int(line.split()[1])


def processor_s() -> tuple[float, float]:
    """Return the processor time of this process, and of all below it that live [s]."""
    import psutil

    own = psutil.Process()
    times = [each.cpu_times() for each in (own, *own.children(recursive=True))]
    used = [float(each.user + each.system) for each in times]
    return used[0], sum(used[1:])


def ideal_speedup(sizes: Sequence[int], workers: int) -> float:
    """Return how much sooner batches end with so many workers, all candidates alike: computed."""
    return sum(sizes) / sum(math.ceil(size / workers) for size in sizes)
