"""Experiment 2, two cameras at a car's windscreen, and the bound on what they can do."""

from __future__ import annotations

from pe_core.metric import H_BLIND

from ..wording import (
    AT_BOUND_M,
    FIGURE_NATS,
    LEVEL_NATS,
    compared,
    how_many,
    joined,
    range_text,
    table,
    under,
)
from .paper import PRIORS, ROW
from .result_view import ReproductionResults, count_near_the_paper, max_height
from .tables import ordering_verdict, placements

NARROW, WIDE = "2_60deg", "2_120deg"
BOTH = (NARROW, WIDE)
MAX_MOVE_M = 2.0
"""The largest distance that a search moves a sensor along an axis."""


def experiment_2(results: ReproductionResults) -> str:
    """Return the section on the two cameras, and on the bound."""
    return f"""
## Experiment 2: 60 and 120 degree cameras

**Ordering: {ordering_verdict(results, "2")}** {_in_view(results)} {_out_of_view(results)} {_smallest_difference(results)}{_searched(results)}

{_table(results)}

{_bound(results)}

![Lowest possible entropy of a voxel by its distance](camera_bound.png)

{_in_view_alone(results)}

{_placement(results)}

{placements(results, list(BOTH))}
"""


def _under(holds: dict[str, bool]) -> str:
    """Return under which priors something is true."""
    yes, no = ([p for p in PRIORS if holds[p] is v] for v in (True, False))
    return under(yes, no)


def _in_view(results: ReproductionResults) -> str:
    lower = {
        p: results.entropy_in_view(NARROW, p) < results.entropy_in_view(WIDE, p) for p in PRIORS
    }
    text = results.verdict("2: where it looks", f"the 60 degree camera is lower {_under(lower)}")
    return f"Over the voxels that each camera sees, {text} (table below)."


def _out_of_view(results: ReproductionResults) -> str:
    seen = {p: [results[f"printed/{row}/{p}"]["coverage"] for row in BOTH] for p in PRIORS}
    wider = {p: wide > narrow for p, (narrow, wide) in seen.items()}
    text = results.verdict(
        "2: out of view", f"the wider camera sees more of the prior {_under(wider)}"
    )
    differences = joined([f"{100.0 * (wide - narrow):.0f}" for narrow, wide in seen.values()])
    return (
        f"But a voxel out of view costs {H_BLIND:.2f} nats, and {text} (a difference under {joined(PRIORS)} of "
        f"{differences} percentage points)."
    )


def _smallest_difference(results: ReproductionResults) -> str:
    """Return how the two cameras compare under the prior with the smallest difference."""
    pairs = {p: [results.entropy(row, p) for row in BOTH] for p in PRIORS}
    nearest = min(PRIORS, key=lambda p: abs(pairs[p][0] - pairs[p][1]))
    narrow, wide = pairs[nearest]
    if abs(narrow - wide) <= LEVEL_NATS:
        word = f"nearly level, within {LEVEL_NATS} nats"
    else:
        word = f"60 degrees {compared(narrow, wide, LEVEL_NATS)}, by more than {LEVEL_NATS} nats"
    text = results.verdict("2: level", f"under `{nearest}`: {word}")
    return f"The difference is smallest {text} ({narrow:.4f} and {wide:.4f})."


def _searched(results: ReproductionResults) -> str:
    yes, no = results.priors_holding("2", "searched")
    phrases = [f"it holds under {joined(yes)}"] if yes else []
    phrases += [f"it does not hold under {joined(no)}"] if no else []
    if not phrases:
        return ""
    text = f" With our own search of both, {' and '.join(phrases)}."
    return results.verdict("2: searched", text)


def _table(results: ReproductionResults) -> str:
    lines = []
    for prior in PRIORS:
        for row in BOTH:
            bound = results[f"bound/{row}/{prior}"]
            lines.append(
                [
                    prior,
                    ROW[row].label,
                    f"{results.entropy(row, prior):.4f}",
                    f"{bound['in_view']:.1%}",
                    f"{results.entropy_in_view(row, prior):.2f}",
                    f"{bound['least']:.2f}",
                    f"{bound['least_all_round']:.2f}",
                ]
            )
    titles = [
        "prior",
        "camera",
        "PE",
        "in view",
        "PE of the voxels in view",
        "bound",
        "bound, all round",
    ]
    return table(titles, lines)


def _bound(results: ReproductionResults) -> str:
    near, far = (results[f"bound/{row}/road"] for row in BOTH)
    return f"""**Figures: {_possible(results)}** The image of a 0.1 m cube has at most
sqrt(3) (0.1 f / d)² pixels, times the enlargement of a pinhole camera off its axis. With AP = 0.055 ln m + 0.155
this bounds each voxel's H from below, for every placement of the camera (plot). H = {ROW[NARROW].entropy}
or less needs a voxel within {near["farthest_m"]:.1f} m of the 60 degree camera, and {ROW[WIDE].entropy} one within
{far["farthest_m"]:.1f} m of the other camera; {near["nearer_than_that"]:.1%} and {far["nearer_than_that"]:.1%} of
`road` are within these distances. A prior with nothing within them has a higher PE in any case. In the table,
"bound" is the lowest PE for the field of view at the printed placement; "bound, all round" is for a camera that
sees all round and through the vehicle. {_share_needed(results)}
The paper doubles weights beyond 40 m, where the lowest possible H of a voxel is {_lowest_at(results)}."""


