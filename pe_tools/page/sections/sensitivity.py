"""How sure the search is: what steps cost (SVG and table), constraints, other optima."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from ... import jobs
from ... import sensitivity as sure
from ..markup import Markup, escaped, number, signed, table, triple
from ..report_context import ReportContext, Section

AxisMap = Callable[[float], float]
"""Maps a value to its position on the drawing."""
WIDTH = 484
LEFT, RIGHT, ROW, GROUP, TOP, BOTTOM = 120, 40, 18, 30, 10, 26
LEAST_NATS, LEAST_AP = 0.004, 0.0004
"""The axis of costs shows at least this, so that noise does not look like a slope [nats; AP]."""
STATUS = {
    "free": "free",
    "surface": "on its mount",
    "slot": "in its slot",
    "fixed": "held",
    "linked": "linked",
}
"""What the search does with an axis, in the table."""
STYLE = """
.flatness { max-width: 100%; height: auto; }
.flatness text { font-size: 12px; fill: var(--soft); }
.flatness .name { font-size: 13px; font-weight: 650; fill: var(--ink); }
.flatness .rise { fill: var(--bad); }
.flatness .fall { fill: var(--accent); }
.flatness .error { stroke: var(--ink); stroke-opacity: .6; }
.flatness .axis { stroke: var(--was); }
.flatness .grid { stroke: var(--line); }
.noise { color: var(--soft); }
"""


def sensitivity(context: ReportContext) -> Section:
    """Return the section on how sure the search is; empty without the analysis."""
    found = context.outcome.sensitivity
    if found is None:
        return Section("sensitivity", "How sure the search is", "")
    parts = (
        _lead(found, context),
        _picture(found),
        _table(found),
        _constraints(found),
        _endings(found, context),
    )
    style = (STYLE,)
    return Section("sensitivity", "How sure the search is", "".join(parts), styles=style)


def _lead(found: sure.Sensitivity, context: ReportContext) -> str:
    _, what = jobs.searched_on(context.start)
    return (
        f"<p>Everything here is evaluated on {found.voxels:,} {what} that the search has not "
        "seen.</p>"
    )


def _picture(found: sure.Sensitivity) -> str:
    """Draw what one step back and forth costs, a row for each axis of each sensor."""
    sensors = list(dict.fromkeys(row.sensor for row in found.axes))
    costs = [row.cost[step] for row in found.axes for step in (-sure.NEAR, sure.NEAR)]
    least = LEAST_AP if found.by_ap else LEAST_NATS
    low = min(-least, *(each.mean - each.stderr for each in costs))
    high = max(least, *(each.mean + each.stderr for each in costs))
    height = TOP + len(sensors) * GROUP + len(found.axes) * ROW + BOTTOM

    def to_x(cost: float) -> float:
        return LEFT + (cost - low) / (high - low) * (WIDTH - LEFT - RIGHT)

    inside = [*_grid(low, high, to_x, height, "AP" if found.by_ap else "nats")]
    y = float(TOP)
    for sensor in sensors:
        y += GROUP
        inside.append(f'<text class="name" x="4" y="{y - 8:.0f}">{escaped(sensor)}</text>')
        for row in (each for each in found.axes if each.sensor == sensor):
            inside += _bars(row, y, to_x)
            y += ROW
    by_ap = found.by_ap
    caption = (
        "What 1 cm (x, y, z) or 1&deg; (roll, pitch, yaw) back (upper bar) and forth (lower bar) "
        "costs, each sensor alone. To the right "
        f"{'the expected AP falls' if by_ap else 'the entropy rises'}; a bar to the left is a step "
        "that would gain and is not allowed, or an error of the sample (thin lines: 1 sigma)."
    )
    alt = "What a step of each sensor along each axis costs; the figures are in the table below."
    drawn = (
        f'<svg class="flatness" viewBox="0 0 {WIDTH} {height:.0f}" width="{WIDTH}" '
        f'xmlns="http://www.w3.org/2000/svg" aria-hidden="true">{"".join(inside)}</svg>'
    )
    return (
        f'<figure class="curve" role="img" aria-label="{alt}">{drawn}'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _grid(low: float, high: float, to_x: AxisMap, height: float, unit: str) -> Iterator[str]:
    for value in round_values(low, high):
        x, css = to_x(value), "axis" if value == 0.0 else "grid"
        yield f'<line class="{css}" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{height - BOTTOM}"/>'
        text = "0" if value == 0.0 else f"{value:+g}".replace("-", "\N{MINUS SIGN}")
        yield f'<text x="{x:.1f}" y="{height - 7:.0f}" text-anchor="middle">{text}</text>'
    yield f'<text x="{WIDTH - 4}" y="{height - 7:.0f}" text-anchor="end">{unit}</text>'


def round_values(low: float, high: float) -> list[float]:
    """Return three to six round values between two, 0 among them."""
    for unit in (
        1e-4,
        2e-4,
        5e-4,
        1e-3,
        2e-3,
        5e-3,
        0.01,
        0.02,
        0.05,
        0.1,
        0.2,
        0.5,
        1.0,
        2.0,
        5.0,
    ):
        first, last = -int(-low / unit), int(high / unit)
        if last - first <= 5:
            return [round(k * unit, 6) + 0.0 for k in range(first, last + 1)]
    return [0.0]


def _bars(row: sure.AxisCost, y: float, to_x: AxisMap) -> Iterator[str]:
    status = "" if row.status in ("free", "surface") else f" ({STATUS[row.status]})"
    yield (f'<text x="{LEFT - 8}" y="{y + 11:.0f}" text-anchor="end">{row.axis}{status}</text>')
    for step, top in ((-sure.NEAR, y + 2), (sure.NEAR, y + 8)):
        cost = row.cost[step]
        a, b = sorted((to_x(0.0), to_x(cost.mean)))
        css = "rise" if cost.mean >= 0.0 else "fall"
        yield (
            f'<rect class="{css}" x="{a:.1f}" y="{top:.1f}" width="{max(b - a, 0.5):.1f}" '
            f'height="5"/>'
        )
        ends = to_x(cost.mean - cost.stderr), to_x(cost.mean + cost.stderr)
        middle = top + 2.5
        yield (
            f'<line class="error" x1="{ends[0]:.1f}" x2="{ends[1]:.1f}" y1="{middle:.1f}" '
            f'y2="{middle:.1f}"/>'
        )


def _table(found: sure.Sensitivity) -> str:
    steps = sorted({step for row in found.axes for step in row.cost})
    heads = ("axis", "in the search", *(f"{_signed_step(step)}" for step in steps), "")
    rows: list[Sequence[object]] = []
    sensor = ""
    for row in found.axes:
        if row.sensor != sensor:
            sensor = row.sensor
            rows.append([sensor])
        cells = [_cost(row.cost[step]) for step in steps]
        rows.append([row.axis, STATUS[row.status], *cells, row.word])
    unit, steep = ("expected AP", "0.001 of expected AP") if found.by_ap else ("nats", "0.01 nats")
    title = f"What a step costs [{unit}]: cm along x, y, z, degrees of roll, pitch, yaw"
    note = (
        "<p>Grey: within the error of the sample (95 %). <em>steep</em>: a step of 1 costs "
        f"{steep} or more; <em>flat</em>: no step in the table has a cost that can be told from 0."
        "</p>"
    )
    return f"<details><summary>The figures</summary>{table(title, heads, rows)}{note}</details>"


def _signed_step(step: float) -> str:
    return f"{signed(step, 0)}"


def _cost(cost: sure.Difference) -> Markup:
    css = "worse" if cost.is_loss else "better" if cost.is_gain else "noise"
    return Markup(f'<span class="{css}">{signed(cost.mean, 4)}</span>')


def _constraints(found: sure.Sensitivity) -> str:
    if not found.constraints:
        return (
            "<p>No constraint is active: no step of 1 cm or 1&deg; that is forbidden would "
            f"{'raise the expected AP' if found.by_ap else 'lower the entropy'}.</p>"
        )
    rows = [
        [
            each.name or "none: a longer search would take it",
            each.step.text,
            sure.gain_text(each.gain).replace("+-", "\N{PLUS-MINUS SIGN}"),
        ]
        for each in found.constraints
    ]
    gain = f"gain [{'expected AP' if found.by_ap else 'nats'}]"
    heads = ("constraint", "step that gains most", gain)
    return table("Active constraints: steps of one sensor that would gain", heads, rows)


def _endings(found: sure.Sensitivity, context: ReportContext) -> str:
    if (ends := found.endings) is None:
        return (
            "<p>Where the starts ended was not examined: the search was too short for it "
            "(<code>sensitivity = &quot;full&quot;</code> does it all the same).</p>"
        )
    if not ends.runners_up:
        return (
            f"<p>One optimum was found: of {ends.examined} placements far from it, each leads to "
            "it without a hill between, or is no optimum of its own.</p>"
        )
    what = "expected AP lost" if found.by_ap else "entropy against the result"
    heads = ("optimum", what, "sensor", "x, y, z [m]", "roll, pitch, yaw")
    rows: list[Sequence[object]] = []
    for number_, each in enumerate(ends.runners_up, 1):
        error = number(max(each.behind.stderr, 1e-4), 4)
        behind = f"{signed(each.behind.mean, 4)} \N{PLUS-MINUS SIGN} {error}"
        for k, name in enumerate(each.moved):
            pose = each.rig[name].pose
            lead = (f"runner-up {number_}", behind) if k == 0 else ("", "")
            angles = f"{triple(pose.rotation_deg, 1)}\N{DEGREE SIGN}"
            rows.append([*lead, name, triple(pose.position), angles])
    count = len(ends.runners_up) + 1
    same = ends.same_basin
    note = (
        f"<p>The search met {count} optima with hills between them; {same} more placements far "
        "from the result lead to it. Runners-up are written as studies beside the result.</p>"
    )
    return note + table("Runners-up: other optima of the search", heads, rows)
