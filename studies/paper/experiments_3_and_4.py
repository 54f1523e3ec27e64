"""Experiments 3 and 4, LiDARs and cameras on a bus, and the pitch figure of two such LiDARs."""

from __future__ import annotations

import math

from pe_core.metric import H_BLIND

from ..wording import (
    ABOUT_M,
    APART_DEG,
    APART_M,
    AT_BOUND_M,
    GAIN_NATS,
    compared_with_printed,
    how_many,
    joined,
    range_text,
    table,
)
from .claims import SMALL_DEG
from .paper import PITCH_HEIGHT_M, PRIORS, ROW
from .plan import pilot_name
from .result_view import (
    CLEAR,
    CORNER_ROWS,
    ReproductionResults,
    are_apart,
    ends_like_the_paper,
    height_differences,
    height_verdict,
    max_height,
    printed_positions,
    row_label,
)
from .tables import ordering_verdict, placements

IncumbentCurve = list[tuple[float, float]]
"""Pitch difference [deg] and entropy [nats] of each point."""

DENSE_DEG = 1.0 / 3.0
"""Spacing of the Pandar40's dense channels."""


def experiment_3(results: ReproductionResults) -> str:
    """Return the section on the two LiDARs on a bus."""
    ours = [results.entropy(row) for row in CORNER_ROWS]
    theirs = [ROW[row].entropy for row in CORNER_ROWS]
    return f"""
## Experiment 3: two Pandar40 on a bus

**Ordering, default weights: {ordering_verdict(results, "3 default")}** **Front doubled: {ordering_verdict(results, "3 front")}**

A search moves a sensor by two metres at most, so each pair of corners had a search of its own, a pilot with
{results.effort.pilot_candidates} candidates in a round. The best pair was then searched with all seeds and
{results.effort.candidates} candidates:

{_pilots(results)}

{_told_apart(results)}{_pilots_and_searches(results)}

**Figures: {results.verdict("3: figures", compared_with_printed(ours, theirs))}** (for the cost of unseen voxels see
experiment 1): the paper's are {joined([str(v) for v in theirs])}, ours {joined([f"{v:.4f}" for v in ours])} at the
printed placements.

{_placement(results)}

{placements(results, list(CORNER_ROWS))}
"""


def _pilots(results: ReproductionResults) -> str:
    lines = []
    for row in CORNER_ROWS:
        for start in ROW[row].starts:
            name = pilot_name(row, PRIORS[0], start)
            if name in results.values:
                lines.append([row_label(row), start, f"{results[name]['entropy']:.4f}"])
    return table(["row", "corners at the start of the search", "entropy at its end"], lines)


def _told_apart(results: ReproductionResults) -> str:
    """Return from which difference on two pilots of a row differ by more than chance."""
    rows = results.searched(CORNER_ROWS)
    if not rows or len(results.effort.seeds) < 2:
        return ""
    keys = dict(zip(CORNER_ROWS, ("3 default", "3 front"), strict=True))
    deviations = {row: results.searched_deviations(keys[row], PRIORS[0]) for row in rows}
    limits = [f"{CLEAR * math.hypot(*deviations[row]):.3f} nats ({ROW[row].label})" for row in rows]
    return (
        f"A pilot is one search. Two pairs of corners are told apart by more than {joined(limits)}; "
        "that is from the seeds of the long searches, and pilots have fewer candidates, so they may scatter more. "
    )


def _pilots_and_searches(results: ReproductionResults) -> str:
    """Return whether the long searches end lower than the pilots."""
    rows = results.searched(CORNER_ROWS)
    if not rows:
        return ""
    lower = [
        row
        for row in rows
        if results[pilot_name(row, PRIORS[0], results.best_start(row))]["entropy"]
        < results.best(row)["entropy"]
    ]
    if not lower:
        text = "No pilot ends lower than the best of the long searches."
    else:
        labels = joined([ROW[row].label for row in lower])
        why = "both are random, and evaluate a sample of the voxels"
        text = f"The pilot of {labels} ends lower than the long searches: {why}."
    return results.verdict("3: pilots", text)


