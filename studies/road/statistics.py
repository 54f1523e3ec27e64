"""What is compared of predicted and counted points, by class and ring, with intervals."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..results_file import Json
from .logs import CLASSES, Log
from .models import MIN_BOXES, RINGS_M, Cells

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SEED, RESAMPLES = 20261126, 1000
LEAST = 0.5
"""With less m, no point is predicted."""
GOALS = {"ratio": (0.8, 1.25), "none": (-0.1, 0.1), "rho": (0.8, 1.0)}
JUDGED = {"ratio": ("car", "pedestrian"), "rho": ("car", "pedestrian"), "none": CLASSES}
HOLDS, REFUTED, OPEN = "holds", "refuted", "not decided"


def ratio(counted: Ints, m: Floats) -> float:
    """Return the median of n / m where points are predicted; NaN where nowhere."""
    some = m >= LEAST
    return float(np.median(counted[some] / m[some])) if some.any() else np.nan


def none_excess(counted: Ints, m: Floats) -> float:
    """Return the predicted minus the true share of boxes without a point."""
    return float(np.mean(m < LEAST) - np.mean(counted == 0))


def rank_correlation(counted: Ints, m: Floats) -> float:
    """Return Spearman's rho; NaN where one of the two has a single value."""
    a, b = _ranks(counted), _ranks(m)
    length = np.sqrt((a * a).sum() * (b * b).sum())
    return float((a * b).sum() / length) if length > 0.0 else np.nan


def _ranks(values: NDArray) -> Floats:
    """Return midranks minus their mean; `ranks.midranks` compares all pairs, which are too many."""
    _, which, count = np.unique(values, return_inverse=True, return_counts=True)
    ranks = (np.cumsum(count) - (count - 1) / 2.0)[which]
    return np.asarray(ranks - ranks.mean())


FIGURES: dict[str, Callable[[Ints, Floats], float]] = {
    "ratio": ratio,
    "none": none_excess,
    "rho": rank_correlation,
}


def compared(log: Log, m: Floats, cells: Cells) -> Json:
    """Return the figures of each cell, and rho of each class over all distances.

    A figure that a goal judges has its interval and verdict. `poisson` was looked for afterwards:
    *none* with the share exp(-m) of boxes without a point, as if points were independent.
    """
    found: Json = {}
    for k, name in enumerate(CLASSES[:-1]):
        boxes = np.flatnonzero(log.objects.labels == k)
        if len(boxes) >= MIN_BOXES:
            found[name] = {"all": _cell(log, m, boxes, name, ("rho",))}
            found[name] |= {
                f"{RINGS_M[ring]:g} to {RINGS_M[ring + 1]:g} m": {
                    **_cell(log, m, own, name, ("ratio", "none")),
                    "rho": _rounded(rank_correlation(log.points[own], m[own])),
                    "without_points": _rounded(np.mean(log.points[own] == 0)),
                    "poisson": _rounded(np.mean(np.exp(-m[own])) - np.mean(log.points[own] == 0)),
                }
                for (label, ring), own in cells.items()
                if label == name
            }
    return found


def _cell(log: Log, m: Floats, boxes: Ints, name: str, figures: tuple[str, ...]) -> Json:
    data: Json = {"boxes": len(boxes), "tracks": len(np.unique(log.tracks[boxes]))}
    for figure in figures:
        value = FIGURES[figure](log.points[boxes], m[boxes])
        data[figure] = {"value": _rounded(value)}
        if name in JUDGED[figure]:
            low, high = tracks_interval(FIGURES[figure], log, m, boxes)
            interval = [_rounded(low), _rounded(high)]
            data[figure] |= {"interval": interval, "verdict": verdict(figure, low, high)}
    return data


def verdict(figure: str, low: float, high: float) -> str:
    """Return the verdict on a figure from its interval."""
    least, most = GOALS[figure]
    if low >= least and high <= most:
        return HOLDS
    return REFUTED if low > most or high < least else OPEN


def tracks_interval(
    figure: Callable[[Ints, Floats], float], log: Log, m: NDArray, boxes: Ints
) -> tuple[float, float]:
    """Return the 95 % interval of a figure: percentiles of bootstraps over the tracks."""
    rng = np.random.default_rng(SEED)
    order = boxes[np.argsort(log.tracks[boxes], kind="stable")]
    parts = np.split(order, np.flatnonzero(np.diff(log.tracks[order])) + 1)
    values = []
    for _ in range(RESAMPLES):
        drawn = np.concatenate([parts[k] for k in rng.integers(0, len(parts), len(parts))])
        values.append(figure(log.points[drawn], m[drawn]))
    low, high = np.nanpercentile(values, (2.5, 97.5))
    return float(low), float(high)


def _rounded(value: float) -> float | None:
    return None if np.isnan(value) else round(float(value), 3)


def statements(by_log: Json) -> list[Json]:
    """Return the verdict on each goal over logs, with the cells by verdict."""
    rows = []
    for figure in GOALS:
        found = [
            (log, name, ring, cell[figure])
            for log, classes in by_log.items()
            for name, rings in classes.items()
            for ring, cell in rings.items()
            if isinstance(cell.get(figure), dict) and "verdict" in cell[figure]
        ]
        low, high = GOALS[figure]
        verdicts = [cell["verdict"] for *_, cell in found]
        inside = sum(low <= cell["value"] <= high for *_, cell in found)
        whole = REFUTED if REFUTED in verdicts else OPEN if OPEN in verdicts else HOLDS
        counts = {v: verdicts.count(v) for v in (HOLDS, OPEN, REFUTED)}
        rows.append({"figure": figure, "verdict": whole, "cells": counts, "inside": inside})
    return rows
