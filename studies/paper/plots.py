"""The plots of the page, drawn from results.json alone, but for the outlines of the vehicles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D

import pe_core as pe
from pe_core.base import Floats

from ..plotting import (
    BLUE,
    GREY,
    ORANGE,
    PALETTE,
    SKY,
    VERMILION,
    pyplot,
    remove_frame,
    save_plot,
    shortened,
    styled,
)
from .findings import Findings
from .paper import PRIORS, ROW, ROWS, Row, study_of

plt = pyplot()

HFOV_COLORS = {30: SKY, 60: BLUE, 120: ORANGE}
PRINTED_60 = ROW["2_60deg"].entropy
VIEWS = ((0, 1), (0, 2))
"""Axes of the vehicle that are right and up in a view: from above, and from the right side."""
MARGIN_M = (0.75, 0.3, 0.3)
WIDTH_IN = 6.4
"""Margin around vehicle and sensors along x, y, z; width of the picture."""
DARKEST = 0.72
LIGHTEST = 0.93
"""Greys of the vehicle's triangles: facing sideways, and facing the viewer."""
PITCH_LINE_M = 0.7
"""Length of the line that shows where a sensor's x axis points."""


def draw_all(findings: Findings, folder: Path) -> None:
    """Draw every plot of the page."""
    values = findings.values
    priors(folder / "priors.png", values)
    rows(folder / "rows.png", values)
    pitch(folder / "pitch.png", findings.with_prefix("pitch/"))
    sensitivity(folder / "sensitivity.png", findings.with_prefix("vary/"))
    bounds(folder / "camera_bound.png", values)
    draw_ap_curves(folder / "ap_curves.png", findings.with_prefix("fit/"))
    for row in ROWS:
        ends = [search["placements"] for search in findings.searches(row.name)]
        draw_placements(folder / f"placements_{row.name}.png", row, ends)


@styled
def priors(path: Path, values: Mapping[str, Any]) -> None:
    """Draw the density of each prior: over the ground, and over height."""
    figure, axes = plt.subplots(
        len(PRIORS), 2, figsize=(9.0, 8.4), width_ratios=(4.2, 1), layout="constrained"
    )
    maps = {name: np.array(values[f"prior/{name}"]["ground"]) for name in PRIORS}
    for (left, right), (name, ground) in zip(axes, maps.items(), strict=True):
        colors = {"origin": "lower", "cmap": "cividis", "vmin": 0.0, "vmax": 1e6 * ground.max()}
        if np.ptp(ground) == 0.0:
            colors["vmax"] *= 2.0  # a uniform prior has the colour in the middle of the map
        image = left.imshow(1e6 * ground.T, extent=(-80, 80, -40, 40), **colors)
        classes = ", ".join(values[f"prior/{name}"]["classes"])
        title = shortened(f"{name}: {classes}" if name != "uniform" else name)
        left.set_title(title, loc="left", parse_math=False)
        left.set_ylabel("y [m]")
        figure.colorbar(image, ax=left, pad=0.01, label="10⁻⁶ / m²")
        height = values[f"prior/{name}"]
        right.plot(height["height"], height["height_m"], color=BLUE)
        right.set(xlim=(0, None), ylim=(0, 5), ylabel="z [m]")
        remove_frame(right)
    axes[-1][0].set_xlabel("x, forward [m]")
    axes[-1][1].set_xlabel("density [1/m]")
    save_plot(figure, path)


@styled
def rows(path: Path, values: Mapping[str, Any]) -> None:
    """Draw every row: the printed figure, and ours at the printed placement under each prior."""
    figure, axes = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
    at = np.arange(len(ROWS))[::-1]
    axes.plot([r.entropy for r in ROWS], at, "D", color="black", label="paper", ms=7)
    for color, marker, prior in zip(PALETTE, "os^", PRIORS, strict=False):
        ours = [values[f"printed/{row.name}/{prior}"]["entropy"] for row in ROWS]
        axes.plot(ours, at, marker, color=color, label=prior, ms=7, ls="none")
    axes.set_yticks(at, [f"{row.experiment}  {row.label}" for row in ROWS])
    axes.set_xlabel("perception entropy at the printed placement [nats], lower is better")
    axes.grid(axis="both", alpha=0.3)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4, frameon=False)
    remove_frame(axes)
    save_plot(figure, path)


