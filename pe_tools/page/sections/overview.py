"""The overview at the top of the page of one study, and the section with its warnings.

The overview has three sentences (question, result, notes), key figures and a picture.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import pe_core as pe
from pe_core import metric
from pe_core import sensors as kinds
from pe_core.base.errors import plural
from pe_core.scoring import sight

from ... import advice
from ..markup import (
    ARROW,
    Markup,
    capitalized,
    escaped,
    joined,
    number,
    percent,
    percent_points,
    signed,
)
from ..pictures.svg import STYLE
from ..pictures.vehicle_picture import labelled_picture_of
from ..report_context import ReportContext, Section

SIDES = {"front": "ahead", "rear": "behind", "left": "on the left", "right": "on the right"}


def overview(contexts: tuple[ReportContext, ...]) -> Section:
    """Return the overview of a single study; several studies have the comparison instead."""
    if len(contexts) > 1:
        return Section("summary", "Summary", "")
    context = contexts[0]
    lines = {
        "Question": question(context),
        "Result": answer(context),
        "Note": cautions(context),
    }
    brief = "".join(f"<li><b>{what}:</b> {line}</li>" for what, line in lines.items() if line)
    inside = (
        f'<ul class="brief">{brief}</ul>{_tiles(context)}{_picture(context)}{_entropy_explained()}'
    )
    return Section("summary", "Summary", inside, styles=(STYLE,))


def question(context: ReportContext) -> Markup:
    """Return the question of the study: which sensors, which vehicle, classes and space."""
    space, prior = context.study.space, context.study.prior
    names = joined([f"a {escaped(name)}" for name in prior.class_names])
    rig, vehicle = _sensor_counts(context), _vehicle_text(context)
    x, y = _span(space.x), _span(space.y)
    end = " Are there better positions for them?" if context.was_searched else ""
    return Markup(
        f"How well do {rig} on {vehicle} see {names}, {x} m ahead and behind, {y} m to the "
        f"sides?{end}"
    )


def answer(context: ReportContext) -> Markup:
    """Return the result in a sentence or two: entropy, coverage, best and worst zone."""
    after, before = context.after, context.before
    zones = sorted(after.per_zone, key=lambda zone: after.per_zone[zone].entropy)
    best, worst = (advice.WHERE.get(zones[k], zones[k]) for k in (0, -1))
    ends = f" The rig sees best {best}, worst {worst}." if zones else ""
    if not context.was_searched:
        return Markup(
            f"Perception entropy is {number(after.entropy)} nats (lower is better); "
            f"{percent(after.coverage, 1)} of the expected objects are seen.{ends}"
        )
    if context.outcome.in_traffic is not None:
        return Markup(f"{_ap_answer(context, *context.outcome.in_traffic)}{ends}")
    gain = before.entropy - after.entropy
    if gain <= 0.0:
        return Markup(f"No placement better than {number(after.entropy)} nats was found.{ends}")
    moved = _moved(context)
    return Markup(
        f"Moving {plural(moved, 'sensor')} lowers perception entropy by {number(gain)} nats to "
        f"{number(after.entropy)} (lower is better); {percent(after.coverage, 1)} of the expected "
        f"objects are seen, {percent_points(after.coverage - before.coverage)}.{ends}"
    )


def _moved(context: ReportContext) -> int:
    """Return how many sensors a search moved."""
    return sum(a.pose != b.pose for a, b in zip(context.start.rig, context.rig, strict=True))


def _ap_answer(context: ReportContext, first: pe.ObjectScore, last: pe.ObjectScore) -> str:
    """Return the result of a search by expected AP; the entropy stands beside it."""
    if last.ap <= first.ap:
        best = number(last.ap, 3)
        return f"No placement with a higher expected AP in traffic than {best} was found."
    before, after = context.before.entropy, context.after.entropy
    moved, gain = _moved(context), last.ap - first.ap
    return (
        f"Moving {plural(moved, 'sensor')} raises the expected AP of objects in traffic by "
        f"{number(gain, 3)} to {number(last.ap, 3)} (higher is better). The perception entropy "
        f"goes from {number(before)} to {number(after)} nats (lower is better); "
        f"{percent(context.after.coverage, 1)} of the expected objects are seen."
    )


def cautions(context: ReportContext) -> Markup:
    """Return notes: hidden sensors, blind ground, the worst loss of a sensor, warnings."""
    notes = [
        _cost(context),
        *hidden_sensor_lines(context),
        _blind_ground(context),
        _worst_loss_line(context),
        _warning_link(context),
    ]
    return Markup(" ".join(f"{_sentence(text)}." for text in notes if text))


def hidden_sensor_lines(context: ReportContext) -> tuple[str, ...]:
    """Return lines on the sensors that see nothing or are mostly hidden."""
    sensors = advice.hidden_sensors(context.rig, context.after, context.warnings)
    named = [
        replace(sensor, name=f"<b>{escaped(sensor.name)}</b>", why=escaped(sensor.why))
        for sensor in sensors
    ]
    return advice.hidden_words(named)


def _sentence(text: str) -> str:
    """Return a sentence with a capital; a name at its beginning is left as it is."""
    return text if text.startswith("<") else capitalized(text)


def _cost(context: ReportContext) -> str:
    """Return what a search cost, in the colour of a loss or of a gain."""
    outcome = context.outcome
    if outcome.blind_m2 is None:
        return ""
    css = "better" if advice.costs_nothing(outcome.cost) else "worse"
    return f'<span class="{css}">{escaped(outcome.cost)}</span>'


def _blind_ground(context: ReportContext) -> str:
    blind = context.outlook.blind
    extents = {side: blind.zone[side] for side in SIDES if blind.zone[side] != 0.0}
    what = f"objects {blind.height:g} m tall"
    if not extents:
        return f"{what} are seen all around the body"
    distances = [
        f"more than {blind.within:g} m {SIDES[side]}"
        if end is None
        else f"up to {number(sight.shown_end(end), 1)} m {SIDES[side]}"
        for side, end in extents.items()
    ]
    return f"{what} are not seen next to the body: {joined(distances)}"


def _worst_loss_line(context: ReportContext) -> str:
    scores = context.after.per_sensor
    if len(scores) < 2:
        return "the rig has a single sensor: without it, nothing is seen"
    name = max(scores, key=lambda name: scores[name].lost)
    return f"the rig loses most without <b>{escaped(name)}</b>: {number(scores[name].lost)} nats"


def _warning_link(context: ReportContext) -> str:
    if not context.warnings:
        return ""
    return f'<a href="#advice">{plural(len(context.warnings), "warning")}</a>'


def _sensor_counts(context: ReportContext) -> str:
    """Return "2 LiDARs and 1 camera", the sensors of each kind."""
    rig_kinds = [kinds.kind_of(sensor) for sensor in context.rig]
    counts = []
    for kind in dict.fromkeys(rig_kinds):
        number_of = rig_kinds.count(kind)
        noun = kind.label if number_of == 1 else kind.plural
        counts.append(f"{number_of} {noun.lower() if noun.istitle() else noun}")
    return escaped(joined(counts))


def _vehicle_text(context: ReportContext) -> str:
    vehicle = context.vehicle
    if vehicle is None:
        return "no vehicle (nothing is occluded)"
    size = vehicle.bounds[1] - vehicle.bounds[0]
    name = (context.study.mesh or "a vehicle").replace("\\", "/").rpartition("/")[2]
    return f"{escaped(name)} ({' × '.join(number(side) for side in size.tolist())} m)"


def _span(bounds: tuple[float, float]) -> str:
    low, high = bounds
    return f"{high:g}" if low == -high else f"{number(low, 0)} to {number(high, 0)}"


TILES = 4
"""Tiles of a row. The last one gives way to the expected AP; its figure is in the note, too."""


def _tiles(context: ReportContext) -> str:
    before, after = context.before, context.after
    gained = after.coverage - before.coverage
    tiles = [
        *_ap_tile(context),
        _tile("Perception entropy", number(after.entropy), "nats", _entropy_note(context)),
        _tile("Coverage", percent(after.coverage, 1), "", _coverage_note(context, gained)),
        _tile("Blind ground, 0.5 m tall", *_farthest_blind(context)),
        _tile("Worst loss of one sensor", *_worst_loss(context)),
    ][:TILES]
    return f'<dl class="tiles">{"".join(tiles)}</dl>'


def _ap_tile(context: ReportContext) -> list[str]:
    """Return the tile of a search by expected AP; empty for other runs."""
    if context.outcome.in_traffic is None:
        return []
    first, last = (each.ap for each in context.outcome.in_traffic)
    below = f"{number(first, 3)} {ARROW} {number(last, 3)}, {signed(last - first, 3)}"
    return [_tile("Expected AP in traffic", number(last, 3), "", below)]


def _tile(what: str, figure: str, unit: str, below: str) -> str:
    unit = f" <small>{unit}</small>" if unit else ""
    return (
        f'<div><dt>{what}</dt><dd class="large">{figure}{unit}</dd>'
        f'<dd class="than">{below}</dd></div>'
    )


def _entropy_note(context: ReportContext) -> str:
    if not context.was_searched:
        error = f" ± {number(context.after.stderr, 3)}" if context.after.stderr else ""
        return f"lower is better{error}"
    gain = context.after.entropy - context.before.entropy
    return (
        f"{number(context.before.entropy)} {ARROW} {number(context.after.entropy)}, {signed(gain)}"
    )


def _coverage_note(context: ReportContext, gained: float) -> str:
    if not context.was_searched:
        return "of expected objects, by any sensor"
    return f"{percent(context.before.coverage, 1)} before, {percent_points(gained)}"


def _farthest_blind(context: ReportContext) -> tuple[str, str, str]:
    zone = context.outlook.blind.zone
    away = {side: float("inf") if end is None else end for side, end in zone.items()}
    side = max(away, key=lambda side: away[side])
    if away[side] == 0.0:
        return "none", "", "all around, within 10 m"
    end = zone[side]
    figure = "&gt; 10" if end is None else number(sight.shown_end(end), 1)
    return figure, "m", f"from the body, {SIDES[side]}"


def _worst_loss(context: ReportContext) -> tuple[str, str, str]:
    scores = context.after.per_sensor
    name = max(scores, key=lambda name: scores[name].lost)
    return signed(scores[name].lost), "nats", escaped(name)


def _picture(context: ReportContext) -> str:
    return labelled_picture_of(context, f"The vehicle with {_sensor_counts(context)}")


def _entropy_explained() -> str:
    return (
        '<p class="note">Perception entropy is the uncertainty of a detector, averaged over the '
        "voxels where objects are expected. An unseen voxel has "
        f"{number(metric.H_BLIND, 1)} nats, a voxel seen as well as possible "
        f"{number(metric.H_BEST, 1)}. One nat is a factor of about 1.6 in the standard deviation "
        "of the detector's error.</p>"
    )


def warnings_and_text(context: ReportContext) -> Section:
    """Return the warnings about the study, and its score as text."""
    warnings = "".join(_warning(warning) for warning in context.warnings)
    warnings = warnings or "<p>No warnings about the vehicle or the mounting.</p>"
    lines = advice.words(
        context.after, context.rig, context.vehicle, context.outlook, context.warnings
    )
    text = "".join(_nested_list(lines))
    inside = f"{_simplified_note(context)}{warnings}<h3>The score as text</h3>{text}"
    return Section("advice", "Warnings", inside)


def _warning(warning: pe.Advice) -> str:
    who, text = warning.line[: -len(warning.text)], warning.text
    return f'<p class="warned"><b>{escaped(who)}</b>{escaped(text)}</p>'


def _simplified_note(context: ReportContext) -> str:
    shown, error = context.display_vehicle
    if shown is None or context.vehicle is None or shown is context.vehicle:
        return ""
    return (
        f'<p class="note">Rays were cast at all {len(context.vehicle.triangles):,} triangles of '
        f"the vehicle. This page draws {len(shown.triangles):,} of them; its surface deviates by "
        f"at most {1000.0 * error:.0f} mm.</p>"
    )


def _nested_list(lines: Sequence[str]) -> Iterator[str]:
    """Yield an HTML list; lines that begin with a space are a list below the line before."""
    yield '<ul class="plain">'
    below = False
    for row, line in enumerate(lines):
        if line.startswith(" "):
            yield "" if below else "<ul>"
            below = True
        elif row:
            yield f"{'</ul>' if below else ''}</li>"
            below = False
        yield f"<li>{escaped(line.strip())}{'</li>' if below else ''}"
    yield f"{'</ul>' if below else ''}{'</li>' if lines else ''}</ul>"
