"""Where the sensors end up: our placements beside the paper's, from above and from the side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from numpy.typing import NDArray

import pe_core as pe

from .paper import Row
from .problems import study_of
from .style import PALETTE, finished, save, style

Floats = NDArray[np.float64]

VIEWS = ((0, 1), (0, 2))
"""Axes of the page: from above, from the right."""
MARGIN_M, WIDTH_IN = (0.75, 0.3, 0.3), 6.4
"""Room round vehicle and sensors; width of the picture."""
DARKEST, LIGHTEST = 0.72, 0.93
PITCH_MARK_M = 0.7


@style
def draw_placements(path: Path, row: Row, found: Sequence[Mapping[str, Any]]) -> None:
    """Draw a row: hollow marks where the paper has sensors, filled ones where searches end.

    `found` holds the placements of every search by sensor.
    """
    study = study_of(row.name)
    assert study.vehicle is not None
    low, high = _extent(study, found)
    length, width, height = high - low
    scale = WIDTH_IN / length
    figure, axes = plt.subplots(
        2,
        1,
        figsize=(WIDTH_IN + 1.0, (width + height) * scale + 1.6),
        height_ratios=(width, height),
        sharex=True,
        layout="constrained",
    )
    for view, axis in zip(axes, VIEWS, strict=True):
        faces, shades = _seen(study.vehicle.triangles, axis)
        view.add_collection(PolyCollection(faces, facecolors=shades, edgecolors="face", lw=0.2))
        for color, sensor in zip(PALETTE, study.rig, strict=False):
            for ours in found:
                at = ours[sensor.name]
                _mark(view, at["position"], at["rotation"], axis, color, filled=True)
            _mark(view, sensor.pose.position, sensor.pose.rotation_deg, axis, color, filled=False)
        view.set(xlim=(low[0], high[0]), ylim=(low[axis[1]], high[axis[1]]), aspect="equal")
        finished(view)
    axes[0].set_ylabel("y, left [m]")
    axes[1].set(ylabel="z, up [m]", xlabel="x, forward [m]")
    axes[0].legend(
        handles=_key(study),
        loc="lower left",
        bbox_to_anchor=(0, 1),
        ncols=5,
        frameon=False,
        columnspacing=1.2,
        handletextpad=0.3,
    )
    figure.align_ylabels(axes)
    save(figure, path)


def _extent(study: pe.Study, found: Sequence[Mapping[str, Any]]) -> tuple[Floats, Floats]:
    """Lowest and highest corner (3,) of what is drawn [m], with a margin."""
    assert study.vehicle is not None
    points = [np.asarray(p) for p in (*study.vehicle.bounds, *(s.pose.position for s in study.rig))]
    points += [np.asarray(at["position"]) for ours in found for at in ours.values()]
    return np.min(points, axis=0) - MARGIN_M, np.max(points, axis=0) + MARGIN_M


def _key(study: pe.Study) -> list[Line2D]:
    """The colours of the sensors, and the two kinds of marks."""
    colors = zip(PALETTE, study.rig, strict=False)
    sensors = [_dot(color, s.name.replace("_", " "), filled=True) for color, s in colors]
    return [*sensors, _dot("black", "paper", filled=False)]


def _dot(color: str, label: str, *, filled: bool) -> Line2D:
    face, size = (color, 5) if filled else ("none", 10)
    return Line2D([], [], marker="o", ls="none", color=color, mfc=face, ms=size, label=label)


def _seen(triangles: Floats, axis: tuple[int, int]) -> tuple[list[Floats], list[str]]:
    """Triangles seen along the third axis, the near ones last, and their shades of grey."""
    third = 3 - sum(axis)
    depth = triangles[:, :, third].mean(axis=1)
    near_last = np.argsort(depth if third == 2 else -depth, kind="stable")
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.maximum(np.sqrt((normals**2).sum(axis=1)), 1e-12)
    shades = DARKEST + (LIGHTEST - DARKEST) * np.abs(normals[:, third]) / length
    return list(triangles[near_last][:, :, list(axis)]), [f"{s:.3f}" for s in shades[near_last]]


def _mark(
    view: Axes,
    position: tuple[float, ...],
    rotation: tuple[float, ...],
    axis: tuple[int, int],
    color: str,
    *,
    filled: bool,
) -> None:
    """Draw a sensor; from the side, a line shows where its pitch points."""
    u, v = (position[k] for k in axis)
    if filled:
        view.plot([u], [v], "o", color=color, ms=5, alpha=0.85, mec="white", mew=0.5, zorder=3)
    else:
        view.plot([u], [v], "o", color=color, mfc="none", ms=11, mew=1.8, zorder=4)
    if axis == (0, 2):
        pitch, yaw = np.radians(rotation[1]), np.radians(rotation[2])
        tip = u + PITCH_MARK_M * np.cos(pitch) * np.cos(yaw), v - PITCH_MARK_M * np.sin(pitch)
        view.plot([u, tip[0]], [v, tip[1]], color=color, lw=1, ls="-" if filled else ":", zorder=2)
