"""The plots: drawn from results.json alone, but for the vehicles' outlines."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from .facts import Facts
from .paper import PRIORS, ROW, ROWS
from .placements import draw_placements
from .style import BLUE, GREY, ORANGE, PALETTE, SKY, VERMILION, finished, save, style
from .words import one_line

HFOV_COLORS = {30: SKY, 60: BLUE, 120: ORANGE}
PRINTED_60 = ROW["2_60deg"].entropy


def draw_all(data: Mapping[str, Any], folder: Path) -> None:
    """Draw every plot of the page."""
    facts = Facts(data)
    values = facts.values
    priors(folder / "priors.png", values)
    rows(folder / "rows.png", values)
    pitch(folder / "pitch.png", values)
    sensitivity(folder / "sensitivity.png", values)
    bounds(folder / "camera_bound.png", values)
    ap_curves(folder / "ap_curves.png", facts.named("fit/"))
    for row in ROWS:
        found = facts.ends(row.name) if facts.searched(row.name) else []
        draw_placements(folder / f"placements_{row.name}.png", row, found)


def _named(values: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    return {k.removeprefix(prefix): v for k, v in values.items() if k.startswith(prefix)}


@style
def priors(path: Path, values: Mapping[str, Any]) -> None:
    """Where each prior expects objects: over the ground, and over height."""
    figure, axes = plt.subplots(
        len(PRIORS), 2, figsize=(9.0, 8.4), width_ratios=(4.2, 1), layout="constrained"
    )
    maps = {name: np.array(values[f"prior/{name}"]["ground"]) for name in PRIORS}
    for (left, right), (name, ground) in zip(axes, maps.items(), strict=True):
        shown = {"origin": "lower", "cmap": "cividis", "vmin": 0.0, "vmax": 1e6 * ground.max()}
        if np.ptp(ground) == 0.0:
            shown["vmax"] *= 2.0  # an even prior in a colour of the middle
        image = left.imshow(1e6 * ground.T, extent=(-80, 80, -40, 40), **shown)
        classes = ", ".join(values[f"prior/{name}"]["classes"])
        title = one_line(f"{name}: {classes}" if name != "uniform" else name)
        left.set_title(title, loc="left", parse_math=False)
        left.set_ylabel("y [m]")
        figure.colorbar(image, ax=left, pad=0.01, label="10⁻⁶ / m²")
        height = values[f"prior/{name}"]
        right.plot(height["height"], height["height_m"], color=BLUE)
        right.set(xlim=(0, None), ylim=(0, 5), ylabel="z [m]")
        finished(right)
    axes[-1][0].set_xlabel("x, forward [m]")
    axes[-1][1].set_xlabel("density [1/m]")
    save(figure, path)


@style
def rows(path: Path, values: Mapping[str, Any]) -> None:
    """Every row: as printed, and ours at the printed placement under each prior."""
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
    finished(axes)
    save(figure, path)


@style
def pitch(path: Path, values: Mapping[str, Any]) -> None:
    """PE against the pitch difference of two equal LiDARs."""
    curve = sorted((float(k), v) for k, v in _named(values, "pitch/").items())
    x = [k for k, _ in curve]
    figure, (alone, fused) = plt.subplots(
        2, 1, figsize=(7.5, 5.0), sharex=True, height_ratios=(1, 2), layout="constrained"
    )
    for name, color, label in (
        ("lidar_a", GREY, "first, level"),
        ("lidar_b", ORANGE, "second, pitched"),
    ):
        alone.plot(x, [v["alone"][name] for _, v in curve], color=color, label=label)
    alone.set_title("each alone", loc="left")
    alone.legend(frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1, 1))
    fused.plot(x, [v["entropy"] for _, v in curve], color=BLUE, lw=1.8)
    fused.set_title("early fusion of both", loc="left")
    fused.set(xlabel="pitch difference [deg], positive: the second looks down", xlim=(-2, 2))
    for axes in (alone, fused):
        axes.set_ylabel("entropy [nats]")
        axes.grid(alpha=0.3)
        finished(axes)
    save(figure, path)


@style
def sensitivity(path: Path, values: Mapping[str, Any]) -> None:
    """Both rows of experiment 1, one thing changed at a time."""
    varied = _named(values, "vary/")
    settings = list(dict.fromkeys(name.rsplit("/", 1)[0] for name in varied))
    settings.sort(key=lambda s: varied[f"{s}/1_hdl64e"]["entropy"])
    figure, axes = plt.subplots(figsize=(8.0, 1.6 + 0.32 * len(settings)), layout="constrained")
    at = np.arange(len(settings))[::-1]
    for row, color, marker in (("1_pandar64", BLUE, "o"), ("1_hdl64e", VERMILION, "s")):
        ours = [varied[f"{s}/{row}"]["entropy"] for s in settings]
        axes.plot(ours, at, marker, color=color, label=ROW[row].label, ls="none")
        axes.axvline(ROW[row].entropy, color=color, lw=1, ls="--")
    low, high = (
        [varied[f"{s}/{row}"]["entropy"] for s in settings] for row in ("1_pandar64", "1_hdl64e")
    )
    axes.hlines(at, low, high, color=GREY, lw=1, zorder=0)
    axes.set_yticks(at, settings)
    axes.set_xlabel("perception entropy at the printed placement [nats]; dashed: as printed")
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=2)
    axes.grid(axis="x", alpha=0.3)
    finished(axes)
    save(figure, path)


@style
def bounds(path: Path, values: Mapping[str, Any]) -> None:
    """The lowest entropy a voxel can have in a camera, by its distance."""
    figure, axes = plt.subplots(figsize=(7.5, 4.0), layout="constrained")
    for hfov, color in HFOV_COLORS.items():
        curve = values[f"bound_curve/{hfov}"]
        axes.plot(curve["distance_m"], curve["entropy"], color=color, label=f"{hfov} deg")
    axes.axhline(PRINTED_60, color="black", lw=1, ls="--")
    axes.annotate(
        f"printed for 60 deg: {PRINTED_60}",
        (80, PRINTED_60),
        (0, -4),
        ha="right",
        va="top",
        textcoords="offset points",
    )
    axes.set(xlabel="distance from the camera [m]", xlim=(0, 80))
    axes.set_ylabel("least entropy of a voxel [nats]")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False, title="horizontal field of view", loc="upper left")
    finished(axes)
    save(figure, path)


@style
def ap_curves(path: Path, fits: Mapping[str, Any]) -> None:
    """AP against measurement: points, the fitted curve, and what was left out."""
    figure, grid = plt.subplots(
        1,
        len(fits),
        figsize=(0.6 + 3.0 * len(fits), 3.4),
        sharey=True,
        layout="constrained",
        squeeze=False,
    )
    for axes, (name, fit) in zip(grid[0], fits.items(), strict=True):
        _ap_curve(axes, fit)
        axes.set_title(one_line(name.replace("_", " ")), loc="left", parse_math=False)
    grid[0][0].set_ylabel("AP")
    marks = [
        Line2D([], [], marker="o", color=BLUE, ls="none", label="taken"),
        Line2D([], [], marker="o", color=GREY, mfc="none", ls="none", label="left out"),
    ]
    figure.legend(handles=marks, frameon=False, loc="outside upper right", ncols=2)
    save(figure, path)


def _ap_curve(axes: Axes, fit: Mapping[str, Any]) -> None:
    m, ap = np.array(fit["m"]), np.array(fit["ap"])
    used = np.array([not why for why in fit["left_out"]])
    x = np.geomspace(m[m > 0].min() / 1.5, m.max() * 1.5, 200)
    axes.plot(x, np.clip(fit["a"] * np.log(x) + fit["b"], 0.001, 0.999), color=ORANGE)
    axes.plot(m[used], ap[used], "o", color=BLUE)
    axes.plot(m[~used], ap[~used], "o", color=GREY, mfc="none")
    axes.set(xscale="log", ylim=(-0.03, 1.03), xlabel="measurement a voxel, m")
    label = f"a = {fit['a']:.3f} ± {fit['a_error']:.3f}\nb = {fit['b']:.3f} ± {fit['b_error']:.3f}"
    axes.text(0.97, 0.04, label, transform=axes.transAxes, va="bottom", ha="right")
    axes.grid(alpha=0.3)
    finished(axes)
