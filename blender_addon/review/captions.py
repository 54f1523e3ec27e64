"""Text of the picture: headline, legend, the table of sensors, and marks at the sensors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, kinds
from .picture_geometry import DESIGN_HEIGHT, Frame
from .stage import FAINT_INK, INK, Lettering

if TYPE_CHECKING:
    from ..engine import pe


MAX_ROWS = 6
MAX_PARTS = 3
HEADINGS = ("Sensor", "Model", "x, y, z [m]", "Pitch", "Yaw", "Beams occluded by the vehicle")
START_HEADING = "Start: x, y, z [m], pitch"


@dataclass(frozen=True, slots=True)
class Caption:
    """Headline, the line below it, and a table of sensors (headings first)."""

    headline: str
    detail: str
    table: tuple[tuple[str, ...], ...]


def caption_of(study: pe.Study, outcome: pe.Outcome) -> Caption:
    """Return the caption of an outcome; `study` holds the rig that is shown."""
    before, after = outcome.before, outcome.after
    entropy, coverage = f"{after.entropy:.3f}", f"{after.coverage:.1%}"
    if outcome.kind == "optimize":
        entropy = f"{before.entropy:.3f} → {entropy}"
        coverage = f"{before.coverage:.1%} → {coverage}"
    if outcome.in_traffic is not None:
        ap = " → ".join(f"{each.ap:.3f}" for each in outcome.in_traffic)
        detail = f"higher is better        entropy {entropy} nats, coverage {coverage}"
        return Caption(f"Expected AP in traffic  {ap}", detail, _table(study, outcome))
    error = f", ± {max(after.stderr, 1e-3):.3f}" if after.stderr else ""
    detail = f"nats{error}; lower is better        coverage {coverage}"
    return Caption(f"Perception entropy  {entropy}", detail, _table(study, outcome))


def position(pose: pe.Pose) -> str:
    """Return a position in metres, to the centimetre: "-0.43, 0.00, 1.80"."""
    return ", ".join(_number(value, 2) for value in pose.position)


def angle(degrees: float) -> str:
    """Return an angle to the tenth of a degree: "-2.5°"."""
    return f"{_number(abs(degrees) if degrees == -180.0 else degrees, 1)}°"


def occluded_text(score: pe.SensorScore | None) -> str:
    """Return the share of occluded beams and the occluding parts: "0.5 % (hood, body)"."""
    if score is None or not score.beams:
        return "–"
    parts = sorted(score.occluded_by, key=lambda part: -score.occluded_by[part])
    named = ", ".join(parts[:MAX_PARTS]) + (", ..." if len(parts) > MAX_PARTS else "")
    return f"{score.occluded / score.beams:.1%}" + (f" ({named})" if named else "")


def _table(study: pe.Study, outcome: pe.Outcome) -> tuple[tuple[str, ...], ...]:
    moved = outcome.kind == "optimize"
    rows: list[tuple[str, ...]] = [HEADINGS + ((START_HEADING,) if moved else ())]
    for sensor in study.rig.sensors[:MAX_ROWS]:
        _, pitch, yaw = sensor.pose.rotation_deg
        pose = position(sensor.pose), angle(pitch), angle(yaw)
        occluded = occluded_text(outcome.after.per_sensor.get(sensor.name))
        row = (sensor.name, sensor.model.name, *pose, occluded)
        rows.append(row + ((_start_text(outcome, sensor.name),) if moved else ()))
    if len(study.rig) > MAX_ROWS:
        rows.append((f"and {len(study.rig) - MAX_ROWS} more",))
    return tuple(rows)


def _start_text(outcome: pe.Outcome, name: str) -> str:
    pose = outcome.start.rig[name].pose
    return f"{position(pose)}, {angle(pose.rotation_deg[1])}"


def _number(value: float, decimals: int) -> str:
    """A number with a true minus sign, and no minus before zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")


Floats = NDArray[np.float64]

GHOST: graphics.Rgba = (0.30, 0.32, 0.35, 1.0)
WHITE: graphics.Rgba = (1.0, 1.0, 1.0, 1.0)
NAME, NAME_RISE, NAME_STEP, NAME_PADDING = 18, 46, 28, 8
LETTER_WIDTH = 0.47
"""Mean width of a letter, in its size."""
RING_ROOM = 10
RING_NAME = 15
RING_AZIMUTHS_DEG = (-35.0, 105.0, -60.0, 130.0, -90.0, 160.0, -115.0, 170.0, -150.0)
"""Where a ring's distance may be written: the first of these inside the picture."""


def mark_sensors(pen: Lettering, rig: pe.Rig, moves: list[tuple[Floats, Floats]]) -> None:
    """Draw a dot on each sensor and its name above, without overlaps."""
    scale = pen.view.frame.scale
    pixels = pen.view.pixels(np.array([sensor.pose.position for sensor in rig]))
    taken = [_room_of_ring(pen, start) for start, _ in moves]
    for (x, y), sensor in sorted(zip(pixels.tolist(), rig, strict=True), key=lambda pair: pair[0]):
        color = graphics.drawing_of(sensor.kind).color(graphics.PAPER)
        pen.disc((x, y), 7.5 * scale, WHITE, layer=3)
        pen.disc((x, y), 5.5 * scale, (*color[:3], 1.0), layer=4)
        half = scale * (NAME * LETTER_WIDTH * len(sensor.name) / 2 + NAME_PADDING)
        base = y - scale * NAME_RISE
        while any(abs(x - a) < half + b and abs(base - c) < scale * NAME_STEP for a, b, c in taken):
            base -= scale * 4
        taken.append((x, half, base))
        pen.line((x, base), (x, y), scale * 1.4, FAINT_INK, layer=1)
        pen.rectangle(x - half, base - scale * 19, x + half, base + scale * 8, WHITE, layer=2)
        pen.write(sensor.name, (x, base), scale * NAME, align="CENTER")


