"""Zones of requirements in the 3D view, of those not met and of the chosen one: filled where met,
hatched where not; no scene, no GPU."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..engine import Floats, graphics, requirements, wording
from .regions import box_edges

Verdict = requirements.Verdict

MET: graphics.Rgba = (0.5, 1.0, 0.95, 1.0)
"""A light blue-green: told from every colour of the ground map below it, as a test measures."""
NOT_MET: graphics.Rgba = (0.95, 0.36, 0.16, 1.0)
NOT_CHECKED: graphics.Rgba = (0.6, 0.6, 0.6, 1.0)
FILL_ALPHA = 0.5
FAINT_ALPHA = 0.5
"""Opacity of filled samples, and of the outlines of zones that are not selected."""
ON_GROUND_M = 0.015  # Zones are drawn a little above the ground
TICK_M = 0.12
HATCH_M = 0.2
"""Distance of hatching lines along x on small samples."""
MAX_ROWS = 8  # Requirements that the legend names
SHORT_LETTERS = 34
PROBE_M = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class VerdictShape(graphics.LayerShape):
    """The zones as they are drawn, their verdicts, and why others have no place, by name."""

    verdicts: tuple[requirements.VerdictSummary, ...] = ()
    unplaced: Mapping[str, str] = field(default_factory=dict)


def requirement_zones(
    verdicts: Sequence[Verdict],
    chosen: str = "",
    before: Mapping[str, bool] | None = None,
    unplaced: Mapping[str, str] | None = None,
) -> VerdictShape:
    """Return the zones of requirements that are not met, and of the `chosen` one, by its name. Of
    that worst place, body, height and margin are drawn. `before` says whether each was met before
    the last move: the legend names what was lost or won since. `unplaced` says why a requirement
    cannot be checked."""
    lines = []
    faces = []
    thin = []
    labels = []
    for verdict in verdicts:
        color = MET if verdict.met else NOT_MET
        is_chosen = verdict.name == chosen
        if verdict.met and not is_chosen:
            continue  # what is met needs no look
        alpha = 1.0 if is_chosen else FAINT_ALPHA
        lines += _outlines(verdict, graphics.with_alpha(color, alpha))
        passed, failed, size = graphics.painted_samples(verdict)
        faces.append(_squares(passed, size, graphics.with_alpha(MET, FILL_ALPHA)))
        thin.append(_hatching(failed, size, graphics.with_alpha(NOT_MET, 0.9)))
        if is_chosen:
            more, tags = _details(verdict, color)
            lines += more
            labels += tags
    return VerdictShape(
        lines=graphics.Primitives.joined(lines),
        faces=graphics.Primitives.joined(faces),
        thin=graphics.Primitives.joined(thin),
        labels=tuple(labels),
        legend=_legend(verdicts, before or {}, unplaced or {}),
        verdicts=tuple(verdict.summary for verdict in verdicts),
        unplaced=unplaced or {},
    )


def _outlines(verdict: Verdict, color: graphics.Rgba) -> list[graphics.Primitives]:
    zone = verdict.samples.zone
    if zone.kind == "spots":
        return []
    return [
        graphics.Primitives.of(graphics.polyline(_raised(line)), color) for line in zone.outlines
    ]


def _squares(places: Floats, size: float, color: graphics.Rgba) -> graphics.Primitives:
    """Return two triangles for each place (N, 2)."""
    half = size / 2.0
    corners = np.array([(-half, -half), (half, -half), (half, half), (-half, half)])
    quads = _raised((places[:, None] + corners).reshape(-1, 2)).reshape(-1, 4, 3)
    return graphics.Primitives.of(quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3), color)


def _hatching(places: Floats, size: float, color: graphics.Rgba) -> graphics.Primitives:
    """Return slanted lines on places (N, 2): lines of neighbours continue each other."""
    half = size / 2.0
    every = max(1, round(HATCH_M / size))
    ends = np.array([(-half, -half), (half, half)])
    if every == 1:  # large samples have two more lines each
        ends = np.vstack([ends, [(-half, 0.0), (0.0, half), (0.0, -half), (half, 0.0)]])
    diagonal = np.rint((places[:, 0] - places[:, 1]) / size).astype(np.int64)
    shown = places[diagonal % every == 0]
    return graphics.Primitives.of(_raised((shown[:, None] + ends).reshape(-1, 2)), color)


def _raised(points: Floats, z: float = ON_GROUND_M) -> Floats:
    """(N, 3) points above the ground."""
    return np.column_stack([points, np.full(len(points), z)])


def _details(
    verdict: Verdict, color: graphics.Rgba
) -> tuple[list[graphics.Primitives], list[graphics.Tag]]:
    """Return the zone's height, the body at the worst place, the margin, and their labels."""
    lines = []
    labels = []
    body = next((b for b in verdict.requirement.bodies if b.name == verdict.body), None)
    zone = verdict.samples.zone
    if body is not None:
        top = verdict.requirement.zone.z[1] + body.low + body.size[2]
        for line in zone.outlines if zone.kind == "area" else ():
            upper = _raised(line, top)
            posts = np.stack([_raised(line), upper], axis=1).reshape(-1, 3)
            faint = graphics.with_alpha(color, FAINT_ALPHA)
            lines.append(graphics.Primitives.of(graphics.polyline(upper), faint))
            lines.append(graphics.Primitives.of(posts, faint))
    if verdict.worst is not None:
        x, y = verdict.worst
        lines.append(_worst_mark(x, y, body, color))
        seen = ", ".join(verdict.seen_by) or "no sensor"
        what = f"worst place: {verdict.body} seen by {seen}" if body else "nearest blind ground"
        height = body.low + body.size[2] if body is not None else 0.0
        labels.append(graphics.Tag(what, (x, y, height), graphics.VIEWPORT.words, strong=True))
    if (measure := _margin_line(verdict)) is not None:
        lines.append(measure[0])
        labels.append(measure[1])
    return lines, labels


