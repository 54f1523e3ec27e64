"""The section of the page on cameras, from saved results alone; its verdict is computed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ...published.correlations import min_significant_rho
from ...published.findings import p_text, rho_text
from ...wording import table
from ..analysis import CAMERAS, HOLDS, OPEN, REFUTED, UNDECIDED
from ..study_page import plot_name, rho_with_interval, trainings_text
from .plan import CameraPlan
from .study import is_too_noisy

Json = dict[str, Any]

TITLE = "## Cameras"
PICTURES = "pictures.png"
SHOWN_SCENE = ("test", 0)
"""Split and number of the scene whose pictures are shown."""


def camera_section(plan: CameraPlan, found: Json, runs: Mapping[str, Json]) -> str:
    """Return the section of the page.

    Parameters
    ----------
    plan : CameraPlan
    found : mapping
        The analysis.
    runs : mapping
        Results by the name of the run.
    """
    model, count = plan.model, plan.count[True] + plan.count[False]
    state = f"{found['done']} of {found['planned']} runs"
    head = f"""
{TITLE}

A bounded look, by a plan of its own: [cameras](cameras.md). {count} placements of {plan.cameras} cameras ({model.width} x
{model.height} pixels, {math.degrees(model.hfov):g} degrees) on the {plan.vehicle}, {plan.count[True]} of which see all round; pictures by the engine's own rays;
a small detector that lifts features of the pictures to the ground. {state} are done. **{_answer(plan, found)}**
"""
    return (
        head + _pictures(plan) + _figures(found) + (f"\n{trainings_text(runs)}\n" if runs else "")
    )


def _pictures(plan: CameraPlan) -> str:
    split, number = SHOWN_SCENE
    return f"""
![Four small pictures of cars, people and other things]({CAMERAS}/{PICTURES})

*What a detector is given: scene {number} of the {split}, at the first placement.*
"""


def _answer(plan: CameraPlan, found: Json) -> str:
    verdict, score = found["verdict"], plan.study.statistics.primary
    if verdict == UNDECIDED:
        return f"It says nothing about {score}: {_why_nothing(plan, found)}."
    if verdict == OPEN and found["done"] == found["planned"]:
        return "There are too few placements for a statement."
    return {
        OPEN: "There is no statement before all runs are done.",
        HOLDS: f"The better-scored placement finds more ({score}).",
        REFUTED: f"The better-scored placement finds less ({score}).",
    }[verdict]


def _why_nothing(plan: CameraPlan, found: Json) -> str:
    if is_too_noisy(plan, found):
        return (
            f"the two seeds of a placement agree too little (rho {rho_text(found['seed_rho'])}, wanted "
            f"{plan.min_seed_rho:g}) or too little is found (mean AP {found['mean_ap']:.3f}, wanted {plan.min_ap:g})"
        )
    smallest = min_significant_rho(found["placements"])
    limit = "" if smallest is None else f", and only rho from {smallest:.2f} on would be one"
    return (
        f"over {found['placements']} placements its correlation with AP is not significant{limit}"
    )


def _figures(found: Json) -> str:
    if not found["scores"]:
        return "\n" + ("Too few for figures.\n" if found["done"] else "")
    lowest, middle, highest = found["ap"]
    so_far = "" if found["done"] == found["planned"] else " These are figures so far."
    noise = "-" if found["noise"] is None else f"{found['noise']:.4f}"
    lines = [
        [
            score,
            rho_with_interval(row),
            p_text(row["p"]),
            _holm(row),
            rho_text(found["all_round"].get(score)),
        ]
        for score, row in found["scores"].items()
    ]
    titles = ["score", "rho (95 %)", "p", "p after Holm", "rho, all round only"]
    return f"""
AP from {lowest:.3f} by {middle:.3f} (median) to {highest:.3f}, seeds averaged: {found["seeds"]}. Standard deviation over the seeds:
{noise}; rho of the AP of both seeds: {rho_text(found["seed_rho"])}.{so_far}

{table(titles, lines)}

![AP against scores]({CAMERAS}/{plot_name(CAMERAS)})

*A dot is a placement; a bar reaches from its lowest to its highest seed.*
"""


def _holm(row: Json) -> str:
    return p_text(row["holm"]) if "holm" in row else "-"
