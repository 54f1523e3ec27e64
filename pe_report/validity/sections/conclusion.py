"""What is supported, and what is not."""

from __future__ import annotations

from ...words import joined
from ..facts import LEVEL_5, MAIN_CLASS, ValidityFacts, classes
from ..published import papers


def conclusion(facts: ValidityFacts) -> str:
    """Return the conclusion."""
    return f"""
## What this supports, and what it does not

{_supported(facts)}
{_ours(facts)}
{_height(facts)}
{_classes(facts)}
- **Not touched by any of this**: placements far from a roof (all of these sit within a metre of
one another on a roof rack), LiDARs with other channels, real roads, and differences within a few
centimetres. A score may be right about those, or wrong.
- **What one may do with the scores meanwhile**: read them for what they are, beams and pixels on
voxels or objects under a stated prior, with the maps of what is not seen; not as a promise of AP.
"""


def _supported(facts: ValidityFacts) -> str:
    always, sometimes = facts.told_apart(), facts.sometimes()
    limit = f"{LEVEL_5:.0%} after Holm's correction"
    if always:
        told = f"- **Told from chance over both papers** ({limit}, however rolls are taken): {joined(always)}."
    else:
        told = f"- **Told from chance over both papers** ({limit}, however rolls are taken): none."
    if sometimes:
        told += f" In some of the ways only: {joined(sometimes)}."
    return facts.say("conclusion: supported", told)


def _ours(facts: ValidityFacts) -> str:
    rows = facts.tested(facts.ways[0])
    known = [row for row in rows if row["mean"] is not None]
    best = max(known, key=lambda row: row["mean"])
    least = min(known, key=lambda row: row["mean"])
    both = [r["score"] for r in known if min(r["rho"]) > 0.0]
    forwards = joined(both) if both else "none"
    told = (
        f"- **Between the scores**: mean rho goes from {least['mean']:+.2f} ({least['score']}) to "
        f"{best['mean']:+.2f} ({best['score']}); the right way round in both papers: {forwards}. With so few "
        "placements these differences are themselves within what chance does: the order of the "
        "scores is no finding."
    )
    return facts.say("conclusion: ours", told)


def _height(facts: ValidityFacts) -> str:
    rho = [facts.rho(paper, MAIN_CLASS, "mean height")["mean"] for paper in papers()]
    if rho[0] * rho[1] >= 0.0:
        return facts.say("conclusion: height", "- **Height** points the same way in both papers.")
    told = (
        "- **Height** points opposite ways in the two papers. In the second one the tallest layout "
        "stacks four LiDARs on one mast, 20 cm apart: height and having all eyes in one place "
        "cannot be told apart there, and neither can anything that goes with them."
    )
    return facts.say("conclusion: height", told)


def _classes(facts: ValidityFacts) -> str:
    grey = [
        f"{paper.classes[cls]} in {paper.short}"
        for paper in papers()
        for cls in classes()
        if facts.greyed(facts.correlated(paper, cls)[0])
    ]
    if not grey:
        return facts.say(
            "conclusion: classes", "- **By class**: the detectors agree in all of them."
        )
    told = (
        f"- **By class**: the detectors do not agree among themselves on {joined(grey)}. No score "
        "can be right or wrong about what they do not share."
    )
    return facts.say("conclusion: classes", told)
