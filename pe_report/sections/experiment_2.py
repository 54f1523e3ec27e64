"""Experiment 2: two cameras at a car's windscreen, and the bound on what they can do."""

from __future__ import annotations

from pe_core.metric import H_BLIND

from ..facts import Facts
from ..paper import PRIORS, ROW
from ..places import ends, highest, near_the_paper
from ..words import (
    AT_BOUND_M,
    FIGURE_NATS,
    LEVEL_NATS,
    against,
    between,
    how_many,
    joined,
    table,
    under,
)
from .tables import placements, same

NARROW, WIDE = "2_60deg", "2_120deg"
BOTH = (NARROW, WIDE)
REACH_M = 2.0
"""How far a search moves a sensor at most."""


def experiment_2(facts: Facts) -> str:
    """Return the account of the two cameras, and the bound."""
    return f"""
## Experiment 2: 60 and 120 degree cameras

**Ordering: {same(facts, "2")}** {_where_it_looks(facts)} {_out_of_view(facts)} {_level(facts)}{_searched(facts)}

{_table(facts)}

{_bound(facts)}

![Least entropy of a voxel by its distance](camera_bound.png)

{_in_view_alone(facts)}

{_placement(facts)}

{placements(facts, list(BOTH))}
"""


def _under(holds: dict[str, bool]) -> str:
    """Return under which priors something is so."""
    yes, no = ([p for p in PRIORS if holds[p] is v] for v in (True, False))
    return under(yes, no)


def _where_it_looks(facts: Facts) -> str:
    lower = {p: facts.in_view(NARROW, p) < facts.in_view(WIDE, p) for p in PRIORS}
    told = facts.say("2: where it looks", f"the 60 degree camera is lower {_under(lower)}")
    return f"Over the voxels each sees, {told} (table below)."


def _out_of_view(facts: Facts) -> str:
    seen = {p: [facts[f"printed/{row}/{p}"]["coverage"] for row in BOTH] for p in PRIORS}
    wider = {p: wide > narrow for p, (narrow, wide) in seen.items()}
    told = facts.say("2: out of view", f"the wider camera sees more of the prior {_under(wider)}")
    more = joined([f"{100.0 * (wide - narrow):.0f}" for narrow, wide in seen.values()])
    return (
        f"But what is out of view costs {H_BLIND:.2f} nats, and {told} ({joined(PRIORS)}: {more} "
        "percentage points)."
    )


def _level(facts: Facts) -> str:
    """Say how near to each other the two are where they are nearest."""
    pairs = {p: [facts.entropy(row, p) for row in BOTH] for p in PRIORS}
    nearest = min(PRIORS, key=lambda p: abs(pairs[p][0] - pairs[p][1]))
    narrow, wide = pairs[nearest]
    if abs(narrow - wide) <= LEVEL_NATS:
        word = f"nearly level, within {LEVEL_NATS} nats"
    else:
        word = f"60 degrees {against(narrow, wide, LEVEL_NATS)}, by more than {LEVEL_NATS} nats"
    told = facts.say("2: level", f"under `{nearest}`: {word}")
    return f"They are nearest to each other {told} ({narrow:.4f} and {wide:.4f})."


def _searched(facts: Facts) -> str:
    yes, no = facts.holding("2", "searched")
    said = [f"it holds under {joined(yes)}"] if yes else []
    said += [f"it does not hold under {joined(no)}"] if no else []
    if not said:
        return ""
    return facts.say("2: searched", f" With our own search of both, {' and '.join(said)}.")


def _table(facts: Facts) -> str:
    lines = []
    for prior in PRIORS:
        for row in BOTH:
            bound = facts[f"bound/{row}/{prior}"]
            lines.append(
                [
                    prior,
                    ROW[row].label,
                    f"{facts.entropy(row, prior):.4f}",
                    f"{bound['in_view']:.1%}",
                    f"{facts.in_view(row, prior):.2f}",
                    f"{bound['least']:.2f}",
                    f"{bound['least_all_round']:.2f}",
                ]
            )
    titles = ["prior", "camera", "PE", "in view", "PE of what is seen", "bound", "bound, all round"]
    return table(titles, lines)


def _bound(facts: Facts) -> str:
    near, far = (facts[f"bound/{row}/road"] for row in BOTH)
    return f"""**Figures: {_possible(facts)}** The image of a 0.1 m cube is at most
sqrt(3) (0.1 f / d)² pixels, times what a pinhole camera adds off its axis; with AP = 0.055 ln m + 0.155
that bounds each voxel's H from below, however the camera is placed (plot). H = {ROW[NARROW].entropy}
or less needs a voxel within {near["farthest_m"]:.1f} m of the 60 degree camera, or {far["farthest_m"]:.1f} m
of the other for {ROW[WIDE].entropy}; {near["nearer_than_that"]:.1%} and
{far["nearer_than_that"]:.1%} of `road` are as near. A prior with nothing nearer has a higher PE whatever else
it looks like. "bound" is the best for the placement's own field of
view; "bound, all round" is for a camera that saw all round and through the vehicle. {_share_needed(facts)}
The paper doubles weights beyond 40 m, where the least H of a voxel is {_least_beyond(facts)}."""


