"""Dimensioned drawings of the vehicle and its sensors, from the side and from above."""

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

import pe_core as pe
from pe_core.base.arrays import Floats

from ... import graphics
from ..markup import number
from .ground_plan import Margins, PlanBounds, PlanDrawing, outline_of

WIDTH, MAX_HEIGHT = 460.0, 300.0
MARGINS = Margins(left=20.0, right=58.0, top=44.0, bottom=16.0)
SHARED_LABEL = 9.0  # Dots nearer to each other than this share a label
LETTER_WIDTH = 7.0  # Mean width of a letter
LabelBox = tuple[float, float, float, float]  # Left, top, right and bottom
INK, SOFT = "#1b1f24", "#8c959f"


def side_view(rig: pe.Rig, vehicle: pe.Vehicle, alt: str) -> Markup:
    """Return the vehicle seen from its right, on the ground."""
    low, high = (corner.tolist() for corner in vehicle.bounds)
    turned = pe.Vehicle(vehicle.triangles[:, :, [0, 2, 1]] * [1.0, 1.0, -1.0])
    extent = (low[0], high[0]), (min(low[2], 0.0), high[2])
    drawing = _DimensionDrawing(extent, _positions(rig)[:, [0, 2]], alt)
    drawing.outlines(turned)
    ground = drawing.point(0.0, 0.0)[1]
    drawing.line(f"M{drawing.left - 10:.1f} {ground:.1f}H{drawing.right + 10:.1f}", INK)
    return drawing.finished(rig)


def top_view(rig: pe.Rig, vehicle: pe.Vehicle, alt: str) -> Markup:
    """Return the vehicle seen from above."""
    low, high = (corner.tolist() for corner in vehicle.bounds)
    extent = (low[0], high[0]), (low[1], high[1])
    drawing = _DimensionDrawing(extent, _positions(rig)[:, :2], alt)
    drawing.outlines(vehicle)
    return drawing.finished(rig)


def _positions(rig: pe.Rig) -> Floats:
    return np.array([sensor.pose.position for sensor in rig], float).reshape(-1, 3)


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

    def finished(self, rig: pe.Rig) -> Markup:
        """Write dimensions, and the numbers of the sensors; return the drawing."""
        self._write_dimensions()
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


def _ticks(*positions: tuple[float, float]) -> str:
    """Return strokes across the ends of a dimension line."""
    return "".join(f"M{x - 4:.1f} {y + 4:.1f}l8 -8" for x, y in positions)
