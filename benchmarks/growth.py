"""``python -m benchmarks.growth``: how time and memory of a score grow with what is scored.

One quantity grows at a time; each case has a process of its own, so that its peak memory is its own
as well, and leaves a file: what is there is not run again. The table is docs/growth.md. A case that
does not fit is refused before it begins, in one line, which the table has.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import pe_core as pe

from .many_rows import ring_on_roof
from .problems import car, plain_study
from .timing import peak_mb

ROOT = Path(__file__).resolve().parent.parent
RUNS = ROOT / "build" / "growth"
TABLE = ROOT / "docs" / "growth.md"
SAMPLES = 1 << 18
REPEATS = 3
LONG_S = 20.0
"""Processor time [s] from which a case is run once."""
ELEVATIONS = (-25.0, 15.0)
"""Channels lie evenly between these [deg], whatever their number."""
AZIMUTHS = 1800
FINEST = 2_097_152_000
"""Voxels of the finest grid: those of a side of 3.1 cm."""
Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Growth:
    """A quantity that grows: its name, what is scored, its values, and the study and the number of
    sampled voxels (0: the grid) of a value."""

    name: str
    work: str
    values: tuple[int, ...]
    study: Callable[[int], pe.Study]
    samples: Callable[[int], int] = lambda _value: SAMPLES


def of_sensors(count: int) -> pe.Study:
    """LiDARs and cameras, half of each, in two rings on a car's roof; one is a LiDAR."""
    return ring_on_roof(lidars=(count + 1) // 2, cameras=count // 2)


def of_triangles(count: int) -> pe.Study:
    """A Pandar64 on a car of about so many triangles."""
    return plain_study(car(count))


def of_channels(count: int) -> pe.Study:
    """A LiDAR of so many channels, tilted by 3 degrees, on a car."""
    elevations = np.radians(np.linspace(*ELEVATIONS, count))
    model = pe.Lidar(f"{count} channels", elevations, AZIMUTHS, max_range=200.0)
    pose = pe.Pose.from_degrees((-0.43, 0.02, 1.83), (0.0, 3.0, 0.0))
    return pe.Study(pe.Rig([pe.Sensor("roof", model, pose)]), car())


def of_voxels(count: int) -> pe.Study:
    """A Pandar64 on a car, in the paper's space with about so many voxels."""
    study = plain_study(car())
    space = study.space
    volume = math.prod(high - low for low, high in (space.x, space.y, space.z))
    interval = round((volume / count) ** (1 / 3), 5)
    return replace(
        study, space=pe.PerceptionSpace(x=space.x, y=space.y, z=space.z, interval=interval)
    )


GROWTHS = {
    "sensors": Growth(
        "sensors",
        "262,144 voxels, half LiDARs, half cameras, each alone and failing, car",
        (1, 4, 16, 64),
        study=of_sensors,
    ),
    "samples": Growth(
        "sampled voxels",
        "a Pandar64 on a car",
        (1 << 14, 1 << 16, 1 << 18, 1 << 20),
        study=lambda _value: plain_study(car()),
        samples=int,
    ),
    "triangles": Growth(
        "triangles of the vehicle",
        "262,144 voxels, a Pandar64, rays built anew",
        (1_536, 24_576, 393_216, 1_572_864),
        study=of_triangles,
    ),
    "channels": Growth(
        "channels of a tilted LiDAR",
        "262,144 voxels, 1,800 azimuths, car",
        (16, 64, 128, 256),
        study=of_channels,
    ),
    "voxels": Growth(
        "voxels of the grid",
        "all of them, a Pandar64 on a car",
        (4_096_000, 64_000_000, 512_000_000, FINEST),
        study=of_voxels,
        samples=lambda _value: 0,
    ),
}
TOO_MUCH = {
    "lidars on the finest grid": Growth(
        "LiDARs on the finest grid",
        "more than the memory of the machine",
        (32,),
        study=lambda count: replace(ring_on_roof(count, 0), space=of_voxels(FINEST).space),
        samples=lambda _value: 0,
    ),
    "voxels beyond a space": Growth(
        "voxels of the grid", "more than a space may have", (64_000_000_000,), study=of_voxels
    ),
}
"""What is refused."""


def main(arguments: Sequence[str]) -> int:
    """Run what is missing, each case in a process of its own, and write the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.growth", description=__doc__)
    parser.add_argument("--case", nargs=2, metavar=("NAME", "VALUE"), help="print one as JSON")
    parser.add_argument("--runs", type=Path, default=RUNS, help="folder of the runs' files")
    args = parser.parse_args(arguments)
    if args.case:
        name, value = args.case
        print(json.dumps(measured(name, int(value))))
        return 0
    args.runs.mkdir(parents=True, exist_ok=True)
    TABLE.write_text(_page(args.runs), "utf-8")
    return 0


def measured(name: str, value: int) -> Json:
    """Score a case; return its processor time [s] and the process's peak memory [MB], or why it
    was refused. The evaluator, its voxels and the vehicle's tree are built within the time."""
    growth = (GROWTHS | TOO_MUCH)[name]
    seconds: list[float] = []
    while len(seconds) < REPEATS and sum(seconds) < LONG_S:
        try:
            study = growth.study(value)
            begun = time.process_time()
            study.evaluator(growth.samples(value)).score(study.rig)
        except pe.InputError as error:
            return {"refused": str(error)}
        seconds.append(time.process_time() - begun)
    return {"seconds": median(seconds), "peak_mb": peak_mb(), "load": os.getloadavg()[0]}


def _run(folder: Path, name: str, value: int) -> Json:
    """Return what a case gave, from its file where it has one."""
    path = folder / f"{name} {value}.json"
    if not path.exists():
        command = [sys.executable, "-m", "benchmarks.growth", "--case", name, str(value)]
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT)
        path.write_text(done.stdout, "utf-8")
        print(f"{path.stem}: {done.stdout.strip()}", flush=True)
    found: Json = json.loads(path.read_text("utf-8"))
    return found