def _possible(facts: Facts) -> str:
    """Say whether the bound leaves room for the printed figures."""
    beyond = {
        p: all(facts[f"bound/{row}/{p}"]["least_all_round"] > ROW[row].entropy for row in BOTH)
        for p in PRIORS
    }
    if all(beyond.values()):
        told = "the printed ones cannot come from the printed formula under any of these priors."
    else:
        free = [p for p in PRIORS if not beyond[p]]
        told = f"under {joined(free)} the bound leaves room for a printed one."
    return facts.say("2: the bound", told)


def _share_needed(facts: Facts) -> str:
    """Say how much has to be in view for the printed figure, beside what a 60 degree camera sees."""
    needed = 1.0 - facts[f"bound/{NARROW}/road"]["most_unseen"]
    seen = max(facts[f"bound/{NARROW}/{p}"]["in_view"] for p in PRIORS)
    word = facts.say("2: share needed", "more than" if needed > seen else "no more than")
    return (
        f"Even if every voxel in view filled the whole image, {needed:.0%} of the prior would have to "
        f"be in view, {word} the {seen:.0%} at most that the 60 degree camera sees at its printed place."
    )


def _least_beyond(facts: Facts, distance_m: float = 40.0) -> str:
    curve = facts["bound_curve/60"]
    pairs = zip(curve["distance_m"], curve["entropy"], strict=True)
    least = min(pairs, key=lambda pair: abs(pair[0] - distance_m))[1]
    word = against(least, ROW[NARROW].entropy, FIGURE_NATS)
    return facts.say(
        "2: beyond 40 m", f"{least:.1f}, {word} {'as' if 'same' in word else 'than'} the printed PE"
    )


def _in_view_alone(facts: Facts) -> str:
    """Say whether a mean over the voxels in view would be nearer to the printed figures."""
    nearer = []
    for row in BOTH:
        printed, ours = ROW[row].entropy, facts.in_view(row, PRIORS[0])
        nearer.append(abs(ours - printed) < abs(facts.entropy(row) - printed))
    word = facts.say("2: in view alone", "nearer" if all(nearer) else "not nearer")
    seen = [facts.in_view(row, PRIORS[0]) for row in BOTH]
    rest = sum(a - ROW[row].entropy > FIGURE_NATS for a, row in zip(seen, BOTH, strict=True))
    also = ": what they would take besides is a larger measurement for each voxel" if rest else ""
    still = facts.say("2: in view, still", f"{how_many(rest, 2)} of them higher{also}")
    return (
        f"A mean over the voxels in view alone would be {word} to the printed ones ({seen[0]:.2f} and "
        f"{seen[1]:.2f} under `{PRIORS[0]}`), {still}. The paper does not "
        "say that it does either."
    )


def _placement(facts: Facts) -> str:
    """Return where the cameras end, beside the paper's."""
    rows = [row for row in BOTH if facts.searched(row)]
    if not rows:
        return ""
    there = sum(near_the_paper(facts, row) for row in rows)
    every = sum(len(ends(facts, row)) for row in rows)
    verdict = "not the paper's" if not there else f"{how_many(there, every)} at the paper's"
    return (
        f"**Placement: {facts.say('2: placement', verdict)}.** Its cameras are at the windscreen. "
        f"{_where(facts, rows)} {_sees(facts, rows)} Nothing in the metric ties a camera to the "
        "windscreen; the paper does not say what did."
    )


def _where(facts: Facts, rows: list[str]) -> str:
    places = [at["camera"] for row in rows for at in ends(facts, row)]
    heights, behind = [p[2] for p in places], [-p[0] for p in places]
    top = highest(NARROW)
    up = "as high as" if min(heights) >= top - AT_BOUND_M else "lower than"
    back = "as far" if min(behind) >= REACH_M - AT_BOUND_M else "not as far"
    return (
        f"Ours end {between(heights)} m high and {between(behind)} m behind the vehicle's centre, "
        f"{facts.say('2: how high', up)} the bounds allow ({top:.2f} m) and {facts.say('2: how far', back)} "
        f"back as a search reaches ({REACH_M:.0f} m), to {AT_BOUND_M} m."
    )


def _sees(facts: Facts, rows: list[str]) -> str:
    """Say whether more of the prior is seen from there."""
    gains = [facts.best(r)["coverage"] - facts[f"printed/{r}/road"]["coverage"] for r in rows]
    word = "more" if min(gains) > 0.0 else "less" if max(gains) < 0.0 else "not always more"
    shares = joined([f"{facts.best(row)['coverage']:.1%}" for row in rows])
    return f"From there they see {facts.say('2: sees', word)} of the prior than from the paper's places ({shares})."
