"""Dimensioned drawings of the vehicle and its sensors, from the side and from above."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from markupsafe import Markup

import pe_core as pe
from pe_core.base.arrays import Floats

from ... import graphics
from ..markup import number
from .ground_plan import Margins, PlanBounds, PlanDrawing, outline_of

WIDTH, MAX_HEIGHT = 460.0, 300.0
MARGINS = Margins(left=62.0, right=58.0, top=34.0, bottom=76.0)
"""For dimensions, and for the coordinates of sensors."""
LABEL_GAP = 13.0
"""Smallest distance of two labels along an edge."""
EQUAL_M = 0.005
"""Coordinates nearer to each other than this share a label."""
SHARED_LABEL = 9.0
"""Dots nearer to each other than this share a label."""
LETTER_WIDTH = 7.0
"""Mean width of a letter."""
LabelBox = tuple[float, float, float, float]
"""Left, top, right and bottom."""
INK, SOFT = "#1b1f24", "#8c959f"


def side_view(rig: pe.Rig, vehicle: pe.Vehicle, alt: str) -> Markup:
    """Return the vehicle seen from its right: heights above ground, distances from the front."""
    low, high = (corner.tolist() for corner in vehicle.bounds)
    turned = pe.Vehicle(vehicle.triangles[:, :, [0, 2, 1]] * [1.0, 1.0, -1.0])
    positions = _positions(rig)[:, [0, 2]]
    extent = (low[0], high[0]), (min(low[2], 0.0), high[2])
    drawing = _DimensionDrawing(extent, positions, alt)
    drawing.outlines(turned)
    ground = drawing.point(0.0, 0.0)[1]
    drawing.line(f"M{drawing.left - 10:.1f} {ground:.1f}H{drawing.right + 10:.1f}", INK)
    coordinates = np.stack([high[0] - positions[:, 0], positions[:, 1]], axis=1)
    return drawing.finished(rig, coordinates, "from the foremost point [m]", "height [m]")


def top_view(rig: pe.Rig, vehicle: pe.Vehicle, axle_x: float | None, alt: str) -> Markup:
    """Return the vehicle seen from above: distances from the rear axle, or else the centre."""
    low, high = (corner.tolist() for corner in vehicle.bounds)
    positions = _positions(rig)[:, :2]
    drawing = _DimensionDrawing(((low[0], high[0]), (low[1], high[1])), positions, alt)
    drawing.outlines(vehicle)
    origin = "forward of the centre [m]" if axle_x is None else "forward of the rear axle [m]"
    return drawing.finished(rig, positions - [axle_x or 0.0, 0.0], origin, "to the left [m]")


def _positions(rig: pe.Rig) -> Floats:
    return np.array([sensor.pose.position for sensor in rig], float).reshape(-1, 3)


def spread_labels(positions: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """Move positions apart by at least `gap`, each as little as possible; their order is kept.

    Neighbours that are too close are pooled and spread evenly around their mean: isotonic
    regression of the positions minus rank times `gap`. All are then shifted into [low, high] if
    they fit.
    """
    order = sorted(range(len(positions)), key=lambda k: positions[k])
    pools: list[tuple[float, int]] = []  # mean and size of each pool
    for rank, k in enumerate(order):
        mean, size = positions[k] - rank * gap, 1
        while pools and pools[-1][0] >= mean:
            before, more = pools.pop()
            mean, size = (before * more + mean * size) / (more + size), more + size
        pools.append((mean, size))
    means = [mean for mean, size in pools for _ in range(size)]
    spread = [mean + rank * gap for rank, mean in enumerate(means)]
    if spread:
        off = max(low - spread[0], 0.0) or min(high - spread[-1], 0.0)
        spread = [position + off for position in spread]
    by_index = dict(zip(order, spread, strict=True))
    return [by_index[k] for k in range(len(positions))]


class _DimensionDrawing(PlanDrawing):
    """A vehicle's extent [m] in a plane, and sensors at positions (S, 2) in it [m]."""

    def __init__(self, extent: PlanBounds, sensors: Floats, alt: str) -> None:
        self.extent, self.sensors = extent, sensors
        x, y = (
            (min(low, *values), max(high, *values))
            for (low, high), values in zip(extent, sensors.T.tolist(), strict=True)
        )
        super().__init__((x, y), alt, width=WIDTH, margins=MARGINS, max_height=MAX_HEIGHT)
        self.right = self.left + self.width

    def outlines(self, vehicle: pe.Vehicle) -> None:
        """Draw the outline of the vehicle, from above."""
        for line in outline_of(vehicle):
            self.canvas.path([self.points(line)], css="body")

    def finished(self, rig: pe.Rig, coordinates: Floats, below: str, left: str) -> Markup:
        """Write dimensions, coordinates (S, 2) along two edges, and sensors; return the drawing."""
        self._write_dimensions()
        self._write_coordinates(coordinates)
        self._text((self.left + self.right) / 2.0, self.bottom + 70.0, below, "middle")
        self._text(4.0, 12.0, left, "start")
        self._draw_sensors([*graphics.sensor_colors_on_paper(rig).values()])
        return self.canvas.svg()

    def _write_dimensions(self) -> None:
        """Write the length above, and width or height to the right, with extension lines."""
        (x0, x1), (y0, y1) = self.extent
        (a, top), (b, bottom) = self.point(x0, y1), self.point(x1, y0)
        over, beside = MARGINS.top - 14.0, self.right + 20.0
        self.line(f"M{a:.1f} {top:.1f}V{over - 5:.1f}M{b:.1f} {top:.1f}V{over - 5:.1f}", SOFT)
        self.line(f"M{a:.1f} {over:.1f}H{b:.1f}{_ticks((a, over), (b, over))}", INK)
        self._text((a + b) / 2.0, over - 4.0, f"{number(x1 - x0)} m", "middle", "strong halo")
        ends = f"M{b:.1f} {top:.1f}H{beside + 5:.1f}M{b:.1f} {bottom:.1f}H{beside + 5:.1f}"
        self.line(ends, SOFT)
        ticks = _ticks((beside, top), (beside, bottom))
        self.line(f"M{beside:.1f} {top:.1f}V{bottom:.1f}{ticks}", INK)
        middle = (top + bottom) / 2.0 + 4.0
        self._text(beside + 5.0, middle, number(y1 - y0), "start", "strong halo")

    def _write_coordinates(self, values: Floats) -> None:
        """Write the sensors' coordinates along the edges, with lines to their positions."""
        positions = self.points(self.sensors)
        edge, end = self.bottom + 8.0, self.bottom + 22.0
        for label, x, moved in _labels(positions[:, 0], values[:, 0], self.left, self.right):
            self.line(f"M{x:.1f} {edge:.1f}V{edge + 4:.1f}L{moved:.1f} {end:.1f}", SOFT)
            turn = f"rotate(-90 {moved:.1f} {end + 4:.1f})"
            self.canvas.text(
                moved + 4.0, end + 4.0, label, text_anchor="end", transform=turn, css="ink"
            )
        edge, end = self.left - 8.0, self.left - 22.0
        for label, y, moved in _labels(positions[:, 1], values[:, 1], MARGINS.top, self.bottom):
            self.line(f"M{edge:.1f} {y:.1f}H{edge - 4:.1f}L{end:.1f} {moved:.1f}", SOFT)
            self._text(end - 3.0, moved + 4.0, label, "end", "ink")

    def _draw_sensors(self, colors: Sequence[graphics.Rgb]) -> None:
        """Draw a numbered dot for each sensor; dots at one position share a label."""
        positions = self.points(self.sensors)
        groups: list[list[int]] = []
        for k, position in enumerate(positions):
            near = (g for g in groups if np.hypot(*(positions[g[0]] - position)) < SHARED_LABEL)
            group = next(near, None)
            if group is None:
                groups.append([k])
            else:
                group.append(k)
        for (x, y), color in zip(positions.tolist(), colors, strict=True):
            fill = graphics.color_text(color)
            self.canvas.add("circle", cx=x, cy=y, r=3.6, fill=fill, stroke="#fff")
        taken = [(x - 5.0, y - 5.0, x + 5.0, y + 5.0) for x, y in positions.tolist()]
        for group in groups:
            x, y = positions[group[0]].tolist()
            numbers = ", ".join(str(k + 1) for k in group)
            taken.append(self._draw_label(numbers, x, y, taken))

    def _draw_label(self, text: str, x: float, y: float, taken: Sequence[LabelBox]) -> LabelBox:
        """Write numbers beside a dot, clear of other labels if possible; return their box."""
        width = LETTER_WIDTH * len(text)
        left, middle = x - 6.0 - width, x - width / 2.0
        spots = [(x + 6.0, y - 5.0), (left, y - 5.0), (x + 6.0, y + 13.0)]
        spots += [(left, y + 13.0), (middle, y - 9.0), (middle, y + 17.0)]
        boxes = [(right, down - 9.0, right + width, down) for right, down in spots]
        overlap = graphics.boxes_overlap
        free = (box for box in boxes if not any(overlap(box, other) for other in taken))
        box = next(free, boxes[0])
        self._text(box[0], box[3], text, "start", "strong halo")
        return box

    def line(self, d: str, color: str) -> None:
        """Draw a thin line."""
        self.canvas.add("path", d=d, fill="none", stroke=color, stroke_width=1.0)

    def _text(self, x: float, y: float, text: str, anchor: str, css: str = "") -> None:
        more = {"css": css} if css else {}
        self.canvas.text(x, y, text, text_anchor=anchor, **more)


def _labels(
    positions: Floats, values: Floats, low: float, high: float
) -> Iterable[tuple[str, float, float]]:
    """Return the labels of different coordinates, with exact and shifted position."""
    different: list[tuple[float, float]] = []
    for value, exact in sorted(zip(values.tolist(), positions.tolist(), strict=True)):
        if not different or value - different[-1][0] > EQUAL_M:
            different.append((value, exact))
    moved = spread_labels([exact for _, exact in different], LABEL_GAP, low, high)
    return [
        (number(value), exact, shifted)
        for (value, exact), shifted in zip(different, moved, strict=True)
    ]


def _ticks(*positions: tuple[float, float]) -> str:
    """Return strokes across the ends of a dimension line."""
    return "".join(f"M{x - 4:.1f} {y + 4:.1f}l8 -8" for x, y in positions)
