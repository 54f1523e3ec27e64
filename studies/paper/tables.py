"""Sections of the page that are tables: orderings, rows of Table II, fits of the AP curve, priors.

Also what the sections of the experiments share.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pe_core.metric import POINTPILLARS

from ..wording import joined, table
from .claims import TEXTS
from .paper import PRIORS, ROW, ROWS
from .plan import FITS
from .result_view import (
    CLEAR,
    ReproductionResults,
    placement_text,
    printed_placement_text,
    row_label,
)

CLASSES = ("pedestrian", "cyclist", "car")
PAPER_POINTS = "paper_lidar"
"""A table of points on the paper's own curve."""
EXACT = 1e-6
"""A fit to these points that differs by at most this from the paper's curve is exact."""
A, B = POINTPILLARS.a, POINTPILLARS.b


def orderings(results: ReproductionResults) -> str:
    """Return the table of all orderings, and where they hold."""
    lines = []
    for key, text in TEXTS.items():
        printed = [_ordering_cell(results, key, "printed", prior) for prior in PRIORS]
        searched = [_ordering_cell(results, key, "searched", prior) for prior in PRIORS]
        cells = [f"{c} ({p})" for c, p in zip(searched, PRIORS, strict=True) if c]
        lines.append([text, *printed, "; ".join(cells)])
    titles = ["ordering", *(f"printed, {prior}" for prior in PRIORS), "our search"]
    return f"""
## Orderings

{table(titles, lines)}

The first figure of each pair is of the rig that the paper finds better. Priors are compared at the
placements that the paper prints; experiment 4 and "front doubled" have the paper's weights, which are doubled
ahead of the vehicle. Searches differ by chance: *not decided* where two differ by no more than {CLEAR:g} standard
deviations of their difference, from the seeds of their rows.
"""


def _ordering_cell(results: ReproductionResults, key: str, where: str, prior: str) -> str:
    """Return both figures of an ordering, and whether it holds."""
    claim = results.claim(key, where, prior)
    if claim is None:
        return ""
    verdict = "holds" if claim["holds"] else "**does not hold**"
    verdict = verdict if results.is_decided(claim) else "**not decided**"
    text = f"{verdict}: {claim['better_entropy']:.4f}, {claim['worse_entropy']:.4f}"
    return results.verdict(f"table: {key}, {where}, {prior}", text)


def rows(results: ReproductionResults) -> str:
    """Return Table II with our figures."""
    lines = []
    for row in ROWS:
        ours = [
            f"{results.entropy(row.name, p):.4f} ({results[f'printed/{row.name}/{p}']['coverage']:.0%})"
            for p in PRIORS
        ]
        best = f"{results.best(row.name)['entropy']:.4f}" if results.was_searched(row.name) else ""
        mean = results.mean_of_seeds(row.name) if results.was_searched(row.name) else ""
        lines.append([row_label(row.name), f"{row.entropy:.4f}", *ours, best, mean])
    titles = ["row", "paper", *PRIORS, f"best search, {PRIORS[0]}", "mean of the seeds"]
    return f"""
## Table II

Perception entropy [nats] at the placement that the paper prints under each prior, with the share of the
prior that any sensor sees; and the entropy at which Algorithm 1 ends from a neutral start under `{PRIORS[0]}`.

{table(titles, lines)}

![Entropy of each row, the paper's and ours](rows.png)

Filled marks in the pictures below are the sensors at the end of our searches, one mark for each seed; hollow
marks are the paper's sensors. Lines show the direction of a sensor's x axis.
"""


def placements(results: ReproductionResults, names: list[str]) -> str:
    """Return a table of the paper's placements and ours, and their pictures."""
    lines = []
    for name in names:
        ours = ""
        if results.was_searched(name):
            ours = placement_text(results.best(name)["placements"])
        lines.append([row_label(name), printed_placement_text(name), ours])
    titles = ["row", "paper: (x, y, z) m, pitch", "ours, best seed"]
    pictures = "\n".join(
        f"![{ROW[name].label}: the paper's placement and ours](placements_{name}.png)"
        for name in names
    )
    return f"{table(titles, lines)}\n\n{pictures}"


def ordering_verdict(results: ReproductionResults, key: str) -> str:
    """Return whether an ordering is as in the paper, at its placements and in our search."""
    yes, no = results.priors_holding(key, "printed")
    other = "the reverse" if results.is_reversed(key, no) else "not"
    if not no:
        text = "the same under every prior"
    elif yes:
        text = f"the same under {joined(yes)}, {other} under {joined(no)}"
    else:
        text = f"{other} under every prior" if other != "not" else "under no prior the same"
    yes_searched, no_searched = results.priors_holding(key, "searched")
    if yes_searched and not no_searched:
        text += f", {'and' if yes else 'but the same'} in our own search"
    elif no_searched and not yes_searched:
        text += f", {'and' if not yes else 'but'} not in our own search"
    elif not yes_searched and results.claim(key, "searched"):
        text += "; not decided in our own search"
    return results.verdict(f"ordering {key}", f"{text}.")


def ap_curve(results: ReproductionResults) -> str:
    """Return the fits of the AP curve."""
    lines = []
    for name in FITS:
        fit = results[f"fit/{name}"]
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

The paper fits AP = {A} ln m + {B} to PointPillars on KITTI. Its points are not public. The table has the fits of
`pe fit` to public detections of another LiDAR detector, PointRCNN, on KITTI tracking, by class; and to points
on the paper's own curve, which the fit {_exactness(results)}:

{table(["points", "a", "b", "points used", "rms of AP"], lines)}

![AP against measurement](ap_curves.png)

{_slopes(results)} {_saturated(results)} The detector was trained on drives that overlap these, so its AP may be too high.
"""


def _exactness(results: ReproductionResults) -> str:
    fit = results[f"fit/{PAPER_POINTS}"]
    exact = abs(fit["a"] - A) <= EXACT and abs(fit["b"] - B) <= EXACT
    return results.verdict("fit: own points", "reproduces" if exact else "does not reproduce")


def _slope(fit: Mapping[str, Any]) -> str:
    """Return how a fitted slope compares with the paper's, within its standard error."""
    if abs(fit["a"] - A) <= fit["a_error"]:
        return "agree with the paper's slope within the error"
    return "have a steeper slope" if fit["a"] > A else "have a flatter slope"


def _slopes(results: ReproductionResults) -> str:
    words = {name: _slope(results[f"fit/kitti_{name}"]) for name in CLASSES}
    phrases = [
        f"{joined([f'{name}s' for name in CLASSES if words[name] == word])} {word}"
        for word in dict.fromkeys(words.values())
    ]
    text = results.verdict("fit: slopes", "; ".join(phrases))
    return f"{text[:1].upper()}{text[1:]}."


def _saturated(results: ReproductionResults) -> str:
    """Return which classes saturate, and from which measurement on."""
    saturated = []
    for name in CLASSES:
        fit = results[f"fit/kitti_{name}"]
        pairs = zip(fit["m"], fit["left_out"], strict=True)
        first = min((m for m, why in pairs if why == "saturated"), default=None)
        if first is not None:
            saturated.append(f"{name}s from m = {first:.1f} on")
    if saturated:
        text = f"AP saturates for {joined(saturated)}."
    else:
        text = "AP saturates for none of them."
    return results.verdict("fit: saturated", text)


def priors(results: ReproductionResults) -> str:
    """Return the section with the plot of the priors."""
    return """
## The priors

![Density over the ground and over height](priors.png)

Left: density over the ground; right: density over height; each plot has its own scale.
[metric.md](../metric.md#the-prior) has the constants of the priors and their sources.
"""
