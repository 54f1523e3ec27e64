"""Redundancy: by how many sensors and kinds each place is seen, and what one lost sensor leaves."""

from __future__ import annotations

from pe_core.base.errors import InputError
from pe_core.scoring.requirements import Redundancy, RedundancyMap

from ..markup import Markup, escaped, percent, table
from ..pictures.ground_plan import count_map
from ..pictures.svg import STYLE, figure, figure_grid
from ..report_context import ReportContext, Section

HEIGHT_M, WITHIN_M, STEP_M = 0.8, 10.0, 0.25
"""Height of the test body, ground round the vehicle, and distance of the places [m]."""


def redundancy(context: ReportContext) -> Section:
    """Return the redundancy maps of a study; empty for a rig of one sensor."""
    html = context.cached("redundancy", lambda: _content(context)) if len(context.rig) > 1 else ""
    return Section("redundancy", "Redundancy", html, styles=(STYLE,))


def _content(context: ReportContext) -> str:
    study = context.study
    try:
        seen = Redundancy(study.vehicle, study.space, HEIGHT_M, WITHIN_M, STEP_M).map(context.rig)
    except InputError as error:  # a kind of sensor that measures voxels alone
        return f"<p>Not available: {escaped(error)}.</p>"
    cells = seen.cells
    bounds = (float(cells.x0[0]), float(cells.x1[-1])), (float(cells.y0[0]), float(cells.y1[-1]))
    maps = {
        "Sensors": ("that see the test body", seen.sensors),
        "Sensors left": ("the fewest when any one sensor is lost", seen.sensors_left),
        "Kinds": ("of sensors that see the test body", seen.kinds),
        "Kinds left": ("the fewest when any one sensor is lost", seen.kinds_left),
    }
    figures = [
        figure(
            count_map(values, bounds, study.vehicle, f"Map of {name.lower()}, {context.name}"),
            Markup(f"<b>{name}</b>: {about}"),
        )
        for name, (about, values) in maps.items()
    ]
    note = (
        f"A test body stands alone at each place: a cylinder 0.3 m wide and {HEIGHT_M:g} m tall, "
        f"within {WITHIN_M:g} m of the vehicle. A sensor sees it if a beam or a pixel meets it."
    )
    return f"<p>{note}</p>{figure_grid(figures)}{_shares(seen)}"


def _shares(seen: RedundancyMap) -> str:
    """Return the shares of the ground as a table."""
    rows = [
        (
            f"{count} or more",
            percent(seen.share(count), 1),
            percent(seen.share(count, one_lost=True), 1),
        )
        for count in range(1, len(seen.by_sensor) + 1)
    ]
    rows += [
        (
            f"{count} kinds",
            percent(seen.share(1, count), 1),
            percent(seen.share(1, count, one_lost=True), 1),
        )
        for count in range(2, int(seen.kinds.max(initial=0)) + 1)
    ]
    heads = ("seen by", "share of the ground", "with any one sensor lost")
    return table("Ground by the number of sensors that see the test body", heads, rows)