def _room_of_ring(pen: Lettering, start: Floats) -> tuple[float, float, float]:
    """Middle, half width and base line [px] of the area of the ring at a start."""
    x, y = pen.view.pixels(start[None])[0].tolist()
    return x, RING_ROOM * pen.view.frame.scale, y + RING_ROOM / 2 * pen.view.frame.scale


def mark_moves(pen: Lettering, moves: list[tuple[Floats, Floats]]) -> None:
    """Draw a ring at each sensor's start (3,) [m], and a line to its present position (3,)."""
    scale = pen.view.frame.scale
    for start, end in moves:
        first, last = pen.view.pixels(np.array([start, end])).tolist()
        pen.line(first, last, scale * 4.0, WHITE, layer=1)
        pen.line(first, last, scale * 2.0, GHOST, layer=2)
        pen.ring(first, scale * 6.5, GHOST, layer=3)


def mark_rings(pen: Lettering, radii_m: tuple[float, ...], color: graphics.Rgba) -> None:
    """Write the distance of each ring where the text is readable."""
    frame, scale = pen.view.frame, pen.view.frame.scale
    for radius in radii_m:
        for azimuth in np.radians(RING_AZIMUTHS_DEG):
            point = radius * np.array([[np.cos(azimuth), np.sin(azimuth), 0.0]])
            x, y = pen.view.pixels(point)[0].tolist()
            if frame.left < x < frame.right and frame.top < y < frame.bottom - 20 * scale:
                pen.write(f"{radius:g} m", (x, y + 18 * scale), scale * RING_NAME, color, "CENTER")
                break


MARGIN, HEAD_HEIGHT = 44, 120
HEADLINE, HEADLINE_Y, DETAIL_Y = 34, 62, 95
TEXT, ROW, STRIP_PADDING = 18, 27, 30
COLUMNS = (0, 200, 400, 600, 690, 780, 1180)
"""Mean width of a letter, in its size."""
STRIP: graphics.Rgba = (1.0, 1.0, 1.0, 1.0)

Legend = list[tuple[str, graphics.Rgba, str]]


def frame_of(rows: int, size: tuple[int, int]) -> Frame:
    """Return the part of the picture for the subject, above a table with this number of rows."""
    scale = size[1] / DESIGN_HEIGHT
    bottom = size[1] - scale * (_strip_height(rows) + 10)
    return Frame(*size, scale * MARGIN, size[0] - scale * MARGIN, scale * HEAD_HEIGHT, bottom)


def legend_of(rig: pe.Rig, *, stopped: bool, moved: bool) -> Legend:
    """Return text, colour and mark ("line" or "ring") of each item of the legend."""
    present = {sensor.kind for sensor in rig}
    entries: Legend = []
    for kind in kinds.KINDS.values():
        if kind.name in present:
            drawing = graphics.drawing_of(kind.name)
            entries.append(
                (drawing.look.legend or kind.label, drawing.color(graphics.PAPER), "line")
            )
            if drawing.beams and stopped:
                entries.append(("occluded by the vehicle", graphics.PAPER.stopped, "line"))
    if moved:
        entries.append(("where it started", GHOST, "ring"))
    return entries


def write_page(pen: Lettering, words: Caption, legend: Legend) -> None:
    """Write headline, legend and table."""
    scale = pen.view.frame.scale
    pen.write(words.headline, (scale * MARGIN, scale * HEADLINE_Y), scale * HEADLINE)
    pen.write(words.detail, (scale * MARGIN, scale * DETAIL_Y), scale * TEXT, FAINT_INK)
    _write_legend(pen, legend, scale)
    _write_table(pen, words.table, scale)


def _write_table(pen: Lettering, table: tuple[tuple[str, ...], ...], scale: float) -> None:
    frame = pen.view.frame
    top = frame.height - scale * _strip_height(len(table))
    pen.rectangle(0, top, frame.width, frame.height, STRIP)
    ends = (*COLUMNS[1:], frame.width / scale - 2 * MARGIN)
    for number, row in enumerate(table):
        y = top + scale * (STRIP_PADDING + number * ROW)
        ink = FAINT_INK if number == 0 else INK
        for text, x, end in zip(row, COLUMNS, ends, strict=False):
            pen.write(_shortened(text, end - x), (scale * (MARGIN + x), y), scale * TEXT, ink)


def _write_legend(pen: Lettering, legend: Legend, scale: float) -> None:
    widest = max((len(text) for text, _, _ in legend), default=0)
    left = pen.view.frame.width - scale * (MARGIN + TEXT * LETTER_WIDTH * widest)
    for number, (text, color, mark) in enumerate(legend):
        y = scale * (56 + number * 26)
        pen.write(text, (left, y), scale * TEXT)
        middle, solid = y - scale * 6, (*color[:3], 1.0)
        if mark == "line":
            ends = (left - scale * 50, middle), (left - scale * 14, middle)
            pen.line(*ends, scale * 4, solid, layer=1)
        else:
            pen.ring((left - scale * 32, middle), scale * 6, solid, layer=1)


def _shortened(text: str, width: float) -> str:
    """Return the text, cut at the end if it is wider than the column."""
    fits = int(width / (TEXT * LETTER_WIDTH)) - 1
    return text if len(text) <= fits else text[: fits - 1].rstrip() + "…"


def _strip_height(rows: int) -> float:
    return rows * ROW + STRIP_PADDING