def _worst_mark(
    x: float, y: float, body: requirements.Body | None, color: graphics.Rgba
) -> graphics.Primitives:
    """Return the edges of the body's box at a place; without a body a cross."""
    length, width, height = body.size if body is not None else (0.4, 0.4, 0.0)
    low = body.low if body is not None else ON_GROUND_M
    half = (length / 2.0, width / 2.0)
    return graphics.Primitives.of(
        box_edges((x - half[0], y - half[1], low), (x + half[0], y + half[1], low + height)), color
    )


def _margin_line(verdict: Verdict) -> tuple[graphics.Primitives, graphics.Tag] | None:
    """Return the margin as a dimension line across the zone's edge, with its text."""
    zone = verdict.samples.zone
    if verdict.margin is None or zone.kind == "spots" or not len(zone.outlines):
        return None
    edge = zone.outlines[-1]
    middles = (edge[:-1] + edge[1:]) / 2.0
    start = middles[int(np.argmax(middles @ _away(zone)))]
    probe = start + PROBE_M * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    distance = zone.distance(probe)
    outwards = np.array([distance[0] - distance[1], distance[2] - distance[3]])
    length = float(np.linalg.norm(outwards))
    if not length:
        return None
    outwards = outwards / length
    end = start + verdict.margin * outwards
    across = TICK_M * np.array([-outwards[1], outwards[0]])
    points = np.array([start, end, *(p + way for p in (start, end) for way in (-across, across))])
    white = graphics.with_alpha(graphics.VIEWPORT.words, 0.9)
    place = (float(end[0]), float(end[1]), ON_GROUND_M)
    text = f"{'at least ' if verdict.at_least else ''}{verdict.margin:+.2f} m".replace(
        "-", "\N{MINUS SIGN}"
    )
    return graphics.Primitives.of(_raised(points), white), graphics.Tag(text, place, white)


def _away(zone: requirements.PlacedZone) -> Floats:
    """Return the direction from the vehicle's origin to the zone's middle (2,)."""
    low, high = zone.bounds
    middle = (low + high) / 2.0
    length = float(np.linalg.norm(middle))
    return middle / length if length > 0.1 else np.array([0.0, 1.0])


def _legend(
    verdicts: Sequence[Verdict], before: Mapping[str, bool], unplaced: Mapping[str, str]
) -> graphics.ColorKey:
    """Return "7 of 9 requirements met", what was lost or won, and those that are not met."""
    met = sum(verdict.met for verdict in verdicts)
    preview = ", preview" if any(verdict.preview for verdict in verdicts) else ""
    asked = [verdict.requirement.robust_to for verdict in verdicts]
    others = sum(bool(under.states or under.weathers or under.mounting) for under in asked)
    shown = ", as shown" if others else ""
    title = f"{met} of {len(verdicts)} requirements met{preview}{shown}"
    rows = []
    for verdict in sorted(verdicts, key=lambda v: (v.met == before.get(v.name, v.met), v.met)):
        was = before.get(verdict.name, verdict.met)
        news = "" if was == verdict.met else "won: " if verdict.met else "lost: "
        if verdict.met and not news:
            continue
        margin = wording.margin_text(verdict.summary)
        margin = f", {margin}" if margin and not news else ""
        rows.append((MET if verdict.met else NOT_MET, f"{news}{_short(verdict.name)}{margin}"))
    rows += [(NOT_CHECKED, f"not checked: {_short(name)}") for name in unplaced]
    if len(rows) > MAX_ROWS:
        more = len(rows) - MAX_ROWS + 1
        rows = [*rows[: MAX_ROWS - 1], (NOT_MET, f"and {more} more")]
    rows = rows or [(MET, "all met")]
    if others:
        also = "other states, weathers or mounting errors"
        rows.append((NOT_CHECKED, f"{others} under {also} too: Score checks them"))
    return graphics.ColorKey(title, classes=tuple(rows))


def _short(name: str) -> str:
    return name if len(name) <= SHORT_LETTERS else f"{name[: SHORT_LETTERS - 3].rstrip()}..."
