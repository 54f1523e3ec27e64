"""Draw the figures of docs/engine.md: ``python docs/figures/kernels.py`` writes docs/images/*.svg.

They show the very voxel that is worked by hand (`worked`).
"""

from __future__ import annotations

import math
from itertools import combinations, product
from pathlib import Path

import numpy as np
import worked
from svg import BLUE, FAINT, INK, ORANGE, SKY, VERMILION, Drawing, Point

from pe_core.sensors.lidar.definition import cube_crossing

IMAGES = Path(__file__).resolve().parents[1] / "images"
CUBE = [np.array(signs) / 2.0 for signs in product((-1.0, 1.0), repeat=3)]
"""Corners of a cube, from its centre, in sides."""


def draw_bracket() -> str:
    """The tilted voxel as the sensor sees it, and from above the sensor."""
    picture = Drawing(940, 520, "A voxel between its outer and its inner window")
    _seen_by_the_sensor(picture)
    _from_above_the_sensor(picture)
    return picture.done()


def _seen_by_the_sensor(picture: Drawing) -> None:
    b = worked.bracketed()
    scale = 19_500.0  # pixels a radian

    def at(azimuth: float, slope: float) -> Point:
        """Azimuths grow to the left, as they are seen from the sensor."""
        return (
            245.0 - (azimuth - b.middle) * worked.STEP * scale,
            255.0 - (slope - b.place[2] / b.flat) * scale,
        )

    corners = [_direction(np.array(b.place) + c @ _turn()) for c in CUBE]
    picture.text((24, 32), "As the sensor sees it", size=15, weight="bold")
    picture.area(_hull([at(*c) for c in corners]), SKY, INK, 1.2, opacity=0.25)
    picture.area(_box(at, b.outer), color=INK, width=1.6, dash="7 4")
    picture.area([at(*_direction(p)) for p in _slice(b)], ORANGE, ORANGE, 1.0, opacity=0.35)
    picture.area(_box(at, b.inner), color=VERMILION, width=2.2)
    for row in range(36, 43):
        for column in range(80, 86):
            place = at(column, worked.SLOPES[row])
            must = row in b.inner.rows and column in b.inner.columns
            may = row in b.outer.rows and column in b.outer.columns
            fill = VERMILION if must else BLUE if _passes(b, row, column) else "#ffffff"
            picture.dot(place, 4.5 if may else 2.0, fill if may else FAINT, INK if may else FAINT)
    for column in range(80, 86):
        color = INK if column in b.outer.columns else FAINT
        picture.text((at(column, 0)[0], 478), str(column), color, size=11, anchor="middle")
    for row in range(36, 43):
        color = INK if row in b.outer.rows else FAINT
        picture.text((24, at(0, worked.SLOPES[row])[1] + 4), str(row), color, size=11)
    picture.text((245, 500), "azimuth, in steps of 0.2 degrees", size=12, anchor="middle")
    picture.text((24, 62), "channel", size=12)
    _legend(picture)


def _legend(picture: Drawing) -> None:
    m = worked.defined(worked.TILTED, worked.TILTED_CENTER)
    b = worked.bracketed()
    x, y = 480.0, 330.0
    picture.area([(x, y), (x + 26, y), (x + 26, y + 16), (x, y + 16)], dash="7 4", width=1.6)
    picture.text((x + 38, y + 13), f"outer window: {b.outer.beams} beams may pass")
    y += 28
    picture.area([(x, y), (x + 26, y), (x + 26, y + 16), (x, y + 16)], SKY, INK, opacity=0.25)
    picture.text((x + 38, y + 13), f"the voxel: {m} beams pass")
    y += 28
    picture.area([(x, y), (x + 26, y), (x + 26, y + 16), (x, y + 16)], ORANGE, ORANGE, opacity=0.35)
    picture.text((x + 38, y + 13), "slice, upright between the silhouette's two edges")
    y += 28
    picture.area([(x, y), (x + 26, y), (x + 26, y + 16), (x, y + 16)], color=VERMILION, width=2.2)
    picture.text((x + 38, y + 13), f"inner window, in the slice: {b.inner.beams} beams must pass")
    y += 36
    for k, (fill, words) in enumerate(
        [
            (VERMILION, "counted by the inner window"),
            (BLUE, "passes, as a test of its own finds"),
            ("#ffffff", "does not pass, as that test finds"),
        ]
    ):
        picture.dot((x + 13, y + 22 * k), 4.5, fill)
        picture.text((x + 38, y + 22 * k + 5), words)


