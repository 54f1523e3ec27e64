"""Experiment 3: two LiDARs at a bus's corners."""

from __future__ import annotations

from ..facts import Facts, label
from ..paper import PRIORS, ROW
from ..places import (
    CORNER_ROWS,
    about_as_high,
    apart,
    at_the_papers_place,
    ends,
    height_differences,
    highest,
    printed,
    searched,
)
from ..plan import pilot_name
from ..words import (
    ABOUT_M,
    APART_DEG,
    APART_M,
    AT_BOUND_M,
    between,
    how_many,
    joined,
    table,
    than_printed,
)
from .tables import placements, same


def experiment_3(facts: Facts) -> str:
    """Return the account of the two LiDARs on a bus."""
    names = [r for r in CORNER_ROWS if facts.searched(r)]
    ours = [facts.entropy(row) for row in CORNER_ROWS]
    theirs = [ROW[row].entropy for row in CORNER_ROWS]
    return f"""
## Experiment 3: two Pandar40 on a bus

**Ordering, default weights: {same(facts, "3 default")}** **Front doubled: {same(facts, "3 front")}**

A search moves a sensor by two metres at most, so each pair of corners was searched by itself, with
{facts.effort.pilot_candidates} candidates a round; the best pair then with all seeds and
{facts.effort.candidates}:

{_pilots(facts)}

{_longer(facts, names)}

**Figures: {facts.say("3: figures", than_printed(ours, theirs))}** (experiment 1 says what unseen voxels
cost): paper {joined([str(v) for v in theirs])}, ours {joined([f"{v:.4f}" for v in ours])} at the printed
placements.

{_placement(facts)}

{placements(facts, list(CORNER_ROWS))}
"""


def _pilots(facts: Facts) -> str:
    lines = []
    for row in CORNER_ROWS:
        for start in ROW[row].starts:
            name = pilot_name(row, PRIORS[0], start)
            if name in facts.values:
                lines.append([label(row), start, f"{facts[name]['entropy']:.4f}"])
    return table(["row", "corners a search starts from", "entropy it ends at"], lines)


def _longer(facts: Facts, names: list[str]) -> str:
    """Say whether the longer searches end lower than the pilots."""
    if not names:
        return ""
    lower = [
        row
        for row in names
        if facts[pilot_name(row, PRIORS[0], facts.best_start(row))]["entropy"]
        < facts.best(row)["entropy"]
    ]
    if not lower:
        return facts.say("3: pilots", "No pilot ends lower than the best of the longer searches.")
    told = joined([ROW[row].label for row in lower])
    chance = "both are random, and judged on a sample of the voxels"
    return facts.say("3: pilots", f"The pilot of {told} ends lower than its searches: {chance}.")


def _placement(facts: Facts) -> str:
    """Return where the bus's LiDARs end, beside the paper's."""
    rows = searched(facts, CORNER_ROWS)
    if not rows:
        return ""
    found = {row: at_the_papers_place(facts, row) for row in rows}
    other = [ROW[row].label for row, there in found.items() if not there]
    where = "other corners" if other else "the same corners"
    where += f" ({joined(other)})" if other and len(other) < len(rows) else ""
    differences = height_differences(facts, rows)
    off = [abs(d) for d in differences]
    height = facts.say("3: height", about_as_high(differences))
    theirs = [z for row in rows for _, _, z in printed(row).values()]
    ours = [position[2] for row in rows for at in ends(facts, row) for position in at.values()]
    return (
        f"**Placement: {facts.say('3: corners', where)}, and {height}**: {between(ours)} m over all seeds "
        f"(the paper's {between(theirs)} m), {sum(off) / len(off):.2f} m from the paper's on average and "
        f"{max(off):.2f} m at most; up to {ABOUT_M} m on average is about the same. {_room(rows, ours, facts)} "
        f"{_apart(facts, rows)}"
    )


def _room(rows: list[str], ours: list[float], facts: Facts) -> str:
    """Say whether the search's bounds or the metric stop a LiDAR's height."""
    top = min(map(highest, rows))
    word = "do not stop them" if max(ours) < top - AT_BOUND_M else "stop the highest"
    return f"The bounds, up to {top:.2f} m, {facts.say('3: bounds', word)}."


def _apart(facts: Facts, rows: list[str]) -> str:
    """Say whether the two end at different heights and pitches, as the paper notes."""
    every = [search["placements"] for row in rows for search in facts.seeds(row)]
    count = sum(map(apart, every))
    told = f"{how_many(count, len(every))} of the searches end with the two at different heights or pitches"
    if count == len(every):
        told += ", as the paper notes of its own: their channels then fall between each other's"
    return f"By {APART_M} m or {APART_DEG} deg, {facts.say('3: apart', told)}."
