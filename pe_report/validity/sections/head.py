"""The title, and the answer in short."""

from __future__ import annotations

from ...words import joined
from ..facts import MAIN_CLASS, ValidityFacts
from ..published import papers

TITLE = "# Do the scores rank placements as detectors do?"


def head(facts: ValidityFacts) -> str:
    """Return the title, and the answer in short."""
    counts = joined([f"{len(p.placements)} placements in {p.short}" for p in papers()])
    return f"""
{TITLE}

A score of a sensor placement is worth something when a detector that is trained and tested with the
better-scored placement finds more. That has been published for few placements: {counts}, each
with four detectors. This page holds the scores of this project against those results. `pe validate`
writes it; every figure is in [results.json](results.json), and every verdict follows from them.

In short: {_told_apart(facts)} {_opposite(facts)} {_height(facts)}
"""


def _told_apart(facts: ValidityFacts) -> str:
    always, sometimes = facts.told_apart(), facts.sometimes()
    if always:
        told = f"**over both papers, {joined(always)} can be told from chance.**"
    elif sometimes:
        told = (
            f"**{joined(sometimes)} can be told from chance, but not however the doubtful "
            "placements are taken.**"
        )
    else:
        told = "**over both papers, no score can be told from chance.**"
    return facts.say("head: told apart", told)


def _opposite(facts: ValidityFacts) -> str:
    names = facts.opposite()
    if not names:
        return facts.say(
            "head: opposite", "No score ranks one paper's cars forwards and the other's backwards."
        )
    total = len(facts.tested(facts.ways[0]))
    return facts.say(
        "head: opposite",
        f"Of {total} scores, {len(names)} rank {MAIN_CLASS}s the right way round in one paper and "
        "the wrong way round in the other.",
    )


def _height(facts: ValidityFacts) -> str:
    rho = [facts.rho(paper, MAIN_CLASS, "mean height")["mean"] for paper in papers()]
    figures = joined([f"{r:+.2f} in {p.short}" for r, p in zip(rho, papers(), strict=True)])
    if rho[0] * rho[1] < 0.0:
        told = (
            f"The papers themselves disagree about the plainest thing, how high LiDARs should be "
            f"mounted (rho of the mean height with the AP of {MAIN_CLASS}s: {figures}), so no "
            "score that rewards height can please both."
        )
    else:
        told = f"The papers agree on the mean height (rho with the AP of {MAIN_CLASS}s: {figures})."
    return facts.say("head: height", told)
