"""The vehicle with its dimensions and where its sensors sit, from above and from the side."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, pe
from ..figures import number
from ..markup import Markup
from .plan import outline_of
from .svg import Canvas, hexadecimal

Floats = NDArray[np.float64]
Extent1d = tuple[float, float]

WIDE = 460.0
LEFT, RIGHT, TOP, BOTTOM = 62.0, 58.0, 34.0, 76.0
"""Room round the vehicle for its dimensions and the sensors' ordinates."""
MOST_HIGH = 300.0
PITCH = 13.0
"""Least distance of two labels of an edge; they are moved apart to it."""
SAME_M = 0.005
"""Ordinates nearer to each other than this have one label."""
NEAR = 9.0
"""Dots nearer to each other than this are numbered together."""
LETTER = 7.0
"""Width of a letter of a number."""
LabelBox = tuple[float, float, float, float]
"""Left, top, right and bottom."""
INK, SOFT = "#1b1f24", "#8c959f"


@dataclass(frozen=True, slots=True)
class ViewPlane:
    """What one drawing shows.

    Attributes
    ----------
    outlines : sequence of (N, 2) float
        The vehicle, in the plane of the drawing [m].
    across, up : (float, float)
        Where the vehicle begins and ends along the drawing's axes [m].
    sensors : (S, 2) float
        Their positions in that plane [m].
    ordinates : (S, 2) float
        The figures that are written of them, along the edge below and the left one [m].
    below, left : str
        What these figures are.
    ground : bool
        Whether a line is drawn where the second axis is 0.
    """

    outlines: Sequence[Floats]
    across: Extent1d
    up: Extent1d
    sensors: Floats
    ordinates: Floats
    below: str
    left: str
    ground: bool = False


def side_view(rig: pe.Rig, vehicle: pe.Vehicle, alt: str) -> Markup:
    """Return the vehicle from its right side: heights over ground, distances from the front."""
    low, high = vehicle.bounds
    places = _positions(rig)
    turned = vehicle.triangles[:, :, [0, 2, 1]] * [1.0, 1.0, -1.0]
    plane = ViewPlane(
        outline_of(pe.Vehicle(turned)),
        (float(low[0]), float(high[0])),
        (min(float(low[2]), 0.0), float(high[2])),
        places[:, [0, 2]],
        np.stack([float(high[0]) - places[:, 0], places[:, 2]], axis=1),
        "from the foremost point [m]",
        "height [m]",
        ground=True,
    )
    return _drawn(plane, alt)


def top_view(rig: pe.Rig, vehicle: pe.Vehicle, axle_x: float | None, alt: str) -> Markup:
    """Return the vehicle from above: distances from the rear axle, else the middle; sideways."""
    low, high = vehicle.bounds
    places = _positions(rig)
    plane = ViewPlane(
        outline_of(vehicle),
        (float(low[0]), float(high[0])),
        (float(low[1]), float(high[1])),
        places[:, :2],
        places[:, :2] - [axle_x or 0.0, 0.0],
        "forward of the middle [m]" if axle_x is None else "forward of the rear axle [m]",
        "to the left [m]",
    )
    return _drawn(plane, alt)


