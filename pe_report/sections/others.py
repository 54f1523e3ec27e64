"""The AP curve and the priors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pe_core.metric import POINTPILLARS

from ..facts import Facts
from ..plan import FITS
from ..words import joined, table

CLASSES = ("pedestrian", "cyclist", "car")
OWN = "paper_lidar"
"""Points made from the paper's curve."""
EXACT = 1e-6
A, B = POINTPILLARS.a, POINTPILLARS.b


def ap_curve(facts: Facts) -> str:
    """Return fits of the AP curve."""
    lines = []
    for name in FITS:
        fit = facts[f"fit/{name}"]
        used = sum(not why for why in fit["left_out"])
        lines.append(
            [
                name.replace("_", " "),
                f"{fit['a']:.3f} ± {fit['a_error']:.3f}",
                f"{fit['b']:.3f} ± {fit['b_error']:.3f}",
                f"{used} of {len(fit['m'])}",
                f"{fit['rms']:.3f}",
            ]
        )
    return f"""
## The AP curve

The paper fits AP = {A} ln m + {B} to PointPillars on KITTI. Its points are not public. `pe fit` on
public detections of another LiDAR detector, PointRCNN, on KITTI tracking, by class; and on points
made from the paper's own curve, which it {_gives_back(facts)}:

{table(["points", "a", "b", "points taken", "rms of AP"], lines)}

![AP against measurement](ap_curves.png)

{_slopes(facts)} {_saturated(facts)} The detector had seen drives that overlap these, so AP is on the high side.
"""


def _gives_back(facts: Facts) -> str:
    fit = facts[f"fit/{OWN}"]
    exact = abs(fit["a"] - A) <= EXACT and abs(fit["b"] - B) <= EXACT
    return facts.say("fit: own points", "gives back" if exact else "does not give back")


def _slope(fit: Mapping[str, Any]) -> str:
    """Return how a fitted slope compares with the paper's, within its standard error."""
    if abs(fit["a"] - A) <= fit["a_error"]:
        return "agree with the paper's slope within the error"
    return "have a steeper slope" if fit["a"] > A else "have a flatter slope"


def _slopes(facts: Facts) -> str:
    words = {name: _slope(facts[f"fit/kitti_{name}"]) for name in CLASSES}
    told = [
        f"{joined([f'{name}s' for name in CLASSES if words[name] == word])} {word}"
        for word in dict.fromkeys(words.values())
    ]
    text = facts.say("fit: slopes", "; ".join(told))
    return f"{text[:1].upper()}{text[1:]}."


def _saturated(facts: Facts) -> str:
    """Say which classes saturate, and from which measurement on."""
    found = []
    for name in CLASSES:
        fit = facts[f"fit/kitti_{name}"]
        pairs = zip(fit["m"], fit["left_out"], strict=True)
        first = min((m for m, why in pairs if why == "saturated"), default=None)
        if first is not None:
            found.append(f"{name}s from m = {first:.1f} on")
    told = f"AP saturates for {joined(found)}." if found else "AP saturates for none of them."
    return facts.say("fit: saturated", told)


def priors(facts: Facts) -> str:
    """Return the priors' plot."""
    return """
## The priors

![Density over the ground and over height](priors.png)

Left over the ground, right over height; on scales of their own. [metric.md](../metric.md#the-prior) has
their constants and sources.
"""