@styled
def pitch(path: Path, by_difference: Mapping[str, Any]) -> None:
    """Draw PE against the pitch difference of two equal LiDARs."""
    curve = sorted((float(k), v) for k, v in by_difference.items())
    x = [k for k, _ in curve]
    figure, (alone, fused) = plt.subplots(
        2, 1, figsize=(7.5, 5.0), sharex=True, height_ratios=(1, 2), layout="constrained"
    )
    lines = {"lidar_a": (GREY, "first, level"), "lidar_b": (ORANGE, "second, pitched")}
    for name, (color, label) in lines.items():
        alone.plot(x, [v["alone"][name] for _, v in curve], color=color, label=label)
    alone.set_title("each alone", loc="left")
    alone.legend(frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1, 1))
    fused.plot(x, [v["entropy"] for _, v in curve], color=BLUE, lw=1.8)
    fused.set_title("early fusion of both", loc="left")
    fused.set(xlabel="pitch difference [deg], positive: the second looks down", xlim=(-2, 2))
    for axes in (alone, fused):
        axes.set_ylabel("entropy [nats]")
        axes.grid(alpha=0.3)
        remove_frame(axes)
    save_plot(figure, path)


@styled
def sensitivity(path: Path, varied: Mapping[str, Any]) -> None:
    """Draw both rows of experiment 1, with one setting changed at a time."""
    settings = list(dict.fromkeys(name.rsplit("/", 1)[0] for name in varied))
    settings.sort(key=lambda s: varied[f"{s}/1_hdl64e"]["entropy"])
    figure, axes = plt.subplots(figsize=(8.0, 1.6 + 0.32 * len(settings)), layout="constrained")
    at = np.arange(len(settings))[::-1]
    ends = []
    for row, color, marker in (("1_pandar64", BLUE, "o"), ("1_hdl64e", VERMILION, "s")):
        ends.append([varied[f"{s}/{row}"]["entropy"] for s in settings])
        axes.plot(ends[-1], at, marker, color=color, label=ROW[row].label, ls="none")
        axes.axvline(ROW[row].entropy, color=color, lw=1, ls="--")
    axes.hlines(at, *ends, color=GREY, lw=1, zorder=0)
    axes.set_yticks(at, settings)
    axes.set_xlabel("perception entropy at the printed placement [nats]; dashed: as printed")
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=2)
    axes.grid(axis="x", alpha=0.3)
    remove_frame(axes)
    save_plot(figure, path)


@styled
def bounds(path: Path, values: Mapping[str, Any]) -> None:
    """Draw the lowest entropy that a voxel can have in a camera, by its distance."""
    figure, axes = plt.subplots(figsize=(7.5, 4.0), layout="constrained")
    for hfov, color in HFOV_COLORS.items():
        curve = values[f"bound_curve/{hfov}"]
        axes.plot(curve["distance_m"], curve["entropy"], color=color, label=f"{hfov} deg")
    axes.axhline(PRINTED_60, color="black", lw=1, ls="--")
    label = f"printed for 60 deg: {PRINTED_60}"
    below = {"textcoords": "offset points", "va": "top"}
    axes.annotate(label, (80, PRINTED_60), (0, -4), ha="right", **below)
    axes.set(xlabel="distance from the camera [m]", xlim=(0, 80))
    axes.set_ylabel("least entropy of a voxel [nats]")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False, title="horizontal field of view", loc="upper left")
    remove_frame(axes)
    save_plot(figure, path)


@styled
def draw_placements(path: Path, row: Row, ends: Sequence[Mapping[str, Any]]) -> None:
    """Draw a row: the paper's sensors as hollow marks, those at the end of searches as filled ones.

    `ends` has the placement at the end of each search: position and rotation by sensor.
    """
    study = study_of(row.name)
    assert study.vehicle is not None
    low, high = _extent(study, ends)
    length, width, height = high - low
    scale = WIDTH_IN / length
    size = (WIDTH_IN + 1.0, (width + height) * scale + 1.6)
    heights = (width, height)
    layout: dict[str, Any] = {"sharex": True, "layout": "constrained", "height_ratios": heights}
    figure, axes = plt.subplots(2, 1, figsize=size, **layout)
    for view, axis in zip(axes, VIEWS, strict=True):
        faces, shades = _visible_faces(study.vehicle.triangles, axis)
        view.add_collection(PolyCollection(faces, facecolors=shades, edgecolors="face", lw=0.2))
        for color, sensor in zip(PALETTE, study.rig, strict=False):
            for placement in ends:
                pose = placement[sensor.name]
                _mark(view, pose["position"], pose["rotation"], axis, color=color, filled=True)
            _mark(
                view,
                sensor.pose.position,
                sensor.pose.rotation_deg,
                axis,
                color=color,
                filled=False,
            )
        view.set(xlim=(low[0], high[0]), ylim=(low[axis[1]], high[axis[1]]), aspect="equal")
        remove_frame(view)
    axes[0].set_ylabel("y, left [m]")
    axes[1].set(ylabel="z, up [m]", xlabel="x, forward [m]")
    place = {"loc": "lower left", "bbox_to_anchor": (0, 1), "ncols": 5, "frameon": False}
    axes[0].legend(handles=_key(study), columnspacing=1.2, handletextpad=0.3, **place)
    figure.align_ylabels(axes)
    save_plot(figure, path)


