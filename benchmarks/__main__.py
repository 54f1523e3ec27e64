"""``python -m benchmarks``: time the engine against its yardsticks; write benchmarks/README.md.

Ratios, not seconds, are what to compare between commits: both sides of a ratio are measured in the
same run, in turn, and the smallest of a few runs is taken.
"""

from __future__ import annotations

import os
import platform
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pe_core as pe

from . import literal
from .problems import (
    car,
    plain_study,
    raw_cast,
    rays_of,
    two_lidars,
    two_lidars_two_cameras,
)

REPORT = Path(__file__).with_name("README.md")
REPEATS = 3


@dataclass(frozen=True)
class Row:
    """One line of the table: what was done, our seconds, the yardstick and its seconds."""

    work: str
    ours_s: float
    yardstick: str
    yardstick_s: float | None

    @property
    def cells(self) -> list[str]:
        theirs = "no compiler" if self.yardstick_s is None else _time(self.yardstick_s)
        ratio = "" if self.yardstick_s is None else f"{self.ours_s / self.yardstick_s:.3g}"
        return [self.work, _time(self.ours_s), self.yardstick, theirs, ratio]


def main() -> int:
    """Run all benchmarks, print the table and write it."""
    rows = [*_grid(), *_sampled(), *_rays()]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    text = _report(rows, peak)
    print(text)
    REPORT.write_text(text, "utf-8")
    return 0


def _grid() -> list[Row]:
    """The whole grid of 64 million voxels, against the literal loop in C++."""
    rows = []
    for vehicle, label in ((None, "no vehicle"), (car(), "vehicle of 20,000 triangles")):
        study = plain_study(vehicle)
        evaluator = study.evaluator(0)
        ours, entropy = _best(lambda e=evaluator, s=study: e.entropy(s.rig))
        theirs = literal.run(study)
        if theirs and abs(theirs[0] - entropy) > 1e-3:
            raise SystemExit(f"the yardstick says {theirs[0]}, we say {entropy}")
        seconds = theirs and min(theirs[1], literal.run(study)[1])
        rows.append(Row(f"grid score, Pandar64, {label}", ours, "literal C++, 2 threads", seconds))
    for label, several in (
        ("two Pandar64", two_lidars(study)),
        ("two Pandar40 and two cameras", two_lidars_two_cameras(study)),
    ):
        seconds, _ = _best(lambda e=evaluator, s=several: e.entropy(s.rig))
        rows.append(Row(f"grid score, {label}, vehicle", seconds, "one Pandar64, vehicle", ours))
    return rows


def _sampled() -> list[Row]:
    """Score again after one sensor moved, against a full grid score in the same run."""
    rows = []
    for vehicle, label in ((None, "no vehicle"), (car(), "vehicle")):
        study = plain_study(vehicle)
        grid, _ = _best(lambda s=study: s.evaluator(0).entropy(s.rig), 1)
        seconds, _ = _best(_moving(study, study.evaluator(262_144)), 6)
        rows.append(
            Row(f"262,144 samples after a move, {label}", seconds, "grid score, first", grid)
        )
    return rows


def _moving(study: pe.Study, evaluator: pe.Evaluator) -> Callable[[], object]:
    """Return a call that moves the sensor a little and scores again."""
    x, y, z = study.rig.sensors[0].pose.position
    places = iter(np.linspace(0.0, 0.05, 1000))

    def call() -> float:
        return evaluator.entropy(study.rig.with_poses([pe.Pose((x + next(places), y, z))]))

    return call


def _rays() -> list[Row]:
    """First hits of a frame, against brute force over all triangles (on a part of the rays)."""
    vehicle, directions, position = rays_of(car())
    ours, _ = _best(lambda: vehicle.first_hit(position, directions), 5)
    some = directions[:: len(directions) // 500]
    brute, _ = _best(lambda: raw_cast(vehicle.triangles, position, some), 1)
    rate = len(directions) / ours / 1e6
    work = f"first hit of {len(directions):,} rays ({rate:.1f} million a second)"
    return [
        Row(work, ours, "every ray against every triangle", brute * len(directions) / len(some))
    ]


def _best(work: Callable[[], object], repeats: int = REPEATS) -> tuple[float, object]:
    times, result = [], None
    for _ in range(repeats):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return min(times), result


def _time(seconds: float) -> str:
    return f"{seconds * 1e3:.1f} ms" if seconds < 1.0 else f"{seconds:.2f} s"


def _report(rows: list[Row], peak_mb: float) -> str:
    head = ["work", "ours", "yardstick", "its time", "ratio"]
    lines = [
        "# Benchmarks",
        "",
        "Written by `make bench`. Compare the ratios between commits, not the times.",
        "",
        f"| {' | '.join(head)} |",
        f"|{' --- |' * len(head)}",
        *(f"| {' | '.join(row.cells)} |" for row in rows),
        "",
        f"Peak memory of this process: {peak_mb:.0f} MB. {_machine()}",
        "",
    ]
    return "\n".join(lines)


def _machine() -> str:
    model = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next(x.split(":")[1].strip() for x in lines if x.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return (
        f"Machine: {model}, {os.cpu_count()} processors, Python {platform.python_version()}, "
        f"NumPy {np.__version__}."
    )


if __name__ == "__main__":
    sys.exit(main())
