"""The plots of our own study: AP against scores, drawn from saved results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from ..plotting import BLUE, GREY, ORANGE, pyplot, remove_frame, save_plot, styled
from .analysis import DesignResults, Results, design_of_cameras, designs_of
from .page import Study, plot_name
from .pictures import Renderer
from .plan import CAMERAS, OWN, Plan
from .scores import COMPARED, EXPECTED_AP, HEIGHT, PRIMARY

plt = pyplot()

SHOWN = (PRIMARY, EXPECTED_AP, HEIGHT)
LABELS = ("perception entropy [nats]", "expected AP in traffic", "mean height [m]")
COLORS = (BLUE, ORANGE)
CURVES = ("shipped", "scans")
CURVE_LABELS = ("shipped curves", "from scans")
SHOWN_SCENE = ("test", 0)
"""Split and number of the scene whose pictures are shown."""


def draw_all(study: Study, folder: Path, scores: Results) -> None:
    """Draw the plots of the study of LiDARs."""
    for design in designs_of(study.plans[OWN], study.runs[OWN]):
        if design.has_figures:
            ap_against_scores(folder / plot_name(design.name), study.plans[OWN], design, scores)
    if classes := study.found[OWN]["ap_curves"]["classes"]:
        expected_against_found(folder / "ap_curves.png", classes)


def draw_cameras(study: Study, folder: Path, scores: Results) -> None:
    """Draw the plots of the study of cameras."""
    design = design_of_cameras(study.plans[CAMERAS], study.runs[CAMERAS])
    scene = Renderer(study.plans[CAMERAS], design.chosen[0]).pictures(*SHOWN_SCENE)
    pictures_of_scene(folder / "pictures.png", scene.pictures)
    if design.has_figures:
        ap_against_scores(folder / plot_name(CAMERAS), study.plans[CAMERAS], design, scores)


@styled
def ap_against_scores(path: Path, plan: Plan, design: DesignResults, scores: Results) -> None:
    """Draw AP against three scores: a dot a placement, a bar from lowest to highest seed."""
    figure, axes = plt.subplots(1, 3, figsize=(9.4, 3.3), sharey=True, layout="constrained")
    chosen = {s.name: s for s in COMPARED}
    for panel, name, label in zip(axes, SHOWN, LABELS, strict=True):
        sign = -1.0 if name == PRIMARY else 1.0
        values = [sign * chosen[name].value(p, scores[p.name]) for p in design.chosen]
        _panel(panel, plan, design, np.array(values))
        panel.set_xlabel(label)
    axes[0].invert_xaxis()  # the better, the further right, as in the other panels
    axes[0].set_ylabel("mean AP of five classes")
    axes[0].legend(loc="best", frameon=False, handletextpad=0.1)
    save_plot(figure, path)


def _panel(panel: Axes, plan: Plan, design: DesignResults, values: np.ndarray) -> None:
    aps = design.samples.aps
    mean = design.samples.ap
    for vehicle, color in zip(plan.vehicles, COLORS, strict=False):
        index = np.flatnonzero(design.samples.groups == vehicle)
        low = aps[index].min(axis=1)
        high = aps[index].max(axis=1)
        panel.vlines(values[index], low, high, color=color, lw=1.0, alpha=0.5)
        panel.plot(values[index], mean[index], "o", color=color, ms=4.5, label=vehicle)
    remove_frame(panel)


@styled
def pictures_of_scene(path: Path, pictures: NDArray[np.uint8]) -> None:
    """Draw the pictures (S, W, H, 3) of a scene, two beside each other."""
    count, width, height, _ = pictures.shape
    rows = -(-count // 2)
    size = 9.4, rows * 9.4 / 2.0 * height / width + 0.1
    figure, axes = plt.subplots(rows, 2, figsize=size, layout="constrained", squeeze=False)
    for panel, picture in zip(axes.flat, pictures, strict=True):
        panel.imshow(picture.transpose(1, 0, 2), interpolation="nearest")
        panel.set_axis_off()
    save_plot(figure, path)


@styled
def expected_against_found(path: Path, classes: Mapping[str, dict[str, Any]]) -> None:
    """Draw expected AP against the AP found, by class, with the shipped and the fitted curves."""
    size = 9.4, 2.4
    figure, axes = plt.subplots(1, len(classes), figsize=size, sharey=True, layout="constrained")
    for panel, (name, row) in zip(axes, classes.items(), strict=True):
        panel.plot([0.0, 1.0], [0.0, 1.0], color=GREY, lw=0.8, ls="--")
        for model, color, label in zip(CURVES, (GREY, BLUE), CURVE_LABELS, strict=True):
            panel.plot(row["found"], row["expected"][model], "o", color=color, ms=4, label=label)
        panel.set_title(name)
        panel.set_xlim(0.0, 1.0)
        panel.set_ylim(0.0, 1.0)
        remove_frame(panel)
    axes[0].set_ylabel("expected AP in traffic")
    axes[-1].legend(loc="lower right", frameon=False, handletextpad=0.1)
    axes[len(axes) // 2].set_xlabel("AP found")
    save_plot(figure, path)
