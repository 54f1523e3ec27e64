"""What is found of objects: expected AP, points, and reach by class and direction."""

from __future__ import annotations

from ..engine import advice, pe
from ..figures import number, percent
from ..markup import escaped, table
from ..reviewed import Reviewed
from ..section import Section


def objects(one: Reviewed) -> Section:
    """Return the tables of a study that was scored on objects; of one on voxels nothing."""
    found = one.after.objects
    if found is None:
        return Section("objects", "Objects", "")
    looked = advice.objects_looked_at(found)
    error = f"{number(found.ap_stderr, 3)}"
    brief = f"Expected AP {number(found.ap, 3)}, standard error {error}, on {looked}."
    return Section("objects", "Objects", f"<p>{escaped(brief)}</p>{_found(found)}{_reach(found)}")


def _found(found: pe.ObjectScore) -> str:
    numbers = next(iter(found.per_class.values())).points if found.per_class else {}
    heads = ["", "AP", "Standard error", *(f"{n} points or more" for n in numbers)]
    rows = [
        [
            name[:1].upper() + name[1:],
            number(own.ap, 3),
            number(own.ap_stderr, 3),
            *map(percent, own.points.values()),
        ]
        for name, own in found.per_class.items()
    ]
    return table("Expected AP, and the share of objects that get so many points", heads, rows)


def _reach(found: pe.ObjectScore) -> str:
    each = found.per_class
    heads = ["", *(name[:1].upper() + name[1:] for name in each)]
    ways = next(iter(each.values())).reach if each else {}
    rows = [
        [way[:1].upper() + way[1:], *(advice.lone_reach(own.reach[way]) for own in each.values())]
        for way in ways
    ]
    return table("How far a lone object is found with AP 0.5 or more", heads, rows)
