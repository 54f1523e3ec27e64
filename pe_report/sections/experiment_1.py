"""Experiment 1: two LiDARs above a car's roof."""

from __future__ import annotations

import statistics

from pe_core.metric import H_BLIND

from ..facts import Facts
from ..paper import PRIORS, ROOF_M, ROW
from ..places import above_the_roof, ends, printed
from ..plan import LIDAR_ROWS
from ..settings import EXPECTED, NEARER
from ..words import better_by, between, how_many, joined, than_printed
from .tables import placements, same

PRINTED = [ROW[row].entropy for row in LIDAR_ROWS]


def experiment_1(facts: Facts) -> str:
    """Return the account of the two roof LiDARs."""
    low, high = (facts.entropy(row) for row in LIDAR_ROWS)
    return f"""
## Experiment 1: Pandar64 and HDL-64E

**Ordering: {same(facts, "1")}** Paper {PRINTED[0]} and {PRINTED[1]}, ours {low:.4f} and {high:.4f}
under `road`.

**Figures: {_figures(facts, low, high)}** {_unseen(facts)} {_nearer(facts)}

{_placement(facts)}

{placements(facts, list(LIDAR_ROWS))}
"""


def _figures(facts: Facts, low: float, high: float) -> str:
    ours, theirs = abs(high - low), abs(PRINTED[1] - PRINTED[0])
    gap = "farther apart" if ours > theirs else "nearer together"
    return facts.say("1: figures", f"{than_printed([low, high], PRINTED)}, and {gap}.")


def _unseen(facts: Facts) -> str:
    unseen = [1.0 - facts[f"printed/{row}/road"]["coverage"] for row in LIDAR_ROWS]
    seen = [facts.in_view(row, PRIORS[0]) for row in LIDAR_ROWS]
    below = sum(mean < printed for mean, printed in zip(seen, PRINTED, strict=True))
    told = facts.say("1: in view", f"{how_many(below, 2)} below the printed figures")
    return (
        "m counts whole beams, and between channels there are voxels that meet none: of the prior, "
        f"{unseen[0]:.1%} are unseen by the Pandar64 and {unseen[1]:.1%} by the HDL-64E, and that alone "
        f"is {unseen[0] * H_BLIND:.2f} and {unseen[1] * H_BLIND:.2f} nats. Over what they see the mean "
        f"is {seen[0]:.2f} and {seen[1]:.2f}, {told}."
    )


def _nearer(facts: Facts) -> str:
    """Return what other priors and counts do to the distance from the printed figures."""
    said = []
    for setting in (NEARER, EXPECTED):
        names = [f"vary/{setting}/{row}" for row in LIDAR_ROWS]
        if not all(name in facts.values for name in names):
            return ""
        found = [facts[name]["entropy"] for name in names]
        said.append(f"{found[0]:.4f} and {found[1]:.4f}, {_nearness(facts, setting, found)}")
    return (
        "With a prior of positions fitted to KITTI's labels instead of nuScenes' they are "
        f"{said[0]}; with a count that is spread evenly between the channels, so that every voxel has "
        f"its expected share of the beams, and without the vehicle, {said[1]}. The paper describes whole "
        "beams, and so do we."
    )


def _nearness(facts: Facts, setting: str, found: list[float]) -> str:
    """Return whether figures are nearer to the printed ones than ours as shipped."""
    shipped = [facts.entropy(row) for row in LIDAR_ROWS]
    before, after = (
        statistics.mean(abs(a - b) for a, b in zip(values, PRINTED, strict=True))
        for values in (shipped, found)
    )
    word = "nearer to" if after < before else "no nearer to"
    told = f"{word} the printed ones ({after:.2f} nats off on average in place of {before:.2f})"
    return facts.say(f"1: {setting}", told)


def _placement(facts: Facts) -> str:
    """Return where the roof LiDARs end, beside the paper's."""
    if not facts.searched(LIDAR_ROWS[0]):
        return ""
    every = [at for row in LIDAR_ROWS for at in ends(facts, row)]
    above = sum(map(above_the_roof, every))
    theirs = joined([f"{printed(row)['roof'][2]:.2f}" for row in LIDAR_ROWS])
    as_paper = "as" if above == len(every) and all(map(_printed_above, LIDAR_ROWS)) else "not as"
    verdict = facts.say(
        "1: above the roof", f"{how_many(above, len(every))} above the roof, {as_paper}"
    )
    return (
        f"**Placement: {verdict} in the paper.** Seeds end with {joined([_end(facts, r) for r in LIDAR_ROWS])}. "
        f"The paper's heights are {theirs} m on a car that it does not describe; our roof is at {ROOF_M} m. "
        f"{_loosest(facts)} Height and pitch decide along which layers of voxels the dense channels run."
    )


def _printed_above(row: str) -> bool:
    return above_the_roof(printed(row))


def _end(facts: Facts, row: str) -> str:
    heights = [at["roof"][2] for at in ends(facts, row)]
    gain = facts.say(
        f"1: gain of {row}", better_by(facts.entropy(row) - facts.best(row)["entropy"])
    )
    return f"the {ROW[row].label} at {between(heights)} m ({gain})"


def _loosest(facts: Facts) -> str:
    """Return how far seeds end from each other, across and in height."""
    if any(len(ends(facts, row)) < 2 for row in LIDAR_ROWS):
        return ""
    spread = {
        axis: max(_spread([at["roof"][axis] for at in ends(facts, row)]) for row in LIDAR_ROWS)
        for axis in range(3)
    }
    across, height = max(spread[0], spread[1]), spread[2]
    word = facts.say("1: loosest", "more" if across > height else "no more")
    return f"Seeds differ {word} in x and y, by up to {across:.2f} m, than in height, by up to {height:.2f} m."


def _spread(values: list[float]) -> float:
    return max(values) - min(values)
