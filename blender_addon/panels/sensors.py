"""The list of sensors: which count, whose beams are drawn, model, and what the loss costs."""

from __future__ import annotations

import bpy

from ..operators import listed_sensors
from .swatches import swatch
from .words import draw_warning, letters

LEAST_SHARE = 0.34
"""How much of a row a name takes at least."""
BESIDE_LETTERS = 9
"""What switches and the figure take from a row, in letters."""
FIGURE_SHARE = 0.2


def draw_sensors(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw a row for each sensor under a header, and its warnings below it."""
    objects = listed_sensors(context.scene)
    box = layout.box().column(align=True)
    if not objects:
        box.label(text="No sensors yet", icon="INFO")
        return
    share = name_share(objects, letters(context) - BESIDE_LETTERS)
    draw_header(box, share)
    warnings = list(context.scene.perception_entropy.result_warnings)
    for number, obj in enumerate(objects):
        draw_sensor(box, context, obj, share, number)
        for warning in warnings:
            if warning.subject == obj.name:
                draw_warning(box, context, warning)


def name_share(objects: list[bpy.types.Object], room: int) -> float:
    """Return how much of a row the names take; all of it where models would leave them too little.

    The model of the one that is selected is in its own panel, and a wider sidebar shows all.
    """
    names = max(len(obj.name) for obj in objects) + 2
    models = max(len(obj.perception_entropy.model) for obj in objects) + 1
    return 1.0 if names + models > room else max(LEAST_SHARE, names / (names + models))


def draw_header(layout: bpy.types.UILayout, share: float) -> None:
    """Draw what the columns are."""
    row = layout.row(align=True)
    row.active = False
    row.scale_y = 0.8
    for _ in range(3):
        row.label(text="", icon="BLANK1")
    name, model, figure = cells(row, share)
    name.label(text="Sensor")
    if model is not None:
        model.label(text="Model")
    figure.label(text="Loss")


def draw_sensor(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    obj: bpy.types.Object,
    share: float,
    number: int,
) -> None:
    """Draw a sensor's row: the eye is the Outliner's, the rays are its beams' in the view, whose
    colour stands beside them."""
    settings, counts = obj.perception_entropy, obj.visible_get()
    row = layout.row(align=True)
    eye = "HIDE_OFF" if counts else "HIDE_ON"
    row.operator("pe.toggle_sensor", text="", icon=eye, emboss=False).name = obj.name
    rays = "LIGHT_SUN" if settings.show else "DOT"
    row.prop(settings, "show", text="", icon=rays, emboss=False)
    row.label(text="", icon_value=swatch(number))
    name, model, figure = cells(row, share)
    row.active = counts  # what is hidden is not scored
    active = obj == context.active_object
    name.operator("pe.select_sensor", text=obj.name, depress=active).name = obj.name
    if model is not None:
        model.label(text=settings.model, translate=False)
    figure.label(text=loss_of(settings), translate=False)


def loss_of(settings: bpy.types.PropertyGroup) -> str:
    """Return how much the rig's entropy rises without a sensor, as the last result has it."""
    return settings.loss_text if settings.has_result and settings.loss_text else "–"


def cells(
    layout: bpy.types.UILayout, share: float
) -> tuple[bpy.types.UILayout, bpy.types.UILayout | None, bpy.types.UILayout]:
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
