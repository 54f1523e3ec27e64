"""``python -m benchmarks``: time the engine against its yardsticks; write the report and all rows.

Ratios, not seconds, are what to compare between commits: both sides of a ratio are measured in the
same process, and the smallest of a few runs is taken. Each row has a process of its own, so that
its peak memory is its own as well. ``python -m benchmarks ROW...`` prints the rows of that name;
``python -m benchmarks --against REV`` times them on an older commit in alternation.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import platform
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np

from . import requirement_searches
from .against import compare
from .experiment_searches_told import table_lines
from .rows import ROWS, Timing

REPORT = Path(__file__).with_name("README.md")
TIMINGS = REPORT.with_name("timings.csv")
"""All rows; the report shows some."""
SHOWN = (
    "grid_on_car",
    "full_score",
    "samples_on_car",
    "rays",
    "rays_close",
    "rays_at_many_triangles",
    "nine_presets",
    "answer_to_a_move",
    "candidates_in_traffic",
    "full_score_of_many",
    "objects_on_car",
)
HEAD = ["work", "ours", "yardstick", "its time", "ratio", "our peak memory"]


def main(arguments: list[str]) -> int:
    """Run all benchmarks, print the table and write it; or print some rows as JSON."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=main.__doc__)
    parser.add_argument("names", nargs="*", metavar="ROW", help="rows; all by default")
    parser.add_argument("--against", metavar="REV", help="time each row on this commit, too")
    given = parser.parse_args(arguments)
    names: list[str] = given.names
    if given.against:
        return compare(given.against, names or list(ROWS))
    for name in names:
        print(json.dumps(asdict(ROWS[name]())))
    if not names:
        cells = {name: _cells(_apart(name)) for name in ROWS}
        with TIMINGS.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([HEAD, *cells.values()])
        text = _report([cells[name] for name in SHOWN])
        print(text)
        REPORT.write_text(text, "utf-8")
    return 0


def _apart(name: str) -> Timing:
    """Run a row in a process of its own."""
    command = [sys.executable, "-m", __package__, name]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    return Timing(**json.loads(done.stdout))


def _cells(row: Timing) -> list[str]:
    theirs = "not installed" if row.yardstick_s is None else _time(row.yardstick_s)
    ratio = "" if row.yardstick_s is None else f"{row.ours_s / row.yardstick_s:.3g}"
    memory = f"{row.peak_mb:.0f} MB"
    return [row.work, _time(row.ours_s), row.yardstick, theirs, ratio, memory]


def _time(seconds: float) -> str:
    return f"{seconds * 1e3:.1f} ms" if seconds < 1.0 else f"{seconds:.2f} s"


def _report(rows: list[list[str]]) -> str:
    lines = [
        "# Benchmarks",
        "",
        "Written by `make bench`; [timings.csv](timings.csv) has all rows. Compare the ratios",
        "between commits, not the times. Memory is that of a whole process.",
        "",
        f"| {' | '.join(HEAD)} |",
        f"|{' --- |' * len(HEAD)}",
        *(f"| {' | '.join(cells)} |" for cells in rows),
        "",
        *table_lines(),
        "",
        *requirement_searches.table_lines(),
        "",
        "One search on more and more workers: [search_scale.md](search_scale.md).",
        "A score of more and more sensors, voxels, triangles: [growth.md](../docs/growth.md).",
        "",
        _machine(),
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
    sys.exit(main(sys.argv[1:]))
