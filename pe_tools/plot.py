"""Plots for notebooks, on axes of matplotlib: the ground, a rig, a LiDAR's beams, scores.

Each function draws on the `axes` of a subplot, or of a new figure, and returns them. Backend and
style stay those of the notebook. `InputError` when matplotlib is not installed (the extra
`notebook` brings it), or a value is none that is named.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, require_kind, shown
from pe_core.base.plugins import required_package
from pe_core.base.values import choice
from pe_core.scene.rig import Rig, Sensor
from pe_core.scene.vehicle import Vehicle
from pe_core.scoring.score import PartScore, Score
from pe_core.sensors import Lidar
from pe_core.study.study import Study

from .graphics import COVERAGE, ENTROPY, QUANTITIES, cast, fitted_bounds

if TYPE_CHECKING:
    from matplotlib.axes import Axes

QUANTITY_KEYS = {"entropy": ENTROPY, "coverage": COVERAGE}
VIEWS = {"top": (0, 1, 2, 1.0), "side": (0, 2, 1, -1.0), "front": (1, 2, 0, 1.0)}
"""Axes to the right and up, the one towards the reader, and its sign, by view."""
LABELS = ("x, forward [m]", "y, to the left [m]", "z, up [m]")
# Grey of a surface that faces the reader, and of one seen from its edge
LIGHT = 0.93
DARK = 0.55
BORESIGHT_M = 0.5  # Length of the line in which a sensor looks
MOST_BEAMS = 60_000
SKY = "#56B4E9"
GREY = "#8A8A8A"
PALETTE = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7")
"""Of Okabe and Ito, safe for colour-blind readers."""
COLORS = (*PALETTE, SKY, GREY)
"""Of sensors, in their order: `Sensor.color` is made for dark backgrounds."""
BODY = {"facecolor": "#444a52", "edgecolor": "none", "zorder": 3}


def ground(
    study: Study,
    rig: Rig | None = None,
    *,
    quantity: str = "entropy",
    height: float | None = None,
    step: float = 1.0,
    axes: Axes | None = None,
) -> Axes:
    """Draw how well each place on the ground is seen, with the vehicle and its sensors from above.

    Parameters
    ----------
    rig : Rig, optional
        By default the study's.
    quantity : {"entropy", "coverage"}
        In nats, bright is low; or the share that any sensor sees.
    height : float, optional
        Height of the evaluated voxels [m]; by default averaged by the prior, as in a score.
    step : float
        Side of a cell [m].
    """
    require_kind("plot", "study", study, Study)
    key = QUANTITY_KEYS[choice("plot", "quantity", quantity, QUANTITY_KEYS)]
    axes = _axes(axes, (8.0, 4.4))
    rig = study.rig if rig is None else rig
    seen = study.sight().ground(rig, height, step)
    values = getattr(seen, quantity)
    dark, bright = fitted_bounds(seen, key)
    colors = "viridis" if quantity == "entropy" else "cividis"
    half = seen.step / 2.0
    image = axes.imshow(
        values.T,
        origin="lower",
        extent=(seen.x[0] - half, seen.x[-1] + half, seen.y[0] - half, seen.y[-1] + half),
        cmap=colors if dark < bright else f"{colors}_r",
        vmin=min(dark, bright),
        vmax=max(dark, bright),
    )
    unit = "" if QUANTITIES[key].shares else " [nats], lower is better"
    axes.figure.colorbar(image, ax=axes, label=f"{quantity}{unit}", shrink=0.75, pad=0.02)
    if study.vehicle is not None:
        _add_triangles(axes, study.vehicle.triangles[:, :, :2], BODY)
    for sensor, color in zip(rig, cycle(COLORS), strict=False):
        x, y, _ = sensor.pose.position
        axes.plot(x, y, "o", color=color, mec="white", mew=0.5, ms=4, zorder=4)
    axes.set(xlabel=LABELS[0], ylabel=LABELS[1])
    return axes


def rig(
    study: Study, rig: Rig | None = None, *, view: str = "side", axes: Axes | None = None
) -> Axes:
    """Draw the vehicle and its sensors, with the direction in which each looks.

    Parameters
    ----------
    rig : Rig, optional
        By default the study's.
    view : {"side", "top", "front"}
        From the right, from above, or from ahead.
    """
    require_kind("plot", "study", study, Study)
    right, up, _, _ = VIEWS[choice("plot", "view", view, VIEWS)]
    rig = study.rig if rig is None else rig
    points = [np.array([sensor.pose.position for sensor in rig])]
    points += [] if study.vehicle is None else [np.array(study.vehicle.bounds)]
    span = np.ptp(np.concatenate(points), axis=0)
    axes = _axes(
        axes, (8.0, float(np.clip(1.2 + 6.0 * span[up] / max(span[right], 0.1), 2.4, 5.0)))
    )
    if study.vehicle is not None:
        _draw_body(axes, study.vehicle, view)
    for sensor, color in zip(rig, cycle(COLORS), strict=False):
        start = np.asarray(sensor.pose.position)
        end = start + BORESIGHT_M * sensor.pose.ground_from_sensor[:, 0]
        axes.plot(*zip(start[[right, up]], end[[right, up]], strict=True), color=color, lw=2)
        axes.plot(
            start[right], start[up], "o", color=color, mec="white", ms=8, label=_plain(sensor.name)
        )
    axes.set(xlabel=LABELS[right], ylabel=LABELS[up], aspect="equal")
    axes.margins(0.08)
    return _with_legend(axes)


def beams(study: Study, sensor: str | Sensor, *, axes: Axes | None = None) -> Axes:
    """Draw the beams of a LiDAR by azimuth and elevation, and those that the vehicle occludes.

    Parameters
    ----------
    sensor : str or Sensor
        A LiDAR of the study's rig by its name, or any other.
    """
    sensor = _lidar(study, sensor)
    found = cast(sensor, study.vehicle, MOST_BEAMS)
    axes = _axes(axes, (8.0, 3.6))
    x, y, z = found.directions.T
    azimuth = np.degrees(np.arctan2(y, x))
    elevation = np.degrees(np.arcsin(z))
    part = np.full(len(found.face), -1)
    if study.vehicle is not None:
        part[found.occluded] = np.asarray(study.vehicle.parts)[found.face[found.occluded]]
    numbers, counts = np.unique(part[part >= 0], return_counts=True)
    by_size = numbers[np.argsort(-counts)].tolist()
    names = () if study.vehicle is None else study.vehicle.part_names
    groups = [(part == -1, "free", SKY)]
    groups += [(part == n, names[n], c) for n, c in zip(by_size, PALETTE[1:], strict=False)]
    groups.append((np.isin(part, by_size[len(PALETTE) - 1 :]), "other parts", GREY))
    for member, name, color in groups:
        if member.any():
            label = f"{_plain(name)}, {100.0 * member.mean():.2g} %"
            axes.plot(azimuth[member], elevation[member], ".", ms=1.6, color=color, label=label)
    axes.set(xlabel="azimuth, to the left [deg]", ylabel="elevation [deg]", xlim=(180, -180))
    axes.set_xticks(range(-180, 181, 60))
    axes.set_title(_plain(f"{sensor.name}: {sensor.model.name}"), loc="left", fontsize="medium")
    return _with_legend(axes, markerscale=6)


def _lidar(study: Study, sensor: str | Sensor) -> Sensor:
    """Return a LiDAR, of the study's rig by its name; `InputError` for a sensor that is none."""
    require_kind("plot", "study", study, Study)
    if isinstance(sensor, str):
        sensor = study.rig[choice("plot", "sensor", sensor, [s.name for s in study.rig])]
    require_kind("plot", "sensor", sensor, Sensor)
    if not isinstance(sensor.model, Lidar):
        found = f"{shown(sensor.name)}, a sensor of kind {sensor.kind!r}"
        raise InputError("plot", "sensor", "a LiDAR, which has beams", found)
    return sensor


