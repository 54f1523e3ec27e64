"""The search: its curve, the moves of each sensor, what mounting errors and failures do to it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ..curve import step_curve
from ..engine import advice, pe, scene, search
from ..figures import ARROW, change, count, number, triple
from ..markup import Markup, escaped, table
from ..reviewed import Reviewed
from ..section import Section

LEAST_MOVE_M, LEAST_TURN_DEG = 5e-6, 5e-5
"""Smaller ones are those of rounding."""


def searching(one: Reviewed) -> Section:
    """Return how the search went; nothing of a study that is only scored."""
    if not one.searched:
        return Section("search", "The search", "")
    inside = f"<p>{_how(one)}</p>{_curve(one)}{_moves(one)}{_robustness(one)}"
    return Section("search", "The search", inside)


def _how(one: Reviewed) -> str:
    asked = one.asked.search
    looks = dict.fromkeys(map(one.asked.looks_at, asked.level_samples))
    levels = [f"{n:,}" if n else "all" for n in looks]
    what = "scenes of objects" if one.asked.targets.are_objects else "voxels"
    stopped = " It was stopped early." if one.outcome.stopped else ""
    return (
        f"Searched by {escaped(asked.method)} with seed {asked.seed}: "
        f"{count(one.outcome.evaluations, 'placement')} judged on {', then '.join(levels)} "
        f"{what}.{stopped}"
    )


def _curve(one: Reviewed) -> str:
    if len(one.history) < 2:
        return ""
    points = [(row.evaluation, row.entropy) for row in one.history]
    drawn = step_curve(points, one.outcome.evaluations, "placements judged", "nats")
    first, last = points[0][1], points[-1][1]
    way = f"from {number(first)} to {number(last)} nats"
    words = f"Best entropy so far: {way}, by what the search judged on."
    alt = f"Curve of the search. {words}"
    return (
        f'<figure class="curve keep" role="img" aria-label="{escaped(alt)}">{drawn}'
        f"<figcaption>{words}</figcaption></figure>"
    )


def _moves(one: Reviewed) -> str:
    heads = (
        "sensor",
        "moved",
        "from x, y, z [m]",
        "to x, y, z [m]",
        "turned",
        "roll, pitch, yaw [deg]",
    )
    return table("What was moved", heads, _rows(one))


def _rows(one: Reviewed) -> Iterator[list[str]]:
    for old, new in zip(one.asked.rig, one.rig, strict=True):
        moved = math.dist(old.pose.position, new.pose.position)
        turned = _turned(old.pose, new.pose)
        angles = triple(new.pose.rotation_deg, 1)
        if turned >= LEAST_TURN_DEG:
            angles = f"{triple(old.pose.rotation_deg, 1)} {ARROW} {angles}"
        yield [
            new.name,
            f"{number(moved)} m" if moved >= LEAST_MOVE_M else "stays",
            triple(old.pose.position),
            triple(new.pose.position),
            f"{number(turned, 1)}°" if turned >= LEAST_TURN_DEG else "stays",
            angles,
        ]


def _turned(old: pe.Pose, new: pe.Pose) -> float:
    """Angle of the rotation from one pose to the other [deg]."""
    first, last = (scene.rotation_matrix(*pose.rpy) for pose in (old, new))
    cosine = (float((first * last).sum()) - 1.0) / 2.0  # the trace of one's inverse by the other
    return math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))


def _robustness(one: Reviewed) -> str:
    found = one.robustness
    if found is None:
        return ""
    off = advice.off_by(found.errors.position, found.errors.angle)
    rows = [
        ["As it stands", *_of_both(found, "entropy")],
        [f"{off[:1].upper()}{off[1:]} (1 sigma), mean", *_of_both(found, "mounted_off")],
        ["... worst", *_of_both(found, "mounted_worst")],
    ]
    if found.after.failed is not None:
        rows.append(["One sensor lost, mean", *_of_both(found, "failed")])
        rows.append([_worst_lost(found), *_of_both(found, "failed_worst")])
    what = "objects" if one.after.objects else "voxels"
    title = f"What it tolerates: entropy in nats, on {found.samples:,} {what}"
    return table(title, ("", "before", "after", "change"), rows)


def _worst_lost(found: search.Robustness) -> str:
    return f"... worst ({found.after.missed})"


def _of_both(found: search.Robustness, field: str) -> list[str | Markup]:
    before, after = getattr(found.before, field), getattr(found.after, field)
    css = "better" if after < before else "worse" if after > before else ""
    less = Markup(f'<span class="{css}">{change(after - before)}</span>')
    return [number(before), number(after), less]
