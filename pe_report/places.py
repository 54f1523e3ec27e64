"""Where searches end, beside the paper's placements: at which corners, how high, how far off."""

from __future__ import annotations

import statistics
from collections.abc import Mapping
from typing import Any

from .facts import Facts
from .paper import HALF_LENGTH_M, HALF_WIDTH_M, ROOF_M
from .problems import study_of
from .words import ABOUT_M, APART_DEG, APART_M, MOUNT_M

PlaceOf = Mapping[str, tuple[float, float, float]]

ROOF_ROWS, CORNER_ROWS = ("1_pandar64", "1_hdl64e"), ("3_default", "3_front")
"""Rows of LiDARs above a car's roof, and at a bus's corners."""


def printed(row: str) -> PlaceOf:
    """Return the paper's positions of a row [m], by sensor."""
    return {s.name: s.pose.position for s in study_of(row).rig}


def ends(facts: Facts, row: str, prior: str = "road") -> list[PlaceOf]:
    """Return the positions at the end of every search of a row [m], by sensor."""
    return [{n: tuple(p["position"]) for n, p in at.items()} for at in facts.ends(row, prior)]


def searched(facts: Facts, rows: tuple[str, ...]) -> list[str]:
    """Return those of some rows that were searched."""
    return [row for row in rows if facts.searched(row)]


def highest(row: str) -> float:
    """Return how high a row's sensors may go [m]."""
    bounds = study_of(row).search_space().bounds
    return max(axes["z"][1] for axes in bounds.values())


def above_the_roof(places: PlaceOf) -> bool:
    """Whether all sensors are above the sedan's roof."""
    return all(position[2] > ROOF_M for position in places.values())


def corners(places: PlaceOf) -> list[tuple[int, int]] | None:
    """Corners of the bus that sensors are at, by the signs of x and y; None where one is at none.

    A pair is told with its mirror image to the other side as one: the one that begins on the left.
    """
    found = sorted((1 if x > 0.0 else -1, 1 if y > 0.0 else -1) for x, y, _ in places.values())
    for x, y, _ in places.values():
        if max(abs(abs(x) - HALF_LENGTH_M), abs(abs(y) - HALF_WIDTH_M)) > ABOUT_M:
            return None
    return max(found, sorted((x, -y) for x, y in found))


def at_the_papers_place(facts: Facts, row: str) -> bool:
    """Whether all searches of a LiDAR row end at the paper's mounting place: roof, or corners."""
    if row in ROOF_ROWS:
        return all(map(above_the_roof, [*ends(facts, row), printed(row)]))
    wanted = corners(printed(row))
    return wanted is not None and all(corners(at) == wanted for at in ends(facts, row))


def height_differences(facts: Facts, rows: list[str]) -> list[float]:
    """Heights of ours above the paper's [m]: of every sensor, at the end of every search."""
    return [
        position[2] - printed(row)[name][2]
        for row in rows
        for at in ends(facts, row)
        for name, position in at.items()
    ]


def about_as_high(differences: list[float]) -> str:
    """Return "about the same height", or which way they differ on average."""
    if statistics.mean(map(abs, differences)) <= ABOUT_M:
        return "about the same height"
    mean = statistics.mean(differences)
    if abs(mean) <= APART_M:
        return "other heights"
    return f"{abs(mean):.2f} m {'higher' if mean > 0.0 else 'lower'} on average"


def near_the_paper(facts: Facts, row: str, prior: str = "road") -> int:
    """How many searches of a row end with every sensor within `MOUNT_M` of the paper's."""
    wanted = printed(row)
    return sum(
        all(_distance(position, wanted[name]) <= MOUNT_M for name, position in at.items())
        for at in ends(facts, row, prior)
    )


def apart(at: Mapping[str, Any]) -> bool:
    """Whether two LiDARs end at different heights or pitches."""
    first, second = at.values()
    height = abs(first["position"][2] - second["position"][2])
    pitch = abs(first["rotation"][1] - second["rotation"][1])
    return bool(height > APART_M or pitch > APART_DEG)


def _distance(a: tuple[float, float, float], b: tuple[float, float, float]) -> float:
    return sum((x - y) ** 2 for x, y in zip(a, b, strict=True)) ** 0.5
