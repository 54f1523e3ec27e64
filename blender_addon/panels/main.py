"""The tab's first panel, with vehicle, sensors, Score and Optimize; the last: Export and Import."""

import bpy
from bpy.types import Context, PropertyGroup, UILayout

from ..caches.sensor_cache import sensors as listed_sensors
from ..engine import advice
from ..operators import offers, running_job
from ..panel_text import draw_label, is_simple, typeset
from ..queries import where_map
from ..queries.diagnostics import vehicle_line
from .dashboard import draw_dashboard, draw_result
from .layout import columns, draw_declared, draw_sentence, is_empty, panel
from .sensor_lists import draw_sensors

LONGEST_LINE = "12.34 x 2.34 x 2.34 m, faces +x, 1,234,567 triangles, 100 parts"
"""The room that the line of a vehicle has before it is known."""
READING = "Reading the vehicle ..."
FIRST_HINT = "Front at the arrow? Else turn it round. Then add a sensor"


def draw_actions(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw the buttons of jobs; while a job runs, its progress in the same place."""
    row = layout.row(align=True)
    row.scale_y = 1.5
    if running_job.current is None:
        row.operator("pe.score", icon="VIEWZOOM")
        row.prop(settings.live, "on", toggle=True, icon="REC")
        row.operator("pe.optimize", icon="ORIENTATION_GIMBAL")
        return
    row.progress(
        text=typeset(running_job.current.text),
        factor=running_job.current.progress.fraction,
        translate=False,
    )
    row.operator("pe.cancel", text="", icon="CANCEL")


def draw_empty(layout: UILayout) -> None:
    """Draw what an empty file begins with: a vehicle of one's own, or an example."""
    column = layout.column(align=True)
    column.scale_y = 1.5
    column.operator("pe.use_selected", icon="RESTRICT_SELECT_OFF")
    column.operator("pe.open_example", icon="FILE_BLEND")


def draw_vehicle(layout: UILayout, context: Context) -> None:
    """Draw the vehicle's field and warnings."""
    settings = context.scene.perception_entropy
    row = layout.row(align=True)
    name, field = columns(row, 0.3)
    draw_label(name, "Vehicle")
    field.prop(settings, "vehicle", text="")
    row.operator("pe.turn_round", text="", icon="FILE_REFRESH")
    if settings.vehicle is not None:
        line = vehicle_line(context.scene) or READING
        draw_sentence(layout, context, line, room_of=LONGEST_LINE)
    if settings.vehicle is not None and not listed_sensors(context.scene):
        draw_sentence(layout, context, FIRST_HINT, icon="FORWARD")


@panel("Perception Entropy", closed=False, simple=True, always=True)
def main(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Vehicle, sensors, score and search"""
    if is_empty(context.scene):
        draw_empty(layout)
        return
    draw_actions(layout, settings)  # buttons first: nothing that comes late moves them
    draw_vehicle(layout, context)
    draw_add(layout, settings, simple=is_simple(context.scene))
    draw_dashboard(layout, context)
    draw_sensors(layout, context)
    layout.row().prop(settings, "panels", expand=True)
    draw_result(layout, context)


def draw_add(layout: UILayout, settings: PropertyGroup, *, simple: bool) -> None:
    """Draw a row: the kind; add its usual sensor, place it by pointing, or (not in *Simple*) search
    all."""
    by_kind = {offer.kind: offer for offer in offers()}  # a plugin's kind may have gone
    offer = by_kind.get(settings.kind_to_add) or next(iter(by_kind.values()))
    row = layout.row(align=True)
    row.prop(settings, "kind_to_add", text="")
    row.operator("pe.add_sensor", text="Add", icon="ADD").model = offer.usual
    button = row.operator("pe.place_sensor", text="Place", icon="RESTRICT_SELECT_OFF")
    button.model = offer.usual
    if not simple:
        row.operator("pe.search_sensor", text="", icon="VIEWZOOM").kind = offer.kind
    row = layout.row(align=True)
    row.operator("pe.where", icon="SURFACE_DATA").model = offer.usual
    if settings.id_data.name in where_map.maps:
        row.operator("pe.take_place", icon="EYEDROPPER")
        row.operator("pe.dismiss", text="", icon="X").answer = "PLACES"


def draw_built(layout: UILayout, context: Context) -> None:
    """Draw the button that compares a built rig; of a compared one, which sensors are off."""
    row = layout.row(align=True)
    row.operator("pe.compare_built", icon="CON_TRACKTO")
    found = where_map.built.get(context.scene.name)
    if found is None:
        return
    row.operator("pe.dismiss", text="", icon="X").answer = "BUILT"
    for line in (*advice.built_sensor_lines(found), *map(advice.pair_text, found.worst_first)):
        draw_sentence(layout, context, line)


@panel("Export and Import", simple=True)
def export(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Files to take away, and rigs of other programs"""
    review = layout.operator("pe.export_file", text="Export Review", icon="DOCUMENTS")
    review.format = "review"
    study = layout.operator("pe.export_file", text="Export Study", icon="EXPORT")
    study.format = "study"
    row = layout.row(align=True)
    row.operator_menu_enum("pe.export_file", "format", text="Export", icon="FILE_TICK")
    row.operator("pe.import_file", icon="IMPORT")
    if is_simple(context.scene):
        return
    draw_built(layout, context)
    row = layout.row()
    row.prop(settings, "axles_known", text="Axles")
    row.operator("pe.guess_axles", text="From Wheels", icon="VIEWZOOM")
    if settings.axles_known:
        draw_declared(layout.column(), settings, "reference")


def draw_export(menu: bpy.types.Menu, _context: Context) -> None:
    """File > Export."""
    menu.layout.operator_menu_enum("pe.export_file", "format", text="Perception Entropy")


def draw_import(menu: bpy.types.Menu, _context: Context) -> None:
    """File > Import."""
    menu.layout.operator("pe.import_file", text="Perception Entropy (study, rig of sensors)")


CLASSES = (main,)

EXPORT_CLASSES = (export,)  # below all other panels
