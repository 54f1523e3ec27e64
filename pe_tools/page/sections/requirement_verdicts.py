"""Requirements: a verdict on each, its zone from above, and test bodies as the sensors see them."""

from __future__ import annotations

from collections.abc import Iterator

import pe_core as pe
from pe_core.scoring import requirements

from ...wording import hidden_text, margin_text, verdict_text
from ..markup import Markup, escaped, joined, number, percent, table
from ..pictures.requirement_plans import requirement_plan
from ..pictures.sensor_views import sensor_view
from ..pictures.svg import STYLE, figure, figure_grid
from ..pictures.test_bodies import WorstBody, count_text, worst_bodies
from ..report_context import ReportContext, Section

HEADS = ("requirement", "verdict", "margin", "worst place (x, y)", "why not seen", "fails without")
TAGS = {
    True: Markup('<span class="tag met">met</span>'),
    False: Markup('<span class="tag not-met">not met</span>'),
}
CSS = """
.tag { display: inline-block; padding: .05rem .5rem; border-radius: 3px; color: #fff;
  font-weight: 600; white-space: nowrap; }
.verdicts .whole, .counts td { white-space: nowrap; }
table.verdicts td { overflow-wrap: break-word; } .verdicts td:nth-child(3) { min-width: 7.5rem; }
.verdicts small { color: var(--soft); }
.tag.met { background: #1a7f4b; } .tag.not-met { background: #c4320a; }
"""
NOTE = (
    "A test body stands alone at every sample of a zone and has to be seen as the requirement "
    "says. Green: it is. Hatched in red: it is not; the ringed cross is the worst sample. The "
    "dashed line is the zone grown by the margin, or shrunk by it where the requirement is not "
    "met. Margins are rounded to the safe side. A verdict is a geometric check, and no approval."
)


def requirement_verdicts(context: ReportContext) -> Section:
    """Return the verdicts of a study; empty for a study without requirements."""
    verdicts = context.outcome.verdicts
    html = context.cached("requirements", lambda: _content(context)) if verdicts else ""
    return Section("requirements", "Requirements", html, styles=(STYLE, CSS))


def _content(context: ReportContext) -> str:
    verdicts = context.outcome.verdicts
    rows = [_row(number_of, verdict) for number_of, verdict in enumerate(verdicts, start=1)]
    counted = f"{sum(v.met for v in verdicts)} of {len(verdicts)} requirements are met"
    plans = [_plan(context, number_of, v) for number_of, v in enumerate(verdicts, start=1)]
    bodies = worst_bodies(verdicts, context.rig, context.vehicle)
    return (
        f"<p><b>{counted}.</b></p>"
        f"{table('Requirements and their verdicts', HEADS, rows, css='words verdicts')}"
        f'{figure_grid(plans, 17.0)}<p class="note">{NOTE}</p>'
        f"{_seen_bodies(context, bodies)}{_sources(verdicts)}"
    )


def _row(number_of: int, verdict: requirements.Verdict) -> list[object]:
    place = Markup("none")
    if verdict.worst is not None:
        x, y = (f"{number(value)} m" for value in verdict.worst)
        place = Markup(f'<span class="whole">{x}, {y}</span><br>{escaped(verdict.body or "")}')
    preset = verdict.requirement.preset
    identifier = (
        f"<br><small>{escaped(preset)}</small>" if preset not in (None, verdict.name) else ""
    )
    return [
        Markup(f"{number_of} {escaped(verdict.name)}{identifier}"),
        TAGS[verdict.met],
        _margin(verdict),
        place,
        "" if verdict.met else hidden_text(verdict.hidden),
        joined(list(verdict.breaks_without)),
    ]


def _margin(verdict: requirements.Verdict) -> str:
    if verdict.blind_m2 is not None:
        return margin_text(verdict.summary).replace("m2", "m²")
    share = "" if verdict.met else f"; {percent(verdict.share)} of the zone pass"
    return f"{margin_text(verdict.summary)}{share}"


def _plan(context: ReportContext, number_of: int, verdict: requirements.Verdict) -> Markup:
    alt = f"Zone of {verdict.name} from above: {'met' if verdict.met else 'not met'}"
    drawing = requirement_plan(verdict, context.vehicle, alt)
    caption = f"<b>{number_of} {escaped(verdict.name)}</b> {TAGS[verdict.met]}<br>"
    return figure(drawing, Markup(f"{caption}{escaped(verdict_text(verdict.summary))}"))


def _seen_bodies(context: ReportContext, bodies: tuple[WorstBody, ...]) -> str:
    """Return what each sensor has on the test bodies, as a table and as pictures."""
    if not bodies:
        return ""
    names = [sensor.name for sensor in context.rig]
    rows = [
        [f"{each.number} {each.verdict.name}: {each.body.name}", *_counts(context.rig, each)]
        for each in bodies
    ]
    caption = "Points and pixels on the test body at the worst place"
    pictures = figure_grid(_pictures(context, bodies), 24.0)
    return (
        "<h3>Test bodies as the sensors see them</h3>"
        f"{table(caption, ('requirement', *names), rows, css='counts')}{pictures}"
    )


def _counts(rig: pe.Rig, body: WorstBody) -> list[str]:
    return [
        count_text(sensor, count) if (count := body.counts[sensor.name]) > 0.0 else "none"
        for sensor in rig
    ]


def _pictures(context: ReportContext, bodies: tuple[WorstBody, ...]) -> Iterator[Markup]:
    """Yield the picture of each sensor that sees a body."""
    for sensor in context.rig:
        picture = sensor_view(sensor.kind).picture
        seen = [each.figure(sensor) for each in bodies if each.counts[sensor.name] > 0.0]
        if picture is None or not seen:
            continue
        drawing = picture(sensor, context.display_vehicle[0], seen).svg(
            f"Test bodies in the picture of {sensor.name}"
        )
        yield figure(drawing, Markup(f"<b>{escaped(sensor.name)}</b>: numbers as in the table"))


def _sources(verdicts: tuple[requirements.Verdict, ...]) -> str:
    lines = [
        f"<li>{number_of} {escaped(v.name)}: {escaped(v.requirement.source)}</li>"
        for number_of, v in enumerate(verdicts, start=1)
        if v.requirement.source
    ]
    inside = f'<ul class="plain">{"".join(lines)}</ul>'
    return f"<details><summary>Sources of the presets</summary>{inside}</details>" if lines else ""
