"""Sensors as lists: one with switches and models, one with what each sensor contributes."""

from typing import Any

from bpy.types import Context, Object, PropertyGroup, Scene, UILayout

from ..caches.sensor_cache import sensors as listed_sensors
from ..document import figures_of_sensor, sensor_loss
from ..panel_text import draw_label, is_simple
from ..queries.diagnostics import explanation
from .layout import ICON_PX, fitted, row_list

MODEL_FROM = 0.64  # Where the model begins, in shares of the room for name and model
MAX_ROWS = 7  # More sensors are a list that scrolls: the panel stays as long as it is
SHOWN_ITEM = 1 << 30
"""`UIList.bitflag_filter_item`, which only its instances have."""
SWATCH_UNITS = 0.8  # Width of a colour, in widths of an icon
FIGURE_SHARE = 0.26  # Room for a loss of two digits before the point: "10.37"
NAME_SHARE = 0.46
LOSS_SHARE = 0.3
PARTS_NAMED = 2
NO_FIGURE = "–"
HEADER = ("Sensor", "Loss", "Most in")


def draw_sensors(layout: UILayout, context: Context) -> None:
    """Draw a row for each sensor under a header; of many, a list that scrolls."""
    objects = listed_sensors(context.scene)
    box = layout.box().column(align=True)
    if not objects:
        draw_label(box, "No sensors yet", "INFO")
        return
    draw_header(box, context)
    if len(objects) > MAX_ROWS:
        box.template_list(
            sensors_rows.__name__,
            "",
            context.scene,
            "objects",
            context.scene.perception_entropy,
            "selected_sensor",
            rows=MAX_ROWS,
            maxrows=MAX_ROWS,
        )
        return
    for obj in objects:
        draw_sensor(box, context, obj)


def shown_sensors(
    _self: Any, context: Context, data: Scene, name: str
) -> tuple[list[int], list[int]]:
    """Show the sensors alone, in the order of the list."""
    return shown_rows(list(getattr(data, name)), listed_sensors(context.scene))


@row_list("PE_UL_sensors", filter_items=shown_sensors)
def sensors_rows(context: Context, layout: UILayout, _scene: Any, item: Any) -> None:
    """The sensors of the scene, without its other objects"""
    draw_sensor(layout, context, item)


def shown_rows(objects: list[Object], sensors: list[Object]) -> tuple[list[int], list[int]]:
    """Return Blender's filter flags of objects, and their places: sensors first, as listed."""
    order = {sensor.name: place for place, sensor in enumerate(sensors)}
    flags = [SHOWN_ITEM if o.name in order else 0 for o in objects]
    rest = iter(range(len(order), len(objects)))
    return flags, [order[o.name] if o.name in order else next(rest) for o in objects]


def draw_header(layout: UILayout, context: Context) -> None:
    """Draw the header of the columns."""
    row = layout.row(align=True)
    row.active = False
    row.scale_y = 0.8
    for _ in range(3):
        row.label(text="", icon="BLANK1")
    name, model, figure = row_cells(row, context)
    draw_label(name, "Sensor")
    if model:
        draw_label(model, "Model")
    draw_label(figure, "Loss")


def draw_sensor(layout: UILayout, context: Context, obj: Object) -> None:
    """Draw a sensor's row: the Outliner's eye, the switch of its beams, and its colour."""
    settings = obj.perception_entropy
    counts = obj.visible_get()
    row = layout.row(align=True)
    eye = "HIDE_OFF" if counts else "HIDE_ON"
    row.operator("pe.toggle_sensor", text="", icon=eye, emboss=False).name = obj.name
    rays = "LIGHT_SUN" if settings.show else "DOT"
    row.prop(settings, "show", text="", icon=rays, emboss=False)
    draw_swatch(row, settings)
    name, model, figure = row_cells(row, context)
    share = (1.0 - FIGURE_SHARE) * (MODEL_FROM if model else 1.0)
    row.active = counts  # a hidden sensor is not scored
    warned = any(w.subject == obj.name for w in context.scene.perception_entropy.result_warnings)
    draw_name(name, context, obj, 3.0 * ICON_PX, share=share, warned=warned)
    if model:
        model.label(text=settings.model, translate=False)
    draw_label(figure, loss_text(obj))


def draw_name(
    layout: UILayout, context: Context, obj: Object, beside_px: float, share: float, warned: bool
) -> None:
    """Draw the button that selects a sensor, with as much of its name as there is room for."""
    text = fitted(context, obj.name, beside_px + (ICON_PX / share if warned else 0.0), share)
    active = obj == context.active_object
    icon = "ERROR" if warned else "NONE"
    layout.operator(
        "pe.select_object", text=text, depress=active, icon=icon, translate=False
    ).name = obj.name


def draw_swatch(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw a sensor's colour: a click chooses another one."""
    swatch = layout.row(align=True)
    swatch.ui_units_x = SWATCH_UNITS
    swatch.prop(settings, "color", text="")


def loss_text(obj: Object) -> str:
    """Return how much the rig's entropy rises without a sensor, from the last result."""
    return NO_FIGURE if figures_of_sensor(obj) is None else sensor_loss(obj)


def row_cells(layout: UILayout, context: Context) -> tuple[UILayout, UILayout | None, UILayout]:
    """Return the cells of a row: name, model (*All*: names are long), figure at the right."""
    left = layout.split(factor=1.0 - FIGURE_SHARE, align=True)
    both = left if is_simple(context.scene) else left.split(factor=MODEL_FROM, align=True)
    name = both.row(align=True)
    model = None if both is left else both.row(align=True)
    figure = left.row(align=True)
    figure.alignment = "RIGHT"
    return name, model, figure


def draw_sensor_table(layout: UILayout, context: Context) -> None:
    """Draw loss, where it is largest, and what occludes each sensor of the last result."""
    draw_label(layout, "Loss: the score is higher without it")
    table = layout.box().column(align=True)
    table.active = not context.scene.perception_entropy.result_stale
    for cell, text in zip(_cells(table), HEADER, strict=True):
        cell.active = False
        draw_label(cell, text)
    for obj in listed_sensors(context.scene):
        _draw_row(table, context, obj)


def _draw_row(layout: UILayout, context: Context, obj: Object) -> None:
    words = explanation(context.scene)
    known = None if words is None else words.rows.get(obj.name)
    name, loss, where = _cells(layout)
    draw_swatch(name, obj.perception_entropy)
    draw_name(name, context, obj, ICON_PX / NAME_SHARE, share=NAME_SHARE, warned=False)
    if figures_of_sensor(obj) is None:
        draw_label(loss, "not scored")
        return
    loss.label(text=loss_text(obj), translate=False)
    draw_label(where, NO_FIGURE if known is None else known.cells[2])
    parts = list({} if known is None else known.occluded_by.items())
    if parts:
        below = layout.row(align=True)
        below.label(text="", icon="BLANK1")
        draw_label(below, "Occluded by")
        for part, share in parts[:PARTS_NAMED]:
            text = f"{part} {share:.1%}"
            below.operator("pe.select_object", text=text, translate=False).name = part


def _cells(layout: UILayout) -> tuple[UILayout, UILayout, UILayout]:
    """Return the cells of a row: name, loss, and where it is largest."""
    named = layout.split(factor=NAME_SHARE, align=True)
    name = named.row(align=True)
    figures = named.split(factor=LOSS_SHARE, align=True)
    loss = figures.row(align=True)
    where = figures.row(align=True)
    loss.alignment = "RIGHT"
    return name, loss, where


CLASSES = (sensors_rows,)