def _placement(results: ReproductionResults) -> str:
    """Return where the searches of the bus's LiDARs end, compared with the paper."""
    rows = results.searched(CORNER_ROWS)
    if not rows:
        return ""
    other = [ROW[row].label for row in rows if not ends_like_the_paper(results, row)]
    where = "other corners" if other else "the same corners"
    where += f" ({joined(other)})" if other and len(other) < len(rows) else ""
    differences = height_differences(results, rows)
    distances = [abs(d) for d in differences]
    height = results.verdict("3: height", height_verdict(differences))
    theirs = [z for row in rows for _, _, z in printed_positions(row).values()]
    ours = [
        position[2]
        for row in rows
        for positions in results.final_positions(row)
        for position in positions.values()
    ]
    return (
        f"**Placement: {results.verdict('3: corners', where)}, and {height}**: {range_text(ours)} m over all seeds "
        f"(the paper's: {range_text(theirs)} m). The mean difference from the paper's heights is "
        f"{sum(distances) / len(distances):.2f} m and the largest {max(distances):.2f} m; up to {ABOUT_M} m "
        f"on average is about the same. {_bounds(results, rows, max(ours))} "
        f"{_apart(results, rows)}"
    )


def _bounds(results: ReproductionResults, rows: list[str], highest: float) -> str:
    """Return whether the bounds of the search limit the height of a LiDAR."""
    bound = min(map(max_height, rows))
    text = (
        "do not limit the heights" if highest < bound - AT_BOUND_M else "limit the largest height"
    )
    return f"The bounds of the search, up to {bound:.2f} m, {results.verdict('3: bounds', text)}."


def _apart(results: ReproductionResults, rows: list[str]) -> str:
    """Return whether the two end at different heights or pitches, as the paper notes."""
    ends = [placements for row in rows for placements in results.final_placements(row)]
    count = sum(map(are_apart, ends))
    text = f"{how_many(count, len(ends))} of the searches end with the two LiDARs at different heights or pitches"
    if count == len(ends):
        text += ", as the paper notes for its placements: the channels of one are then between those of the other"
    return f"By more than {APART_M} m or {APART_DEG} deg, {results.verdict('3: apart', text)}."


def experiment_4(results: ReproductionResults) -> str:
    """Return the section on LiDARs with cameras."""
    return f"""
## Experiment 4: two LiDARs and two cameras

**Ordering: {ordering_verdict(results, "4")}** {_gain(results)} {_coverage(results)}

The paper gives no yaw: the front camera is assumed to look ahead, the rear camera back.

{placements(results, ["4_cameras"])}
"""


def _gain(results: ReproductionResults) -> str:
    """Return what the cameras gain, compared with the paper's gain."""
    with_cameras, alone = results.entropy("4_cameras"), results.entropy("4_cameras", kind="lidars")
    theirs, ours = ROW["3_front"].entropy - ROW["4_cameras"].entropy, alone - with_cameras
    verb = "gain" if ours > 0.0 else "lose"
    if abs(ours - theirs) <= GAIN_NATS:
        word = "as much as"
    else:
        word = "more than" if ours > theirs else "less than"
    text = results.verdict("4: gain", f"Our cameras {verb} {abs(ours):.2f}, {word} the paper's")
    return (
        f"The paper's cameras gain {theirs:.2f} nats (compared with its experiment 3, front doubled). "
        f"{text}, at the same LiDAR placement: {alone:.4f} without, {with_cameras:.4f} with, under `road`."
    )


