"""What is compared of predicted and counted points, by class and ring, with intervals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
from pe_core.base import Floats, Ints
from pe_core.scene.objects import Objects
from pe_core.sensors import ObjectMeasurementCache
from pe_core.sensors.camera import Camera, Pinhole
from pe_tools.exchange import pose_from_quaternion

from ..ranks import spearman
from ..results_file import Json
from .logs import CLASSES, Log, read_table
from .models import MIN_BOXES, RINGS_M, Cells

LEAST = 0.5
"""With less m, no point is predicted."""
GOALS = {"ratio": (0.8, 1.25), "none": (-0.1, 0.1), "rho": (0.8, 1.0)}
JUDGED = {"ratio": ("car", "pedestrian"), "rho": ("car", "pedestrian"), "none": CLASSES}
HOLDS = "holds"
REFUTED = "refuted"
OPEN = "not decided"
RING = "ring_"
WHOLE = 0.95
"""A box with this share of its pixels is not hidden."""
BLOCK = 16
"""Frames measured together."""


@dataclass(frozen=True)
class Bootstrap:
    """How intervals are computed; `made_by` notes it."""

    seed: int
    resamples: int = 1000


BOOTSTRAP = Bootstrap(20261126)


def ratio(counted: Ints, m: Floats) -> float:
    """Return the median of n / m where points are predicted; NaN where nowhere."""
    some = m >= LEAST
    return float(np.median(counted[some] / m[some])) if some.any() else np.nan


def none_excess(counted: Ints, m: Floats) -> float:
    """Return the predicted minus the true share of boxes without a point."""
    return float(np.mean(m < LEAST) - np.mean(counted == 0))


def rank_correlation(counted: Ints, m: Floats) -> float:
    """Return Spearman's rho; NaN where one of the two has a single value."""
    rho = spearman(counted, m)
    return np.nan if rho is None else rho


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
            found[name] = {"all": _cell(log, m, boxes, name, figures=("rho",))}
            found[name] |= {
                f"{RINGS_M[ring]:g} to {RINGS_M[ring + 1]:g} m": {
                    **_cell(log, m, own, name, figures=("ratio", "none")),
                    "rho": rounded(rank_correlation(log.points[own], m[own])),
                    "without_points": rounded(np.mean(log.points[own] == 0)),
                    "poisson": rounded(np.mean(np.exp(-m[own])) - np.mean(log.points[own] == 0)),
                }
                for (label, ring), own in cells.items()
                if label == name
            }
    return found


def _cell(log: Log, m: Floats, boxes: Ints, name: str, figures: tuple[str, ...]) -> Json:
    data: Json = {"boxes": len(boxes), "tracks": len(np.unique(log.tracks[boxes]))}
    for figure in figures:
        value = FIGURES[figure](log.points[boxes], m[boxes])
        data[figure] = {"value": rounded(value)}
        if name in JUDGED[figure]:
            low, high = tracks_interval(FIGURES[figure], log, m, boxes)
            interval = [rounded(low), rounded(high)]
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
    rng = np.random.default_rng(BOOTSTRAP.seed)
    order = boxes[np.argsort(log.tracks[boxes], kind="stable")]
    parts = np.split(order, np.flatnonzero(np.diff(log.tracks[order])) + 1)
    values = []
    for _ in range(BOOTSTRAP.resamples):
        drawn = np.concatenate([parts[k] for k in rng.integers(0, len(parts), len(parts))])
        values.append(figure(log.points[drawn], m[drawn]))
    low, high = np.nanpercentile(values, (2.5, 97.5))
    return float(low), float(high)


def rounded(value: float) -> float | None:
    """Return a figure as results have it; None for one that is not there."""
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


def read_cameras(folder: Path) -> tuple[str, pe.Rig]:
    """Return the first log with a calibration, and its ring cameras as pinholes."""
    path = sorted(folder.glob("*/calibration/egovehicle_SE3_sensor.feather"))[0]
    poses = read_table(path, "sensor_name qw qx qy qz tx_m ty_m tz_m")
    size = "width_px height_px fx_px fy_px cx_px cy_px"
    pictures = read_table(path.with_name("intrinsics.feather"), f"sensor_name {size}")
    where = {name: k for k, name in enumerate(poses["sensor_name"])}
    sensors = []
    for k, name in enumerate(pictures["sensor_name"]):
        if name.startswith(RING):
            width, height, *lens = (float(pictures[key][k]) for key in size.split())
            rotation = [float(poses[f"q{axis}"][where[name]]) for axis in "wxyz"]
            place = [float(poses[f"t{axis}_m"][where[name]]) for axis in "xyz"]
            model = Camera(name, int(width), int(height), lens=Pinhole(*lens))
            pose = pose_from_quaternion(rotation, place, optical=True)
            sensors.append(pe.Sensor(name, model, pose))
    return path.parts[-3], pe.Rig(sensors)


def hidden_and_seen(log: Log, rig: pe.Rig) -> Json:
    """Return of hidden and of whole boxes how many there are, and the share with LiDAR points.

    *Hidden*: some camera has it in its field, and all that do see 0 pixels in traffic. *Whole*: one
    sees at least 95 % of its pixels.
    """
    alone, traffic = (np.zeros((len(rig), len(log.points))) for _ in range(2))
    scenes = log.objects.scenes
    for first in range(0, int(scenes.max()) + 1, BLOCK):
        kept = np.flatnonzero((scenes >= first) & (scenes < first + BLOCK))
        if len(kept):
            some = log.objects.some(kept)
            alone[:, kept] = _pixels(some, rig, False)
            traffic[:, kept] = _pixels(some, rig, True)
    in_field = (alone > 0.0).any(axis=0)
    groups = {
        "hidden": in_field & (traffic == 0.0).all(axis=0),
        "whole": ((traffic >= WHOLE * alone) & (alone > 0.0)).any(axis=0),
    }
    found: Json = {"log": log.name, "cameras": len(rig)}
    for name, flags in groups.items():
        boxes = np.flatnonzero(flags)
        low, high = tracks_interval(lambda n, _: float(np.mean(n > 0)), log, log.points, boxes)
        found[name] = {
            "boxes": len(boxes),
            "tracks": len(np.unique(log.tracks[boxes])),
            "with_points": round(float(np.mean(log.points[boxes] > 0)), 3),
            "interval": [round(low, 3), round(high, 3)],
            "median_points": float(np.median(log.points[boxes])),
        }
    return found


def _pixels(objects: Objects, rig: pe.Rig, traffic: bool) -> np.ndarray:
    measured = ObjectMeasurementCache(objects, None, traffic).measure(rig)
    return np.stack([measured[sensor.name] for sensor in rig])
