"""What the runs of `searches` say: a summary, a table, and a plot of the best so far."""

from __future__ import annotations

import json
from pathlib import Path
from statistics import median
from typing import Any

import pe_core as pe

from .searches import EXPERIMENTS, SUMMARY

PLOT = Path(__file__).resolve().parent.parent / "docs" / "images" / "searches.png"
TICKS_S = (1, 3, 10, 30, 100)
HEAD = ["experiment", "method", "seeds", "entropy on the grid", "lowest to highest", "time"]

Json = dict[str, Any]


def write_summary(runs: Path, path: Path) -> None:
    """Put all runs of a folder into one file, and draw them."""
    found = [json.loads(each.read_text("utf-8")) for each in sorted(runs.glob("*.json"))]
    kept = [{k: v for k, v in run.items() if k != "placements"} for run in found]
    path.write_text("[\n" + ",\n".join(json.dumps(run) for run in kept) + "\n]\n", "utf-8")
    print("\n".join(table(kept)))
    plot(kept, PLOT)


def table_lines() -> list[str]:
    """Return the table of the runs that are kept with the project; none: nothing."""
    return table(json.loads(SUMMARY.read_text("utf-8"))) if SUMMARY.exists() else []


def table(runs: list[Json]) -> list[str]:
    """Return a table of medians over the seeds."""
    lines = [
        "Searches from the paper's placement (`python -m benchmarks.searches`), medians.",
        "The time is that of a whole `pe optimize`, with the grid scores of start and result.",
        "",
        f"| {' | '.join(HEAD)} |",
        f"|{' --- |' * len(HEAD)}",
    ]
    for (experiment, method), some in groups(runs).items():
        ends = [run["entropy"] for run in some]
        seconds = median(run["seconds"] for run in some)
        cells = [EXPERIMENTS[experiment], method, str(len(some)), f"{median(ends):.3f}"]
        cells += [f"{min(ends):.3f} to {max(ends):.3f}", f"{seconds:.0f} s"]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def groups(runs: list[Json]) -> dict[tuple[str, str], list[Json]]:
    """Return the runs by experiment and method, in the order of both."""
    keys = [(e, m) for e in EXPERIMENTS for m in pe.METHODS]
    found = {key: [r for r in runs if (r["experiment"], r["method"]) == key] for key in keys}
    return {key: some for key, some in found.items() if some}


def middle(some: list[Json]) -> tuple[list[float], list[list[float]]]:
    """Return times, and at each the entropies of all runs; a run that is over stays as it is."""
    times = sorted({t for run in some for t, _ in run["curve"]})
    curves = [[[e for t, e in run["curve"] if t <= time] for run in some] for time in times]
    known = [(t, [c[-1] for c in at]) for t, at in zip(times, curves, strict=True) if all(at)]
    return [t for t, _ in known], [values for _, values in known]


def plot(runs: list[Json], path: Path) -> None:
    """Draw the best so far against time: the median of the seeds, and from lowest to highest."""
    from pe_tools.reproduction import plotting

    looks = dict(zip(pe.METHODS, plotting.PALETTE, strict=False))

    @plotting.styled
    def draw() -> None:
        shown = [e for e in EXPERIMENTS if any(run["experiment"] == e for run in runs)]
        figure, axes = plotting.pyplot().subplots(1, len(shown), figsize=(2.6 * len(shown), 3.0))
        for axis, experiment in zip(list(getattr(axes, "flat", [axes])), shown, strict=True):
            for (own, method), some in groups(runs).items():
                if own == experiment:
                    _curve(axis, some, looks[method], method)
            number, what = EXPERIMENTS[experiment].split(", ", 1)
            axis.set(xscale="log", title=f"Experiment {number}\n{what}", xlabel="time [s]")
            axis.set_xticks(TICKS_S, map(str, TICKS_S), minor=False)
            axis.minorticks_off()
            plotting.remove_frame(axis)
        figure.axes[0].set_ylabel("perception entropy [nats]")
        handles = figure.axes[0].get_legend_handles_labels()
        figure.legend(*handles, loc="lower center", ncols=len(handles[0]), frameon=False)
        figure.tight_layout(rect=(0.0, 0.08, 1.0, 1.0))
        plotting.save_plot(figure, path)

    draw()


def _curve(axis: Any, some: list[Json], colour: str, label: str) -> None:
    """Draw the median of some runs, and the band they are in."""
    times, values = middle(some)
    low, high = [min(v) for v in values], [max(v) for v in values]
    axis.fill_between(times, low, high, step="post", color=colour, alpha=0.15, lw=0)
    axis.step(times, list(map(median, values)), where="post", color=colour, label=label)