def _from_above_the_sensor(picture: Drawing) -> None:
    b = worked.bracketed()
    scale = 105.0

    def at(radial: float, left: float) -> Point:
        return (740.0 + radial * scale, 165.0 - left * scale)

    corners = [_radial(b, c @ _turn()) for c in CUBE]
    picture.text((470, 32), "From above the sensor (along its axis)", size=15, weight="bold")
    picture.area(_hull([at(*c) for c in corners]), SKY, INK, 1.2, opacity=0.25)
    edge, part = (b.skew * b.width, b.width), (b.skew * b.slice_width, b.slice_width)
    picture.line([at(*edge), at(-edge[0], -edge[1])], ORANGE, 9.0)
    picture.line([at(*part), at(-part[0], -part[1])], VERMILION, 3.0)
    for radial, words in ((-b.depth, f"near {b.near:.2f}"), (b.depth, f"far {b.far:.2f}")):
        picture.line([at(radial, -1.0), at(radial, 1.0)], INK, 1.2, "7 4")
        picture.text((at(radial, 0)[0], 288), words, anchor="middle")
    picture.line([at(-2.45, 0), at(0, 0)], FAINT, 1.0)
    picture.line([(at(-2.3, 0)[0], 160), at(-2.45, 0), (at(-2.3, 0)[0], 170)], FAINT, 1.2)
    picture.dot(at(0, 0), 3.0, INK)
    picture.text(at(-2.45, 0.08), f"to the axis: {b.flat:.1f} sides", size=12)
    picture.text(at(edge[0] + 0.12, edge[1] + 0.08), "slice")


def _turn() -> np.ndarray:
    """(3, 3) row k: ground axis k along the sensor's axes."""
    return worked.TILTED.pose.ground_from_sensor


def _direction(place: np.ndarray) -> tuple[float, float]:
    """Azimuth [steps] and slope of a place in the sensor's frame."""
    x, y, z = place.tolist()
    return math.atan2(y, x) / worked.STEP, z / math.hypot(x, y)


def _radial(b: worked.Bracketed, along: np.ndarray) -> tuple[float, float]:
    """How far something reaches away from the axis, and to the left of the centre's azimuth."""
    c, s = b.place[0] / b.flat, b.place[1] / b.flat
    return float(along[0] * c + along[1] * s), float(along[1] * c - along[0] * s)


def _slice(b: worked.Bracketed) -> list[np.ndarray]:
    """Corners of the slice, in the sensor's frame: where pairs of the cube's faces meet it."""
    c, s = b.place[0] / b.flat, b.place[1] / b.flat
    left = np.array([-s + b.skew * c, c + b.skew * s, 0.0])
    axes = np.stack([_turn() @ left, _turn() @ np.array([0.0, 0.0, 1.0])], axis=1)  # (3, 2)
    found = []
    for (i, j), (p, q) in product(combinations(range(3), 2), product((-0.5, 0.5), repeat=2)):
        corner = np.linalg.solve(axes[[i, j]], [p, q])
        if (np.abs(axes @ corner) <= 0.5 + 1e-9).all():
            found.append(corner)
    return [np.array(b.place) + u * left + [0.0, 0.0, v] for u, v in _hull(found)]


def _passes(b: worked.Bracketed, row: int, column: int) -> bool:
    """Whether a beam passes the tilted voxel."""
    azimuth, slope = column * worked.STEP, worked.SLOPES[row]
    beam = np.array([math.cos(azimuth), math.sin(azimuth), slope]) @ _turn().T
    enter, leave = cube_crossing(np.array([b.offset]), beam[None] / np.linalg.norm(beam))
    return bool(enter[0] < leave[0])


def _box(at: object, window: worked.Window) -> list[Point]:
    corners = [(a, s) for a in (window.first, window.last) for s in (window.low, window.high)]
    return [at(*corners[k]) for k in (0, 1, 3, 2)]  # type: ignore[operator]


def _hull(points: object) -> list[Point]:
    """The corners of points' convex hull, in order (monotone chain)."""
    ordered = sorted((float(x), float(y)) for x, y in points)  # type: ignore[attr-defined]
    chains: list[list[Point]] = []
    for way in (ordered, ordered[::-1]):
        chain: list[Point] = []
        for p in way:
            while len(chain) > 1 and _turns_right(chain[-2], chain[-1], p):
                chain.pop()
            chain.append(p)
        chains.append(chain[:-1])
    return chains[0] + chains[1]


def _turns_right(a: Point, b: Point, c: Point) -> bool:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) <= 1e-12


FIGURES = {"bracket.svg": draw_bracket}

if __name__ == "__main__":
    for name, draw in FIGURES.items():
        (IMAGES / name).write_text(draw(), "utf-8")
