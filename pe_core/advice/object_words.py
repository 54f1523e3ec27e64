"""A score on objects in words: what is found of each class, and how far."""

from __future__ import annotations

from collections.abc import Iterator

from ..scoring.object_score import FARTHEST_M, FoundClass, ObjectScore
from .figures import percent
from .outlook import SIDES

NEAREST_M = 0.5
"""A reach below this is told as nowhere."""


def object_words(found: ObjectScore) -> tuple[str, ...]:
    """Return what a score on objects tells in lines: expected AP, points, and reach by class."""
    return tuple(_lines(found))


def objects_looked_at(found: ObjectScore) -> str:
    """Return how many objects were looked at, and how they stood."""
    if found.traffic:
        return f"{found.objects:,} objects in {found.scenes:,} scenes, in traffic"
    return f"{found.objects:,} objects, none hides another"


def _lines(found: ObjectScore) -> Iterator[str]:
    each = found.per_class
    whole = f"expected AP {found.ap:.2f} +- {max(found.ap_stderr, 0.001):.3f}"
    yield f"{whole}: {', '.join(f'{name} {own.ap:.2f}' for name, own in each.items())}"
    for name, own in each.items():
        yield f"{name}: {_points(own)}found alone (AP 0.5) {reach_words(own)}"


def _points(own: FoundClass) -> str:
    """Say how many get so many points of LiDARs, with a blank behind; nothing without LiDARs."""
    if not own.points:
        return ""
    shares = ", ".join(map(percent, own.points.values()))
    return f"{shares} get {', '.join(map(str, own.points))} points or more; "


def lone_reach(metres: float) -> str:
    """Return how far a lone object is found: "73 m", "≥ 80 m" as far as was looked, "nowhere"."""
    if metres < NEAREST_M:
        return "nowhere"
    return f"{'≥ ' if metres >= FARTHEST_M else ''}{metres:.0f} m"


def reach_words(own: FoundClass) -> str:
    """Return how far a class is found to four sides."""
    found = {words: own.reach[way] for way, words in SIDES.items() if own.reach[way] >= NEAREST_M}
    if not found:
        return "nowhere ahead, behind, left or right"
    missing = ", ".join(words for words in SIDES.values() if words not in found)
    ways = ", ".join(
        f"{reach:.0f} m{' and more' if reach >= FARTHEST_M else ''} {words}"
        for words, reach in found.items()
    )
    return f"up to {ways}{f'; not {missing}' if missing else ''}"