def spread(places: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """Return places at least `gap` apart, each as near to its own as may be, by their order.

    Neighbours that are too near are pooled and stand evenly round their mean (isotonic regression
    of the places less their ranks' gaps). All are then moved into `low` to `high` if they fit.
    """
    order = sorted(range(len(places)), key=lambda k: places[k])
    pools: list[tuple[float, int]] = []  # mean of what is pooled, and how many
    for rank, k in enumerate(order):
        mean, many = places[k] - rank * gap, 1
        while pools and pools[-1][0] >= mean:
            before, more = pools.pop()
            mean, many = (before * more + mean * many) / (more + many), more + many
        pools.append((mean, many))
    means = [mean for mean, many in pools for _ in range(many)]
    placed = [mean + rank * gap for rank, mean in enumerate(means)]
    if placed:
        off = max(low - placed[0], 0.0) or min(high - placed[-1], 0.0)
        placed = [place + off for place in placed]
    found = dict(zip(order, placed, strict=True))
    return [found[k] for k in range(len(places))]


def _positions(rig: pe.Rig) -> Floats:
    return np.array([sensor.pose.position for sensor in rig], float).reshape(-1, 3)


def _drawn(plane: ViewPlane, alt: str) -> Markup:
    drawing = _DimensionDrawing(plane, alt)
    drawing.vehicle()
    drawing.dimensions()
    drawing.ordinates()
    drawing.sensors()
    return drawing.canvas.svg()


class _DimensionDrawing:
    """A drawing being made."""

    def __init__(self, plane: ViewPlane, alt: str) -> None:
        self.plane = plane
        (x0, x1), (y0, y1) = (
            (min(low, *values), max(high, *values))
            for (low, high), values in zip(
                (plane.across, plane.up), plane.sensors.T.tolist(), strict=True
            )
        )
        self.x0, self.y1 = x0, y1
        self.scale = min((WIDE - LEFT - RIGHT) / (x1 - x0), MOST_HIGH / (y1 - y0))
        self.left = LEFT + (WIDE - LEFT - RIGHT - (x1 - x0) * self.scale) / 2.0
        self.right = self.left + (x1 - x0) * self.scale
        self.bottom = TOP + (y1 - y0) * self.scale
        self.canvas = Canvas(WIDE, self.bottom + BOTTOM, alt)

    def at(self, points: Floats) -> Floats:
        """(N, 2) places in the drawing of points (N, 2) in the plane [m]."""
        x = self.left + (points[:, 0] - self.x0) * self.scale
        return np.stack([x, TOP + (self.y1 - points[:, 1]) * self.scale], axis=1)

    def vehicle(self) -> None:
        """Draw the outline, and the ground below it."""
        for line in self.plane.outlines:
            self.canvas.path([self.at(line)], css="body")
        if self.plane.ground:
            down = self.at(np.zeros((1, 2)))[0, 1]
            self._line(f"M{self.left - 10:.1f} {down:.1f}H{self.right + 10:.1f}", INK)

    def dimensions(self) -> None:
        """Write length above, width or height to the right, between lines at the ends."""
        (x0, x1), (y0, y1) = self.plane.across, self.plane.up
        (a, top), (b, bottom) = self.at(np.array([[x0, y1], [x1, y0]])).tolist()
        over, beside = TOP - 14.0, self.right + 20.0
        self._line(f"M{a:.1f} {top:.1f}V{over - 5:.1f}M{b:.1f} {top:.1f}V{over - 5:.1f}", SOFT)
        self._line(f"M{a:.1f} {over:.1f}H{b:.1f}{_ticks((a, over), (b, over))}", INK)
        self._text((a + b) / 2.0, over - 4.0, f"{number(x1 - x0)} m", "middle", "strong halo")
        ends = f"M{b:.1f} {top:.1f}H{beside + 5:.1f}M{b:.1f} {bottom:.1f}H{beside + 5:.1f}"
        self._line(ends, SOFT)
        self._line(
            f"M{beside:.1f} {top:.1f}V{bottom:.1f}{_ticks((beside, top), (beside, bottom))}", INK
        )
        middle = (top + bottom) / 2.0 + 4.0
        self._text(beside + 5.0, middle, number(y1 - y0), "start", "strong halo")

    def ordinates(self) -> None:
        """Write the sensors' figures along the edges, led to where the sensors are."""
        places, figures = self.at(self.plane.sensors), self.plane.ordinates
        edge, end = self.bottom + 8.0, self.bottom + 22.0
        for label, x, moved in self._labels(places[:, 0], figures[:, 0], self.left, self.right):
            self._line(f"M{x:.1f} {edge:.1f}V{edge + 4:.1f}L{moved:.1f} {end:.1f}", SOFT)
            turn = f"rotate(-90 {moved:.1f} {end + 4:.1f})"
            self.canvas.text(
                moved + 4.0, end + 4.0, label, text_anchor="end", transform=turn, css="ink"
            )
        edge, end = self.left - 8.0, self.left - 22.0
        for label, y, moved in self._labels(places[:, 1], figures[:, 1], TOP, self.bottom):
            self._line(f"M{edge:.1f} {y:.1f}H{edge - 4:.1f}L{end:.1f} {moved:.1f}", SOFT)
            self._text(end - 3.0, moved + 4.0, label, "end", "ink")
        self._text((self.left + self.right) / 2.0, self.bottom + 70.0, self.plane.below, "middle")
        self._text(4.0, 12.0, self.plane.left, "start")

    def _labels(
        self, places: Floats, figures: Floats, low: float, high: float
    ) -> Iterable[tuple[str, float, float]]:
        """Return labels of the different figures, where they belong and where they have room."""
        kept: list[tuple[float, float]] = []
        for figure, place in sorted(zip(figures.tolist(), places.tolist(), strict=True)):
            if not kept or figure - kept[-1][0] > SAME_M:
                kept.append((figure, place))
        moved = spread([place for _, place in kept], PITCH, low, high)
        return [
            (number(figure), place, there)
            for (figure, place), there in zip(kept, moved, strict=True)
        ]

    def sensors(self) -> None:
        """Draw a dot a sensor, numbered; those on one place have their numbers together."""
        places = self.at(self.plane.sensors)
        groups: list[list[int]] = []
        for k, place in enumerate(places):
            near = (g for g in groups if np.hypot(*(places[g[0]] - place)) < NEAR)
            group = next(near, None)
            if group is None:
                groups.append([k])
            else:
                group.append(k)
        for k, (x, y) in enumerate(places.tolist()):
            color = hexadecimal(graphics.sensor_color_on_paper(k))
            self.canvas.add("circle", cx=x, cy=y, r=3.6, fill=color, stroke="#fff")
        taken = [(x - 5.0, y - 5.0, x + 5.0, y + 5.0) for x, y in places.tolist()]
        for group in groups:
            x, y = places[group[0]].tolist()
            numbers = ", ".join(str(k + 1) for k in group)
            taken.append(self._number(numbers, x, y, taken))

    def _number(self, words: str, x: float, y: float, taken: Sequence[LabelBox]) -> LabelBox:
        """Write a number beside its dot, where it lies on no other if there is such a place."""
        wide = LETTER * len(words)
        spots = [(x + 6.0, y - 5.0), (x - 6.0 - wide, y - 5.0), (x + 6.0, y + 13.0)]
        spots += [(x - 6.0 - wide, y + 13.0), (x - wide / 2.0, y - 9.0), (x - wide / 2.0, y + 17.0)]
        boxes = [(left, down - 9.0, left + wide, down) for left, down in spots]
        free = (box for box in boxes if not any(_overlap(box, other) for other in taken))
        box = next(free, boxes[0])
        self._text(box[0], box[3], words, "start", "strong halo")
        return box

    def _line(self, d: str, color: str) -> None:
        self.canvas.add("path", d=d, fill="none", stroke=color, stroke_width=1.0)

    def _text(self, x: float, y: float, words: str, anchor: str, css: str = "") -> None:
        more = {"css": css} if css else {}
        self.canvas.text(x, y, words, text_anchor=anchor, **more)


def _ticks(*places: tuple[float, float]) -> str:
    """Strokes across the ends of a dimension's line."""
    return "".join(f"M{x - 4:.1f} {y + 4:.1f}l8 -8" for x, y in places)


def _overlap(one: LabelBox, other: LabelBox) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