def _page(folder: Path) -> str:
    lines = [
        "# How time and memory grow",
        "",
        "Processor time and peak memory of a score, one process a row, when one quantity grows and",
        "all else stays. The time has the sampling of voxels, the vehicle's tree and the score in",
        "it; the memory is that of the whole process, with Python and NumPy. *Growth* is the",
        "exponent from the row before: 1 is linear. Half of the finest grid's time is the",
        "system's, which hands out the memory.",
        "",
        "| what grows | | time | growth | memory | growth |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name, growth in GROWTHS.items():
        lines += _rows(growth, [_run(folder, name, value) for value in growth.values])
    refusals = [_run(folder, name, growth.values[0]) for name, growth in TOO_MUCH.items()]
    lines += [
        "",
        "What does not fit is refused before it begins:",
        "",
        "```",
        *(f"pe: {found['refused']}" for found in refusals),
        "```",
        "",
        "`python -m benchmarks.growth` measures this again; a run that is broken off goes on where",
        "it was.",
        "",
    ]
    return "\n".join(lines)


def _rows(growth: Growth, found: Sequence[Json]) -> list[str]:
    lines = [f"| **{growth.name}**: {growth.work} | | | | | |"]
    before: tuple[int, Json] | None = None
    for value, run in zip(growth.values, found, strict=True):
        cells = ["", f"{value:,}"]
        for key, text in (("seconds", _time_text), ("peak_mb", _memory_text)):
            cells += [
                text(run[key]),
                "" if before is None else _exponent(before, (value, run), key),
            ]
        lines.append(f"| {' | '.join(cells)} |")
        before = (value, run)
    return lines


def _exponent(before: tuple[int, Json], now: tuple[int, Json], key: str) -> str:
    """Return the exponent between two rows, as text."""
    times_as_many = now[0] / before[0]
    times_as_much = now[1][key] / before[1][key]
    return f"{math.log(times_as_much) / math.log(times_as_many):.2f}"


def _time_text(seconds: float) -> str:
    return f"{seconds * 1e3:.0f} ms" if seconds < 1.0 else f"{seconds:.1f} s"


def _memory_text(megabytes: float) -> str:
    return f"{megabytes:,.0f} MB"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