def compare(scores: Mapping[str, Score], *, axes: Axes | None = None) -> Axes:
    """Draw the entropy of several scores: of the rig, by zone, and by class.

    Parameters
    ----------
    scores : mapping of str to Score
        By the name that the legend has.
    """
    if not isinstance(scores, Mapping) or not all(isinstance(s, Score) for s in scores.values()):
        raise InputError("plot", "scores", "scores by name", shown(scores))
    if not scores:
        raise InputError("plot", "scores", "at least one score", "none")
    tables = [_entropies(score) for score in scores.values()]
    names = list(dict.fromkeys(name for table in tables for name in table))
    axes = _axes(axes, (8.0, 0.9 + 0.27 * len(names)))
    rows = np.arange(len(names))
    values = np.array([[table.get(name, np.nan) for name in names] for table in tables])
    low = np.nanmin(values, axis=0)
    high = np.nanmax(values, axis=0)
    axes.hlines(rows, low, high, color=GREY, lw=1.5, alpha=0.6, zorder=1)
    for number, (name, row) in enumerate(zip(scores, values, strict=True)):
        color = PALETTE[number % len(PALETTE)]
        axes.plot(row, rows, "o", color=color, mec="white", ms=8, label=_plain(name))
    axes.set(
        yticks=rows, yticklabels=[*map(_plain, names)], xlabel="entropy [nats], lower is better"
    )
    axes.invert_yaxis()
    axes.grid(axis="x", alpha=0.3)
    return _with_legend(axes)


def _entropies(score: Score) -> dict[str, float]:
    """Return entropies by row: of the rig, its zones and classes [nats]."""
    parts: dict[str, PartScore] = {**score.per_zone, **score.per_class}
    return {"rig": score.entropy, **{name: part.entropy for name, part in parts.items()}}


def _plain(name: str) -> str:
    """Return a name as a text that matplotlib does not take for mathematics."""
    return name.replace("$", r"\$")


def _axes(axes: Axes | None, size: tuple[float, float]) -> Axes:
    """Return the given axes, or those of a new figure."""
    required_package("matplotlib")
    if axes is not None:
        return axes
    import matplotlib.pyplot as plt

    made: Axes = plt.subplots(figsize=size, layout="constrained")[1]
    return made


def _with_legend(axes: Axes, **style: Any) -> Axes:
    """Put a legend to the right of axes, and leave the upper and right line of the frame out."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, **style)
    axes.spines[["top", "right"]].set_visible(False)
    return axes


def _draw_body(axes: Axes, vehicle: Vehicle, view: str) -> None:
    """Draw the triangles, the farthest first, lighter the more they face the reader."""
    right, up, depth, sign = VIEWS[view]
    corners = vehicle.triangles
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    facing = np.abs(normals[:, depth]) / np.where(lengths > 0.0, lengths, 1.0)
    order = np.argsort(sign * corners[:, :, depth].mean(axis=1))
    grey = (DARK + (LIGHT - DARK) * facing[order])[:, None].repeat(3, axis=1)
    style = {"facecolor": grey, "edgecolor": "face", "linewidth": 0.3}
    _add_triangles(axes, corners[order][:, :, (right, up)], style)


def _add_triangles(axes: Axes, corners: Floats, style: Mapping[str, Any]) -> None:
    from matplotlib.collections import PolyCollection

    axes.add_collection(PolyCollection(list(corners), **style))
