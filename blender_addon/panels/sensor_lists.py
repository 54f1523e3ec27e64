"""Sensors as lists: one with switches and models, one with what each sensor contributes."""

from __future__ import annotations

from typing import Any

from bpy.types import Context, Object, PropertyGroup, Scene, UILayout

from ..language import draw_label
from ..operators import listed_sensors
from ..properties import SensorFigures, figures_of_sensor
from .layout import letters_per_line, row_list

MIN_NAME_SHARE = 0.34
"""Smallest share of a row for the name."""
BESIDE_LETTERS = 9
"""Width of switches and the figure in a row, in letters."""
MAX_ROWS = 7
"""More sensors are a list that scrolls: the panel stays as long as it is."""
SHOWN_ITEM = 1 << 30
"""`UIList.bitflag_filter_item`, which only its instances have."""
SWATCH_UNITS = 0.8
"""Width of a colour, in widths of an icon."""
FIGURE_SHARE = 0.26
"""Room for a loss of two digits before the point: "10.37"."""


def draw_sensors(layout: UILayout, context: Context) -> None:
    """Draw a row for each sensor under a header; of many, a list that scrolls."""
    objects = listed_sensors(context.scene)
    box = layout.box().column(align=True)
    if not objects:
        draw_label(box, "No sensors yet", "INFO")
        return
    share = name_share(objects, letters_per_line(context) - BESIDE_LETTERS)
    draw_header(box, share)
    if len(objects) > MAX_ROWS:
        given = context.scene, "objects", context.scene.perception_entropy, "selected_sensor"
        box.template_list(sensors_rows.__name__, "", *given, rows=MAX_ROWS, maxrows=MAX_ROWS)
        return
    for obj in objects:
        draw_sensor(box, context, obj, share)


def shown_sensors(
    _self: Any, context: Context, data: Scene, name: str
) -> tuple[list[int], list[int]]:
    """Show the sensors alone, in the order of the list."""
    return shown_rows(list(getattr(data, name)), listed_sensors(context.scene))


@row_list("PE_UL_sensors", filter_items=shown_sensors)
def sensors_rows(context: Context, layout: UILayout, _scene: Any, item: Any) -> None:
    """The sensors of the scene, without its other objects"""
    objects = listed_sensors(context.scene)
    share = name_share(objects, letters_per_line(context) - BESIDE_LETTERS)
    draw_sensor(layout, context, item, share)


def shown_rows(objects: list[Object], sensors: list[Object]) -> tuple[list[int], list[int]]:
    """Return Blender's filter flags of objects, and their places: sensors first, as listed."""
    order = {sensor.name: place for place, sensor in enumerate(sensors)}
    flags = [SHOWN_ITEM if o.name in order else 0 for o in objects]
    rest = iter(range(len(order), len(objects)))
    return flags, [order[o.name] if o.name in order else next(rest) for o in objects]


def name_share(objects: list[Object], room: int) -> float:
    """Return the share of a row for names; 1 where models would leave too little room for them.

    The selected sensor's model is also in its own panel, and a wider sidebar shows all models.
    """
    names = max(len(obj.name) for obj in objects) + 2
    models = max(len(obj.perception_entropy.model) for obj in objects) + 1
    return 1.0 if names + models > room else max(MIN_NAME_SHARE, names / (names + models))


def draw_header(layout: UILayout, share: float) -> None:
    """Draw the header of the columns."""
    row = layout.row(align=True)
    row.active = False
    row.scale_y = 0.8
    for _ in range(3):
        row.label(text="", icon="BLANK1")
    name, model, figure = row_cells(row, share)
    draw_label(name, "Sensor")
    if model is not None:
        draw_label(model, "Model")
    draw_label(figure, "Loss")


def draw_sensor(layout: UILayout, context: Context, obj: Object, share: float) -> None:
    """Draw a sensor's row: the Outliner's eye, the switch of its beams, and its colour."""
    settings, counts = obj.perception_entropy, obj.visible_get()
    row = layout.row(align=True)
    eye = "HIDE_OFF" if counts else "HIDE_ON"
    row.operator("pe.toggle_sensor", text="", icon=eye, emboss=False).name = obj.name
    rays = "LIGHT_SUN" if settings.show else "DOT"
    row.prop(settings, "show", text="", icon=rays, emboss=False)
    draw_swatch(row, settings)
    name, model, figure = row_cells(row, share)
    row.active = counts  # a hidden sensor is not scored
    active = obj == context.active_object
    warned = any(w.subject == obj.name for w in context.scene.perception_entropy.result_warnings)
    icon = "ERROR" if warned else "NONE"
    name.operator(
        "pe.select_sensor", text=obj.name, depress=active, icon=icon, translate=False
    ).name = obj.name
    if model is not None:
        model.label(text=settings.model, translate=False)
    draw_label(figure, loss_text(obj))


