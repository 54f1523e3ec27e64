"""Requirements: a verdict on each, its zone from above, and test bodies as the sensors see them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from markupsafe import Markup

from pe_core.scoring import requirements

from ...wording import margin_text, unseen_text, verdict_text
from ..markup import percent
from ..pictures.requirement_plans import requirement_plan
from ..pictures.sensor_views import sensor_view
from ..pictures.test_bodies import WorstBody, count_text, worst_bodies
from ..report_context import ReportContext


def requirement_verdicts(context: ReportContext) -> dict[str, Any] | None:
    """Return the verdicts of a study; None for a study without requirements."""
    verdicts = context.outcome.verdicts
    if not verdicts:
        return None
    bodies = worst_bodies(verdicts, context.rig, context.vehicle)
    alts = [f"Zone of {v.name} from above: {'met' if v.met else 'not met'}" for v in verdicts]
    return {
        "verdicts": verdicts,
        "texts": [verdict_text(verdict.summary) for verdict in verdicts],
        "margins": [_margin(verdict) for verdict in verdicts],
        "unseen": ["" if v.met else unseen_text(v.unseen_by) for v in verdicts],
        "plans": [
            requirement_plan(verdict, context.vehicle, alt)
            for verdict, alt in zip(verdicts, alts, strict=True)
        ],
        "counts": [
            [f"{each.number} {each.verdict.name}: {each.body.name}"]
            + [
                count_text(sensor, count) if (count := each.counts[sensor.name]) > 0.0 else "none"
                for sensor in context.rig
            ]
            for each in bodies
        ],
        "pictures": list(_pictures(context, bodies)),
    }


def _margin(verdict: requirements.Verdict) -> str:
    if verdict.blind_m2 is not None:
        return margin_text(verdict.summary).replace("m2", "m²")
    share = "" if verdict.met else f"; {percent(verdict.share)} of the zone pass"
    return f"{margin_text(verdict.summary)}{share}"


def _pictures(
    context: ReportContext, bodies: tuple[WorstBody, ...]
) -> Iterator[tuple[str, Markup]]:
    """Yield name and picture of each sensor that sees a body."""
    for sensor in context.rig:
        picture = sensor_view(sensor.kind).picture
        seen = [each.figure(sensor) for each in bodies if each.counts[sensor.name] > 0.0]
        if picture is not None and seen:
            shown = picture(sensor, context.display_vehicle[0], seen)
            yield sensor.name, shown.svg(f"Test bodies in the picture of {sensor.name}")