def _coverage(results: ReproductionResults) -> str:
    before, after = (
        results[f"{kind}/4_cameras/road"]["coverage"] for kind in ("lidars", "printed")
    )
    verb = results.verdict("4: coverage", "rises" if after > before else "does not rise")
    text = f"Coverage {verb}: {before:.1%} without, {after:.1%} with the cameras."
    if after <= before:
        return text
    cost = (after - before) * H_BLIND
    return (
        f"{text} The voxels that only the cameras see cost {cost:.2f} nats without them, as an unseen voxel "
        f"costs {H_BLIND:.2f}."
    )


def pitch(results: ReproductionResults) -> str:
    """Return the section on the pitch figure."""
    curve = sorted((float(k), v["entropy"]) for k, v in results.with_prefix("pitch/").items())
    lowest = min(curve, key=lambda pair: pair[1])
    return f"""
## The pitch figure

Two Pandar40 at the bus's front corners, both {PITCH_HEIGHT_M} m high, the first level, under `road` with
default weights. {_small_difference(results)} {_worst(results, curve)} The minimum of the whole range is
{lowest[1]:.4f} at {lowest[0]:g} deg. {_period(results, curve)} {_alone(results, curve)}

![Entropy against the pitch difference](pitch.png)
"""


def _small_difference(results: ReproductionResults) -> str:
    """Return whether a small difference is better than none."""
    claim = results.printed_claim("pitch")
    equal = f"{claim['worse_entropy']:.4f}"
    small = f"{claim['better_entropy']:.4f} at {claim['better']}"
    if claim["holds"]:
        text = (
            f"**The same as in the paper:** at equal pitch the channels of one LiDAR cover those of the other "
            f"({equal}); a small difference moves the beams of one into the gaps of the other ({small})."
        )
    else:
        text = f"**Not as in the paper:** no small difference is an improvement on equal pitch ({equal}; {small})."
    return results.verdict("pitch", text)


def _worst(results: ReproductionResults, curve: IncumbentCurve) -> str:
    near = [(d, h) for d, h in curve if abs(d) <= SMALL_DEG]
    worst = max(near, key=lambda pair: pair[1])
    word = "Equal pitch is" if worst[0] == 0.0 else f"Not equal pitch but {worst[0]:g} deg is"
    text = results.verdict("pitch: worst", f"{word} the worst within {SMALL_DEG:g} deg")
    return f"{text} ({worst[1]:.4f})."


def _period(results: ReproductionResults, curve: IncumbentCurve) -> str:
    """Return whether the spacing of the curve's peaks is that of the dense channels."""
    triples = zip(curve, curve[1:], curve[2:], strict=False)
    peaks = [b[0] for a, b, c in triples if a[1] < b[1] > c[1]]
    step = curve[1][0] - curve[0][0]
    if len(peaks) < 3 or step > DENSE_DEG / 2.0:
        return ""
    spacing = (peaks[-1] - peaks[0]) / (len(peaks) - 1)
    same = "the spacing" if abs(spacing - DENSE_DEG) <= step / 2.0 else "not the spacing"
    text = results.verdict("pitch: period", f"{spacing:.2f} deg apart on average, {same}")
    return f"The curve has {len(peaks)} peaks, {text} of the Pandar40's dense channels ({DENSE_DEG:.2f} deg)."


def _alone(results: ReproductionResults, curve: IncumbentCurve) -> str:
    """Return whether each LiDAR alone changes less than both together."""
    near = [d for d, _ in curve if abs(d) <= SMALL_DEG]
    alone = [results[f"pitch/{d:g}"]["alone"] for d in near]
    changes = [max(v) - min(v) for v in zip(*(a.values() for a in alone), strict=True)]
    fused = [h for d, h in curve if d in near]
    together = max(fused) - min(fused)
    word = results.verdict("pitch: alone", "less" if max(changes) < together else "no less")
    return (
        f"Within {SMALL_DEG:g} deg the entropy of each LiDAR alone changes {word}, by "
        f"{joined([f'{c:.2f}' for c in changes])} nats, than that of both together, by {together:.2f}."
    )
