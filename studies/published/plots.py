"""The plots of the comparison: drawn from its results and the published table alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..plotting import BLUE, GREY, ORANGE, pyplot, remove_frame, save_plot, styled
from ..ranks import min_significant_rho
from ..results_file import Json
from .correlations import MAIN_CLASS, ValidityResults
from .scores import CLEAN, Paper, papers

plt = pyplot()

PAPER_COLORS = (BLUE, ORANGE)
DOT_OFFSET = 0.13
"""Dots of the two papers are this far above and below their line."""


def draw_all(results: ValidityResults, folder: Path) -> None:
    """Draw every plot of the page."""
    height(folder / "height.png")
    over_papers(folder / "over_papers.png", results)


@styled
def height(path: Path) -> None:
    """Draw AP of cars against the mean height of the LiDARs, a panel for each paper."""
    figure, axes = plt.subplots(1, 2, figsize=(8.6, 3.6), sharey=True, layout="constrained")
    for panel, paper, color in zip(axes, papers(), PAPER_COLORS, strict=True):
        _heights(panel, paper, color)
    axes[0].set_ylabel("AP of cars, each detector's\nworst 0, best 1; mean of four")
    save_plot(figure, path)


def _heights(panel: Axes, paper: Paper, color: str) -> None:
    names = list(paper.placements)
    mean = _scaled_ap(paper, names)
    for name, ap in zip(names, mean, strict=True):
        face = "white" if paper.rolled(name) else color
        panel.plot(paper.height(name), ap, "o", ms=6, mec=color, mfc=face, mew=1.2)
    for name, x, y in _labels(paper, names, mean):
        panel.annotate(name, (x, y), (6, 0), textcoords="offset points", fontsize=7.5, va="center")
    panel.set_title(paper.short, loc="left")
    panel.set_xlabel("mean height of the LiDARs [m]")
    panel.set_ylim(-0.08, 1.1)
    panel.set_xlim(2.15, 2.86)
    remove_frame(panel)


def _scaled_ap(paper: Paper, names: Sequence[str]) -> np.ndarray:
    ap = np.array([[row[MAIN_CLASS][n] for n in names] for row in paper.ap[CLEAN].values()])
    low = ap.min(axis=1, keepdims=True)
    high = ap.max(axis=1, keepdims=True)
    mean: np.ndarray = ((ap - low) / (high - low)).mean(axis=0)
    return mean


def _labels(paper: Paper, names: Sequence[str], mean: np.ndarray) -> list[tuple[str, float, float]]:
    """Return name, x and y of the labels; those of nearly the same height do not overlap."""
    labels: list[tuple[str, float, float]] = []
    for k in np.argsort(mean):
        x = paper.height(names[k])
        y = float(mean[k])
        below = [q for _, p, q in labels if abs(p - x) < 0.1]
        labels.append((names[k].replace("_", " "), x, max(y, *(q + 0.05 for q in below), -1.0)))
    return labels


@styled
def over_papers(path: Path, results: ValidityResults) -> None:
    """Draw rho of every score with cars, a dot for each paper, and the range over the choices."""
    rows = results.scores
    figure, axes = plt.subplots(figsize=(8.6, 0.42 * len(rows) + 1.3), layout="constrained")
    significant = min_significant_rho(len(papers()[0].placements)) or 1.0
    for edge in (-significant, significant):
        axes.axvline(edge, color=GREY, lw=0.8, ls="--")
    axes.axvline(0.0, color=GREY, lw=0.8)
    offsets = (-DOT_OFFSET, DOT_OFFSET)
    for line, score in enumerate(rows):
        for paper, color, offset in zip(papers(), PAPER_COLORS, offsets, strict=True):
            correlation = results.correlation_of(paper, MAIN_CLASS, score)
            _dot(axes, correlation, line + offset, color)
    axes.set_yticks(range(len(rows)), rows)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlim(-1.02, 1.02)
    axes.set_xlabel("Spearman's rho with the AP of cars, mean over four detectors")
    marks = [Line2D([], [], marker="o", ls="", color=c) for c in PAPER_COLORS]
    names = [p.short for p in papers()]
    axes.legend(marks, names, loc="lower left", bbox_to_anchor=(0, 1), ncols=2, frameon=False)
    remove_frame(axes)
    save_plot(figure, path)


def _dot(axes: Axes, row: Json, y: float, color: str) -> None:
    if row["mean"] is not None:
        axes.plot([row["lowest"], row["highest"]], [y, y], color=color, lw=2.5, alpha=0.35)
        axes.plot(row["mean"], y, "o", color=color, ms=6)