def _possible(results: ReproductionResults) -> str:
    """Return whether the bound allows the printed figures."""
    beyond = {
        p: all(results[f"bound/{row}/{p}"]["least_all_round"] > ROW[row].entropy for row in BOTH)
        for p in PRIORS
    }
    if all(beyond.values()):
        text = "the printed formula cannot give the printed ones under any of these priors."
    else:
        allowing = [p for p in PRIORS if not beyond[p]]
        text = f"under {joined(allowing)} the bound allows a printed one."
    return results.verdict("2: the bound", text)


def _share_needed(results: ReproductionResults) -> str:
    """Return how much of the prior the printed figure needs in view, and how much there is."""
    needed = 1.0 - results[f"bound/{NARROW}/road"]["most_unseen"]
    seen = max(results[f"bound/{NARROW}/{p}"]["in_view"] for p in PRIORS)
    word = results.verdict("2: share needed", "more than" if needed > seen else "no more than")
    return (
        f"Even if every voxel in view filled the whole image, {needed:.0%} of the prior would have to "
        f"be in view, {word} the {seen:.0%} that the 60 degree camera sees at most at its printed placement."
    )


def _lowest_at(results: ReproductionResults, distance_m: float = 40.0) -> str:
    """Return the lowest possible entropy at a distance, compared with the printed PE."""
    curve = results["bound_curve/60"]
    pairs = zip(curve["distance_m"], curve["entropy"], strict=True)
    lowest = min(pairs, key=lambda pair: abs(pair[0] - distance_m))[1]
    word = compared(lowest, ROW[NARROW].entropy, FIGURE_NATS)
    conjunction = "as" if "same" in word else "than"
    return results.verdict("2: beyond 40 m", f"{lowest:.1f}, {word} {conjunction} the printed PE")


def _in_view_alone(results: ReproductionResults) -> str:
    """Return whether a mean over the voxels in view is nearer to the printed figures."""
    nearer = []
    for row in BOTH:
        printed, ours = ROW[row].entropy, results.entropy_in_view(row, PRIORS[0])
        nearer.append(abs(ours - printed) < abs(results.entropy(row) - printed))
    word = results.verdict("2: in view alone", "nearer" if all(nearer) else "not nearer")
    seen = [results.entropy_in_view(row, PRIORS[0]) for row in BOTH]
    higher = sum(a - ROW[row].entropy > FIGURE_NATS for a, row in zip(seen, BOTH, strict=True))
    need = ": the printed ones would also need a larger measurement of each voxel" if higher else ""
    still = results.verdict("2: in view, still", f"{how_many(higher, 2)} of them higher{need}")
    return (
        f"A mean over the voxels in view alone would be {word} to the printed figures ({seen[0]:.2f} and "
        f"{seen[1]:.2f} under `{PRIORS[0]}`), {still}. The paper mentions neither such a mean nor "
        "such a measurement."
    )


def _placement(results: ReproductionResults) -> str:
    """Return where the searches of the cameras end, compared with the paper."""
    rows = results.searched(BOTH)
    if not rows:
        return ""
    near = sum(count_near_the_paper(results, row) for row in rows)
    total = sum(len(results.final_positions(row)) for row in rows)
    verdict = "not the paper's" if not near else f"{how_many(near, total)} at the paper's"
    return (
        f"**Placement: {results.verdict('2: placement', verdict)}.** The paper's cameras are at the windscreen. "
        f"{_final_positions(results, rows)} {_final_coverage(results, rows)} Nothing in the metric keeps a camera "
        "at the windscreen; the paper does not explain why its cameras are there."
    )


def _final_positions(results: ReproductionResults, rows: list[str]) -> str:
    """Return where the cameras end, and whether the bounds of the search stop them there."""
    positions = [ends["camera"] for row in rows for ends in results.final_positions(row)]
    heights, behind = [p[2] for p in positions], [-p[0] for p in positions]
    top = max_height(NARROW)
    high = "as high as" if min(heights) >= top - AT_BOUND_M else "lower than"
    far = "as far" if min(behind) >= MAX_MOVE_M - AT_BOUND_M else "not as far"
    return (
        f"Ours end {range_text(heights)} m high and {range_text(behind)} m behind the vehicle's centre: "
        f"{results.verdict('2: how high', high)} the bounds allow ({top:.2f} m) and {results.verdict('2: how far', far)} "
        f"back as a search moves a sensor ({MAX_MOVE_M:.0f} m), both to {AT_BOUND_M} m."
    )


def _final_coverage(results: ReproductionResults, rows: list[str]) -> str:
    """Return whether the cameras see more of the prior from where the searches end."""
    gains = [results.best(r)["coverage"] - results[f"printed/{r}/road"]["coverage"] for r in rows]
    word = "more" if min(gains) > 0.0 else "less" if max(gains) < 0.0 else "not always more"
    shares = joined([f"{results.best(row)['coverage']:.1%}" for row in rows])
    return f"From there they see {results.verdict('2: sees', word)} of the prior than from the paper's placements ({shares})."
