"""What the runs of `experiment_searches` say: a summary, a table, and a plot of the best so far."""

from __future__ import annotations

import json
from pathlib import Path
from statistics import median
from typing import Any

from .run_files import summarise
from .search_curves import draw_curve, save_with_legend

METHODS = ("portfolio", "random")
SUMMARY = Path(__file__).with_name("experiment_searches.json")
EXPERIMENTS = {
    "1_pandar64": "1, Pandar64 on a car",
    "3_default": "3, two LiDARs on a bus",
    "3_front": "3, both in front",
    "4_cameras": "4, two LiDARs, two cameras",
}
PLOT = Path(__file__).resolve().parent.parent / "docs" / "images" / "searches.png"
BUSY = 3.0
"""A machine with a higher load before a run begins is busy with other work: the two processes of
the run before leave a load of 2."""
TICKS_S = (1, 3, 10, 30, 100)
HEAD = ["experiment", "method", "seeds", "entropy on the grid", "lowest to highest", "time"]

Json = dict[str, Any]


def write_summary(runs: Path, path: Path) -> None:
    """Put all runs of a folder into one file, and draw them."""
    kept = summarise(runs, path)
    print("\n".join(table(kept)))
    plot(kept, PLOT)


def table_lines() -> list[str]:
    """Return the table of the runs that are kept with the project; none: nothing."""
    return table(json.loads(SUMMARY.read_text("utf-8"))) if SUMMARY.exists() else []


def table(runs: list[Json]) -> list[str]:
    """Return a table of medians over the seeds."""
    lines = [
        "Searches from the paper's placement (`python -m benchmarks.experiment_searches`):",
        "medians. The time is that of a whole `pe optimize`, with the scores on the grid.",
        "",
        f"| {' | '.join(HEAD)} |",
        f"|{' --- |' * len(HEAD)}",
    ]
    for (experiment, method), some in groups(runs).items():
        ends = [run["entropy"] for run in some]
        cells = [EXPERIMENTS[experiment], method, str(len(some)), f"{median(ends):.3f}"]
        cells += [f"{min(ends):.3f} to {max(ends):.3f}", _time(some)]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _time(some: list[Json]) -> str:
    """Return the median time; on a busy machine also that of the processors, and the load."""
    text = f"{median(run['seconds'] for run in some):.0f} s"
    if not is_busy(some):
        return text
    used = median(run["processor_s"] for run in some)
    return f"{text} at a load of {_load(some):.1f}; {used:.0f} s of processor"


def is_busy(some: list[Json]) -> bool:
    """Whether other work ran beside any of the runs, so that their times are too long."""
    return _load(some) > BUSY


def _load(some: list[Json]) -> float:
    return max(float(run.get("load", 0.0)) for run in some)


def groups(runs: list[Json]) -> dict[tuple[str, str], list[Json]]:
    """Return the runs by experiment and method, in the order of both."""
    keys = [(e, m) for e in EXPERIMENTS for m in METHODS]
    found = {key: [r for r in runs if (r["experiment"], r["method"]) == key] for key in keys}
    return {key: some for key, some in found.items() if some}


def plot(runs: list[Json], path: Path) -> None:
    """Draw the best so far against time: the median of the seeds, and from lowest to highest."""
    from studies import plotting

    looks = dict(zip(METHODS, plotting.PALETTE, strict=False))

    @plotting.styled
    def draw() -> None:
        shown = [e for e in EXPERIMENTS if any(run["experiment"] == e for run in runs)]
        figure, axes = plotting.pyplot().subplots(1, len(shown), figsize=(2.6 * len(shown), 3.0))
        for axis, experiment in zip(list(getattr(axes, "flat", [axes])), shown, strict=True):
            for (own, method), some in groups(runs).items():
                if own == experiment:
                    label = f"{method}, machine busy" if is_busy(some) else method
                    draw_curve(axis, some, looks[method], label)
            number, what = EXPERIMENTS[experiment].split(", ", 1)
            axis.set(xscale="log", title=f"Experiment {number}\n{what}", xlabel="time [s]")
            axis.set_xticks(TICKS_S, map(str, TICKS_S), minor=False)
            axis.minorticks_off()
            plotting.remove_frame(axis)
        figure.axes[0].set_ylabel("perception entropy [nats]")
        save_with_legend(figure, path, 0.08)

    draw()
