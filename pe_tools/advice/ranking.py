"""Several rigs in sentences: which is better, and what a search cost."""

import math
from collections.abc import Iterator, Sequence

from pe_core.scene.rig import Rig
from pe_core.scoring.score import NO_DIFFERENCE, Score, is_noise
from pe_core.search import FIGURES, KeyFigures
from pe_core.search.figures import AP, BLIND_SECTOR, COVERAGE, ENTROPY, on_dashboard

from ..wording import joined, metres, percent
from .location import WAYS
from .score_comparison import TRAFFIC, ComparedRow, difference_error
from .summary import WHERE

ZONES_NAMED = 2
SENSORS_NAMED = 3
NOTHING = "Nothing became worse"
RANKED = (ENTROPY, COVERAGE, AP)  # Figures that rank rigs


def ranking(names: Sequence[str], rows: Sequence[ComparedRow]) -> tuple[str, ...]:
    """Return a sentence for each measure: the best of several rigs, and how much worse others are.
    `names` are those of the rigs in the order of the values of `rows`, the result of `compare`."""
    return tuple(
        _ranked(names, row)
        for row in rows
        if row.group == "rig" and row.measure in RANKED and len(row.order) > 1
    )


def _ranked(names: Sequence[str], row: ComparedRow) -> str:
    noun = row.how.name
    digits = row.how.decimals
    unit = {"": "", "%": "%"}.get(row.how.unit, f" {row.how.unit}")
    unit_of_gap = " points" if unit == "%" else unit
    values = {k: value for k, value in enumerate(row.told) if value is not None}
    first = row.order[0]
    best = [k for k in row.order if not row.differ(first, k)]
    worse = []
    for k in (k for k in row.order if k not in best):
        error = row.how.scale * row.errors[first][k]
        plus_minus = f" +- {max(error, 10.0**-digits):.{digits}f}" if error else ""
        worse.append(f"{names[k]} by {abs(values[k] - values[first]):.{digits}f}{plus_minus}")
    shown = joined([f"{names[k]} ({values[k]:.{digits}f}{unit})" for k in best])
    told = f"{shown} is best" if len(best) == 1 else f"{shown}: {NO_DIFFERENCE}"
    told = f"By {noun} {told}; {row.how.better}."
    return f"{told} Worse: {joined(worse)}{unit_of_gap}." if worse else told


def disagreement(names: Sequence[str], rows: Sequence[ComparedRow]) -> str:
    """Return one sentence where the three figures prefer different rigs; empty where one is best.
    The figures are entropy, expected AP in traffic, and the widest blind sector for the lowest
    body. `rows` are those of `compare` and of `compare_figures`. Rigs that do not differ clearly
    from the best one are as good as it."""
    asked = {
        "entropy": (row for row in rows if (row.group, row.measure) == ("rig", ENTROPY)),
        "expected AP in traffic": (r for r in rows if (r.group, r.name) == (TRAFFIC, "")),
        "the widest blind sector": (row for row in rows if row.measure == BLIND_SECTOR),
    }
    best = {}
    for called, found in asked.items():
        if (row := next(found, None)) is not None and row.order:
            best[called] = [k for k in row.order if not row.differ(row.order[0], k)]
    if not best or set.intersection(*map(set, best.values())):
        return ""
    told = [f"{joined([names[k] for k in own])} by {called}" for called, own in best.items()]
    return f"The figures disagree: best is {', '.join(told)}."


def moved_words(before: Rig, after: Rig) -> str:
    """Return which sensors moved, and how: "roof 8 cm up, rear 1.20 m ahead and turned 12 deg"."""
    moved = []
    for sensor in after:
        old = before[sensor.name].pose
        pose = sensor.pose
        if pose == old:
            continue
        steps = [b - a for a, b in zip(old.position, pose.position, strict=True)]
        axis = max(range(3), key=lambda k: abs(steps[k]))
        ways = [f"{metres(abs(steps[axis]))} {WAYS[axis][steps[axis] < 0.0]}"] * any(steps)
        angles = zip(old.rotation_deg, pose.rotation_deg, strict=True)
        turned = max(abs(math.remainder(a - b, 360.0)) for a, b in angles)
        ways += [f"turned {turned:.0f} deg"] * (turned >= 0.5)
        moved.append(f"{sensor.name} {' and '.join(ways)}" if ways else sensor.name)
    others = len(moved) - SENSORS_NAMED
    return joined([*moved[:SENSORS_NAMED], *[f"{others} others"] * (others > 0)])


