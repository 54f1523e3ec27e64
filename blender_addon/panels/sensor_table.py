"""What each sensor contributes: a row a sensor, as many as there are."""

from __future__ import annotations

import bpy

from ..operators import listed_sensors
from .swatches import swatch
from .words import letters

WIDE_LETTERS = 56
"""From this room on, the parts that hide a sensor's view stand in its own row."""
NAME_SHARE, LOSS_SHARE = 0.46, 0.3
NO_FIGURE = "–"
HEADER = ("Sensor", "Loss", "Costs most", "Hidden by")


def draw_sensor_table(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw loss, where it costs most, and what hides it, of every sensor of the last result."""
    layout.label(text="Without a sensor, nats worse:")
    table = layout.box().column(align=True)
    table.active = not context.scene.perception_entropy.result_stale
    wide = letters(context) >= WIDE_LETTERS
    header = _cells(table, wide)
    for cell, text in zip(header, HEADER, strict=False):
        cell.active = False
        cell.label(text=text)
    for number, obj in enumerate(listed_sensors(context.scene)):
        _draw_row(table, obj, wide, number, active=obj == context.active_object)


def _draw_row(
    layout: bpy.types.UILayout, obj: bpy.types.Object, wide: bool, number: int, *, active: bool
) -> None:
    settings = obj.perception_entropy
    name, loss, where, *rest = _cells(layout, wide)
    name.label(text="", icon_value=swatch(number))
    name.operator("pe.select_sensor", text=obj.name, depress=active).name = obj.name
    if not settings.has_result:
        loss.label(text="not scored")
        return
    loss.label(text=settings.loss_text or NO_FIGURE, translate=False)
    where.label(text=settings.loss_where or NO_FIGURE, translate=False)
    if wide:
        _draw_parts(rest[0], settings)
    elif settings.stopped_parts:
        below = layout.row(align=True)
        below.label(text="", icon="BLANK1")
        below.label(text="Hidden by")
        _draw_parts(below, settings, 1)


def _draw_parts(
    layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, most: int = 3
) -> None:
    """Draw the parts that hide most of a sensor's view as buttons that select them."""
    row = layout.row(align=True)
    for part in settings.stopped_parts[:most]:
        text = f"{part.name} {part.share:.1%}"
        row.operator("pe.select_part", text=text, translate=False).name = part.name
    if not settings.stopped_parts:
        row.label(text=NO_FIGURE, translate=False)


def _cells(layout: bpy.types.UILayout, wide: bool) -> list[bpy.types.UILayout]:
    """Return the cells of a row: name, loss, where; and the parts where there is room."""
    half = layout.split(factor=0.6, align=True) if wide else None
    left = layout if half is None else half
    named = left.split(factor=NAME_SHARE, align=True)
    name = named.row(align=True)
    figures = named.split(factor=LOSS_SHARE, align=True)
    loss, where = figures.row(align=True), figures.row(align=True)
    loss.alignment = "RIGHT"
    return [name, loss, where] if half is None else [name, loss, where, half.row(align=True)]