def draw_swatch(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw a sensor's colour: a click chooses another one."""
    swatch = layout.row(align=True)
    swatch.ui_units_x = SWATCH_UNITS
    swatch.prop(settings, "color", text="")


def loss_text(obj: Object) -> str:
    """Return how much the rig's entropy rises without a sensor, from the last result."""
    figures = figures_of_sensor(obj)
    return NO_FIGURE if figures is None or not figures.loss else figures.loss


def row_cells(layout: UILayout, share: float) -> tuple[UILayout, UILayout | None, UILayout]:
    """Return the cells of a row: name, model (None where there is no room), figure at the right."""
    left = layout.split(factor=1.0 - FIGURE_SHARE, align=True)
    if share < 1.0:
        both = left.split(factor=share, align=True)
        name, model = both.row(align=True), both.row(align=True)
    else:
        name, model = left.row(align=True), None
    figure = left.row(align=True)
    figure.alignment = "RIGHT"
    return name, model, figure


WIDE_LETTERS = 56
"""From this width on, the parts that occlude a sensor are in its own row."""
NAME_SHARE, LOSS_SHARE = 0.46, 0.3
NO_FIGURE = "–"
HEADER = ("Sensor", "Loss", "Most in", "Occluded by")


def draw_sensor_table(layout: UILayout, context: Context) -> None:
    """Draw loss, where it is largest, and what occludes each sensor of the last result."""
    draw_label(layout, "Loss: rise of entropy without it, nats")
    table = layout.box().column(align=True)
    table.active = not context.scene.perception_entropy.result_stale
    wide = letters_per_line(context) >= WIDE_LETTERS
    header = _cells(table, wide)
    for cell, text in zip(header, HEADER, strict=False):
        cell.active = False
        draw_label(cell, text)
    for obj in listed_sensors(context.scene):
        _draw_row(table, obj, wide, active=obj == context.active_object)


def _draw_row(layout: UILayout, obj: Object, wide: bool, *, active: bool) -> None:
    figures = figures_of_sensor(obj)
    name, loss, where, *rest = _cells(layout, wide)
    draw_swatch(name, obj.perception_entropy)
    name.operator(
        "pe.select_sensor", text=obj.name, depress=active, translate=False
    ).name = obj.name
    if figures is None:
        draw_label(loss, "not scored")
        return
    loss.label(text=figures.loss or NO_FIGURE, translate=False)
    draw_label(where, figures.where or NO_FIGURE)
    if wide:
        _draw_parts(rest[0], figures)
    elif figures.parts:
        below = layout.row(align=True)
        below.label(text="", icon="BLANK1")
        draw_label(below, "Occluded by")
        _draw_parts(below, figures, 1)


def _draw_parts(layout: UILayout, figures: SensorFigures, most: int = 3) -> None:
    """Draw the parts that occlude a sensor most, as buttons that select them."""
    row = layout.row(align=True)
    for part, share in figures.parts[:most]:
        text = f"{part} {share:.1%}"
        row.operator("pe.select_part", text=text, translate=False).name = part
    if not figures.parts:
        row.label(text=NO_FIGURE, translate=False)


def _cells(layout: UILayout, wide: bool) -> list[UILayout]:
    """Return the cells of a row: name, loss, where; and the parts where there is room."""
    half = layout.split(factor=0.6, align=True) if wide else None
    left = layout if half is None else half
    named = left.split(factor=NAME_SHARE, align=True)
    name = named.row(align=True)
    figures = named.split(factor=LOSS_SHARE, align=True)
    loss, where = figures.row(align=True), figures.row(align=True)
    loss.alignment = "RIGHT"
    return [name, loss, where] if half is None else [name, loss, where, half.row(align=True)]


CLASSES = (sensors_rows,)