def _extent(study: pe.Study, ends: Sequence[Mapping[str, Any]]) -> tuple[Floats, Floats]:
    """Return the lowest and the highest corner (3,) of vehicle and sensors [m], with a margin."""
    assert study.vehicle is not None
    points = [np.asarray(p) for p in (*study.vehicle.bounds, *(s.pose.position for s in study.rig))]
    points += [np.asarray(pose["position"]) for placement in ends for pose in placement.values()]
    return np.min(points, axis=0) - MARGIN_M, np.max(points, axis=0) + MARGIN_M


def _key(study: pe.Study) -> list[Line2D]:
    """Return the key: the colours of the sensors, and the two kinds of marks."""
    colors = zip(PALETTE, study.rig, strict=False)
    sensors = [_dot(color, s.name.replace("_", " "), filled=True) for color, s in colors]
    return [*sensors, _dot("black", "paper", filled=False)]


def _dot(color: str, label: str, *, filled: bool) -> Line2D:
    face, size = (color, 5) if filled else ("none", 10)
    return Line2D([], [], marker="o", ls="none", color=color, mfc=face, ms=size, label=label)


def _visible_faces(triangles: Floats, axis: tuple[int, int]) -> tuple[list[Floats], list[str]]:
    """Return triangles as seen along the third axis, the nearest last, and their shades of grey."""
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
    """Draw a sensor; in the view from the side, a line shows its pitch."""
    u, v = (position[k] for k in axis)
    if filled:
        view.plot([u], [v], "o", color=color, ms=5, alpha=0.85, mec="white", mew=0.5, zorder=3)
    else:
        view.plot([u], [v], "o", color=color, mfc="none", ms=11, mew=1.8, zorder=4)
    if axis == (0, 2):
        pitch = np.radians(rotation[1])
        yaw = np.radians(rotation[2])
        tip = u + PITCH_LINE_M * np.cos(pitch) * np.cos(yaw), v - PITCH_LINE_M * np.sin(pitch)
        view.plot([u, tip[0]], [v, tip[1]], color=color, lw=1, ls="-" if filled else ":", zorder=2)


@styled
def draw_ap_curves(path: Path, fits: Mapping[str, Any]) -> None:
    """Draw AP against the measurement, a panel for each fit: points, curve, points left out. `fits`
    has the data of `fit_data` by the name of the panel."""
    size = (0.6 + 3.0 * len(fits), 3.4)
    layout: dict[str, Any] = {"sharey": True, "layout": "constrained", "squeeze": False}
    figure, grid = plt.subplots(1, len(fits), figsize=size, **layout)
    for axes, (name, fit) in zip(grid[0], fits.items(), strict=True):
        _draw_ap_curve(axes, fit)
        axes.set_title(shortened(name.replace("_", " ")), loc="left", parse_math=False)
    grid[0][0].set_ylabel("AP")
    marks = [
        plt.Line2D([], [], marker="o", color=BLUE, ls="none", label="taken"),
        plt.Line2D([], [], marker="o", color=GREY, mfc="none", ls="none", label="left out"),
    ]
    figure.legend(handles=marks, frameon=False, loc="outside upper right", ncols=2)
    save_plot(figure, path)


def _draw_ap_curve(axes: Axes, fit: Mapping[str, Any]) -> None:
    m = np.array(fit["m"])
    ap = np.array(fit["ap"])
    used = np.array([not why for why in fit["left_out"]])
    x = np.geomspace(m[m > 0].min() / 1.5, m.max() * 1.5, 200)
    axes.plot(x, np.clip(fit["a"] * np.log(x) + fit["b"], 0.001, 0.999), color=ORANGE)
    axes.plot(m[used], ap[used], "o", color=BLUE)
    axes.plot(m[~used], ap[~used], "o", color=GREY, mfc="none")
    axes.set(xscale="log", ylim=(-0.03, 1.03), xlabel="measurement a voxel, m")
    label = f"a = {fit['a']:.3f} ± {fit['a_error']:.3f}\nb = {fit['b']:.3f} ± {fit['b_error']:.3f}"
    axes.text(0.97, 0.04, label, transform=axes.transAxes, va="bottom", ha="right")
    axes.grid(alpha=0.3)
    remove_frame(axes)