def gain_sentence(before: Rig, after: Rig, start: KeyFigures, result: KeyFigures) -> str:
    """Return the move from a rig to another, its gain and its error, in one sentence. The gain is
    that of the expected AP in traffic by distance. The error is the largest standard error of the
    differences. Empty without a move or such an AP."""
    if start.traffic is None or result.traffic is None or before == after:
        return ""
    first = start.traffic.rings
    last = result.traffic.rings
    rings = [f"{name} {first[name][0]:.2f} to {ap:.2f}" for name, (ap, _) in last.items()]
    error = max(result.traffic.error_from(start.traffic, name) for name in last)
    told = f"expected AP in traffic {', '.join(rings)} (+- {math.ceil(100.0 * error) / 100.0:.2f})"
    return f"{moved_words(before, after)}: {told}"


def search_cost(before: Score, after: Score, start: KeyFigures, result: KeyFigures) -> str:
    """Return one sentence on what a search made worse, or that nothing is. `start` and `result` are
    the key figures of the rigs with the scores `before` and `after`. A difference within two of its
    standard errors is noise, and is not named."""
    losses = [*_figure_losses(start, result), *_score_losses(before, after)]
    losses += _zone_losses(before, after)
    if losses:
        return f"Worse: {joined(losses)}"
    told = ["key figures"] if start.values and result.values else []
    unharmed = joined([*told, "coverage", "all zones"])
    return f"{NOTHING} beyond its error: {unharmed}"


def _figure_losses(start: KeyFigures, result: KeyFigures) -> Iterator[str]:
    errors = result.errors_from(start)
    for row in on_dashboard():
        first = row.value(start)
        last = row.value(result)
        if first is None or last is None or row.cost_of(last) <= row.cost_of(first):
            continue
        texts = row.text(first), row.text(last)
        if texts[0] != texts[1] and not is_noise(last - first, errors.get(row.key, 0.0)):
            yield f"{row.name} ({texts[0]} to {texts[1]})"


def _score_losses(before: Score, after: Score) -> Iterator[str]:
    def is_worse(measure: str, by: float) -> bool:
        error = difference_error(before, after, ("rig", "", measure))
        return by >= FIGURES[measure].least and not is_noise(by, error)

    if is_worse(COVERAGE, before.coverage - after.coverage):
        yield f"coverage ({percent(before.coverage, 1)} to {percent(after.coverage, 1)})"
    if before.objects is not None and after.objects is not None:
        if is_worse(AP, before.objects.ap - after.objects.ap):
            yield f"expected AP ({before.objects.ap:.3f} to {after.objects.ap:.3f})"
    elif is_worse(ENTROPY, after.entropy - before.entropy):
        yield f"entropy ({before.entropy:.3f} to {after.entropy:.3f} nats)"


def _zone_losses(before: Score, after: Score) -> Iterator[str]:
    """Yield the zones whose entropy rose most."""
    rises = {
        name: after.per_zone[name].entropy - zone.entropy
        for name, zone in before.per_zone.items()
        if name in after.per_zone
    }
    worse = []
    for name, rise in rises.items():
        error = difference_error(before, after, ("zone", name, ENTROPY))
        if rise >= FIGURES[ENTROPY].least and not is_noise(rise, error):
            worse.append(name)
    for name in sorted(worse, key=lambda name: -rises[name])[:ZONES_NAMED]:
        first = before.per_zone[name].entropy
        last = after.per_zone[name].entropy
        yield f"entropy {WHERE.get(name, name)} ({first:.3f} to {last:.3f} nats)"


def costs_nothing(cost: str) -> bool:
    """Whether a sentence of `search_cost` says that nothing got worse."""
    return cost.startswith(NOTHING)
