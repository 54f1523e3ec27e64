"""Curves of the best so far over time, as the plots of both search benchmarks draw them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

Json = dict[str, Any]


def values_over_time(runs: Sequence[Json]) -> tuple[list[float], list[list[float]]]:
    """Return times, and at each the values of all runs, from where all runs have one.

    A run that is over keeps its last value.
    """
    times = sorted({t for run in runs for t, _ in run["curve"]})
    curves = [[[e for t, e in run["curve"] if t <= time] for run in runs] for time in times]
    known = [(t, [c[-1] for c in at]) for t, at in zip(times, curves, strict=True) if all(at)]
    return [t for t, _ in known], [values for _, values in known]


def draw_curve(axis: Any, runs: Sequence[Json], colour: str, label: str) -> None:
    """Draw the median of some runs, and the band from the lowest to the highest."""
    times, values = values_over_time(runs)
    low = [min(v) for v in values]
    high = [max(v) for v in values]
    axis.fill_between(times, low, high, step="post", color=colour, alpha=0.15, lw=0)
    axis.step(times, list(map(median, values)), where="post", color=colour, label=label)


def save_with_legend(figure: Any, path: Path, bottom: float) -> None:
    """Put one legend below all panels, in `bottom` of the height, and save the plot."""
    from studies import plotting

    by_label = {}
    for axis in figure.axes:
        handles, labels = axis.get_legend_handles_labels()
        by_label |= dict(zip(labels, handles, strict=True))
    options = {"loc": "lower center", "ncols": len(by_label), "frameon": False}
    figure.legend(list(by_label.values()), list(by_label), **options)
    figure.tight_layout(rect=(0.0, bottom, 1.0, 1.0))
    plotting.save_plot(figure, path)
