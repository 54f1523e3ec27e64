"""The overview at the top of the page of one study, and the section with its warnings.

The overview has three sentences (question, result, notes), key figures and a picture.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from markupsafe import Markup

from pe_core import metric
from pe_core import sensors as kinds
from pe_core.scoring import sight

from ... import advice
from ..markup import capitalized, escaped, joined, macros, number
from ..pictures.vehicle_picture import labelled_picture
from ..report_context import ReportContext

SIDES = {"front": "ahead", "rear": "behind", "left": "on the left", "right": "on the right"}


def overview(contexts: tuple[ReportContext, ...]) -> dict[str, Any] | None:
    """Return the overview of a single study; several studies have the comparison instead."""
    if len(contexts) > 1:
        return None
    (context,) = contexts
    space, sensors, scores = context.study.space, _sensor_counts(context), context.after
    blind = context.outlook.blind
    moved = sum(a.pose != b.pose for a, b in zip(context.start.rig, context.rig, strict=True))
    return {
        "sensors": sensors,
        "vehicle": _vehicle_text(context),
        "classes": joined([f"a {name}" for name in context.study.prior.class_names]),
        "ahead": _span(space.x),
        "aside": _span(space.y),
        "moved": moved,
        "zones": sorted(scores.per_zone, key=lambda zone: scores.per_zone[zone].entropy),
        "costs_nothing": advice.costs_nothing(context.outcome.cost),
        "hidden": [Markup(capitalized(line)) for line in hidden_sensor_lines(context)],
        "blind": blind,
        "blind_extents": [
            f"more than {blind.within:g} m {side}"
            if (end := blind.zone[key]) is None
            else f"up to {number(sight.shown_end(end), 1)} m {side}"
            for key, side in SIDES.items()
            if blind.zone[key] != 0.0
        ],
        "farthest_blind": _farthest_blind(context),
        "worst": max(scores.per_sensor, key=lambda name: scores.per_sensor[name].lost),
        "picture": labelled_picture(context, f"The vehicle with {sensors}"),
        "unseen_nats": metric.H_BLIND,
        "best_nats": metric.H_BEST,
    }


def hidden_sensor_lines(context: ReportContext) -> list[str]:
    """Return lines, as HTML, on the sensors that see nothing or are mostly hidden."""
    sensors = advice.hidden_sensors(context.rig, context.after, context.warnings)
    bold = macros().bold
    named = [replace(sensor, name=bold(sensor.name), why=escaped(sensor.why)) for sensor in sensors]
    return list(advice.hidden_words(named))


def _sensor_counts(context: ReportContext) -> str:
    """Return "2 LiDARs and 1 camera", the sensors of each kind."""
    rig_kinds = [kinds.kind_of(sensor) for sensor in context.rig]
    counts = []
    for kind in dict.fromkeys(rig_kinds):
        count = rig_kinds.count(kind)
        noun = kind.label if count == 1 else kind.plural
        counts.append(f"{count} {noun.lower() if noun.istitle() else noun}")
    return joined(counts)


def _vehicle_text(context: ReportContext) -> str:
    vehicle = context.vehicle
    if vehicle is None:
        return "no vehicle (nothing is occluded)"
    size = vehicle.bounds[1] - vehicle.bounds[0]
    name = (context.study.mesh or "a vehicle").replace("\\", "/").rpartition("/")[2]
    return f"{name} ({' × '.join(number(side) for side in size.tolist())} m)"


def _span(bounds: tuple[float, float]) -> str:
    low, high = bounds
    return f"{high:g}" if low == -high else f"{number(low, 0)} to {number(high, 0)}"


def _farthest_blind(context: ReportContext) -> tuple[str, str, str]:
    """Return figure, unit and note on the side where blind ground at the body extends farthest."""
    zone = context.outlook.blind.zone
    away = {side: float("inf") if end is None else end for side, end in zone.items()}
    side = max(away, key=lambda side: away[side])
    if away[side] == 0.0:
        return "none", "", "all around, within 10 m"
    end = zone[side]
    figure = "> 10" if end is None else number(sight.shown_end(end), 1)
    return figure, "m", f"from the body, {SIDES[side]}"


def warnings_and_text(context: ReportContext) -> dict[str, Any]:
    """Return the warnings about the study, and its score as text."""
    lines: list[tuple[str, list[str]]] = []
    for line in advice.words(
        context.after, context.rig, context.vehicle, context.outlook, context.warnings
    ):
        if line.startswith(" ") and lines:
            lines[-1][1].append(line.strip())
        else:
            lines.append((line.strip(), []))
    shown, error_m = context.display_vehicle
    simplified = shown is not context.vehicle
    return {"lines": lines, "simplified": simplified, "shown": shown, "error_m": error_m}
