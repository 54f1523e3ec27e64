"""The tab's first panel, with vehicle, sensors, Score and Optimize; the last: Export and Import."""

from __future__ import annotations

import bpy
from bpy.types import Context, PropertyGroup, Scene, UILayout

from .. import where_map
from ..bridge import Result, shown_state
from ..diagnostics import vehicle_line
from ..engine import advice
from ..language import draw_label, shown
from ..live import BETTER, SAME, SENSE_ICONS, WORSE, ShownScore, figure_rows, nats_text, shown_score
from ..operators import is_updated, offers, running_job
from ..sensor_cache import sensors as listed_sensors
from .layout import columns, draw_declared, draw_sentence, draw_warning, panel
from .sensor_lists import draw_sensors


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
        text=shown(running_job.current.text),
        factor=running_job.current.progress.fraction,
        translate=False,
    )
    row.operator("pe.cancel", text="", icon="CANCEL")


def draw_result(layout: UILayout, context: Context) -> None:
    """Draw the live score; or the stored one, if it is current or Live is off.

    Each takes the same rows, those that come late included: what is below stays where it is.
    """
    settings, live = context.scene.perception_entropy, shown_score(context.scene)
    if live is not None and not live.stored:
        draw_live(layout, settings, live)
    elif settings.has_result:
        draw_stored(layout, context)
    elif listed_sensors(context.scene):
        column = layout.box().column(align=True)
        for name in ("Entropy", "Coverage"):
            draw_figure(column, name, "\N{EN DASH}")
        draw_key_figures(column, settings, live=True)
        draw_label(column, "Not scored yet", "BLANK1")
        draw_changed(layout, is_changed=False)
    if settings.has_result and (state := shown_state(context.scene)):
        draw_sentence(layout, context, f"Shown: state {state}. Scored: as drawn", icon="INFO")


def draw_live(layout: UILayout, settings: PropertyGroup, live: ShownScore) -> None:
    """Draw the live score, as in the corner of the 3D view."""
    column = layout.box().column(align=True)
    error = max(live.stderr, 1e-3)
    draw_figure(column, "Entropy", f"{nats_text(live.entropy)} ± {error:.3f} nats")
    draw_figure(column, "Coverage", f"{live.coverage:.1%}")
    draw_key_figures(column, settings, live=True)
    state = "Live: exact, on a sample" if live.exact else "Live: a preview, on a sample"
    draw_label(column, state, "REC")
    is_changed = settings.has_result and (settings.result_stale or not live.state)
    draw_changed(layout, is_changed=is_changed)


def draw_key_figures(layout: UILayout, settings: PropertyGroup, *, live: bool) -> None:
    """Draw the figures beside the entropy: of the live score, or of the stored result."""
    for name, text, sense in figure_rows(settings.id_data, live=live):
        draw_figure(layout, name, text, sense)


def draw_changed(layout: UILayout, *, is_changed: bool) -> None:
    """Draw that the scene has changed since its score; else room for that line."""
    text, icon = ("Changed since it was scored", "FILE_REFRESH") if is_changed else ("", "BLANK1")
    draw_label(layout, text, icon)


def draw_stored(layout: UILayout, context: Context) -> None:
    """Draw the stored result: figures with names and units, and whether they are current."""
    settings = context.scene.perception_entropy
    result = settings.result
    column = layout.box().column(align=True)
    column.active = not settings.result_stale
    error = f" ± {max(result.stderr, 1e-3):.3f}" if result.stderr else ""
    draw_figure(column, "Entropy", f"{nats_text(result.entropy)}{error} nats")
    if result.kind == "optimize":
        draw_changes(column, result)
    else:
        draw_figure(column, "Coverage", f"{result.coverage:.1%}")
    draw_key_figures(column, settings, live=False)
    sense = BETTER if advice.costs_nothing(result.cost) else WORSE
    for text, mark in ((result.gain, SAME), (result.cost, sense)):
        if text:
            draw_sentence(column, context, text, sense=mark)
    samples = "On all voxels" if not result.stderr else "On a sample"
    draw_label(column, f"{samples}, as scored", "CHECKMARK")
    draw_changed(layout, is_changed=settings.result_stale)
    for name, text in (
        ("Expected AP", result.ap),
        ("Mounted Off", result.robustness("rise")),
        ("Sensor Lost", result.robustness("loss")),
    ):
        if text:
            draw_figure(column, name, text)
    state = layout.column(align=True)
    if text := result.fragile:
        draw_sentence(state, context, text[:1].upper() + text[1:], icon="ERROR")
    for line in result.missing:
        draw_sentence(state, context, f"Scored without it: {line}", icon="ERROR")


def draw_changes(layout: UILayout, result: Result) -> None:
    """Draw what the last search changed, gains and losses marked, and what it cost."""
    by = result.entropy - result.entropy_before
    text = nats_text(result.entropy_before, by)
    draw_figure(layout, "Before", text, sense_of_change(by, MIN_NATS))
    by = 100.0 * (result.coverage - result.coverage_before)
    text = f"{result.coverage:.1%}  ({by:+.1f})"
    draw_figure(layout, "Coverage", text, sense_of_change(-by, MIN_POINTS))


MIN_NATS, MIN_POINTS = 5e-4, 0.05
"""Smaller changes are 0 in the digits that are shown."""


def sense_of_change(by: float, least: float) -> int:
    """Return whether a change of something that is to be low is a gain or a loss."""
    return SAME if abs(by) < least else WORSE if by > 0.0 else BETTER


def draw_figure(layout: UILayout, name: str, value: str, sense: int = SAME) -> None:
    """Draw a figure with its name; a gain or a loss is marked."""
    left, right = columns(layout, 0.34)
    draw_label(left, name)
    draw_label(right, value, SENSE_ICONS[sense])


STEPS = {1: "Choose the vehicle", 2: "Add a sensor"}
"""The way from an empty tab to *Score*."""


def next_step(scene: Scene) -> int | None:
    """Return the key of the next of `STEPS`; None once a sensor is there, or a score."""
    settings = scene.perception_entropy
    if settings.has_result:
        return None
    if settings.vehicle is None:
        return 1
    return None if listed_sensors(scene) else 2


def draw_step(layout: UILayout, context: Context, step: int) -> None:
    """Draw the heading of a step while it is the next one."""
    if next_step(context.scene) == step:
        layout.label(text=f"{step}  {shown(STEPS[step])}", icon="FORWARD", translate=False)


def draw_vehicle(layout: UILayout, context: Context) -> None:
    """Draw the vehicle's field and warnings; while none is chosen, ways to one."""
    settings = context.scene.perception_entropy
    draw_step(layout, context, 1)
    row = layout.row(align=True)
    name, field = columns(row, 0.3)
    draw_label(name, "Vehicle")
    field.prop(settings, "vehicle", text="")
    step = next_step(context.scene)
    if settings.vehicle is not None and step != 2:
        row.operator("pe.turn_round", text="", icon="FILE_REFRESH")
    if step == 1:
        column = layout.column(align=True)
        column.operator("pe.use_selected", icon="RESTRICT_SELECT_OFF")
        column.operator("pe.open_example", icon="FILE_BLEND")
    if settings.vehicle is not None and (line := vehicle_line(context.scene)):
        draw_sentence(layout, context, line)
    if is_updated():
        layout.operator("pe.whats_new", icon="INFO")
    if step == 2:
        asked, button = columns(layout, 0.5)
        draw_label(asked, "Front at the arrow?")
        button.operator("pe.turn_round", icon="FILE_REFRESH")


@panel("Perception Entropy", closed=False)
def main(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Vehicle, sensors, score and search"""
    draw_actions(layout, settings)  # first: nothing that comes late moves them
    draw_vehicle(layout, context)
    draw_step(layout, context, 2)
    draw_add(layout, settings)
    draw_sensors(layout, context)
    draw_result(layout, context)


@panel(
    "Warnings",
    closed=False,
    poll=lambda context: bool(context.scene.perception_entropy.result_warnings),
    count="result_warnings",
)
def warnings(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """What is wrong with the vehicle and the sensors, and buttons that correct it"""
    found = settings.result_warnings
    for subject in dict.fromkeys([None, *(warning.subject for warning in found)]):
        own = [warning for warning in found if warning.subject == subject]
        if not own:
            continue
        box = layout.box().column(align=True)
        if subject:
            box.operator("pe.select_sensor", text=subject, translate=False).name = subject
        for warning in own:
            draw_warning(box, context, warning)


def draw_add(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw a row: the kind; add its usual sensor, place it by pointing, or search all."""
    by_kind = {offer.kind: offer for offer in offers()}  # a plugin's kind may have gone
    offer = by_kind.get(settings.kind_to_add) or next(iter(by_kind.values()))
    row = layout.row(align=True)
    row.prop(settings, "kind_to_add", text="")
    row.operator("pe.add_sensor", text="Add", icon="ADD").model = offer.usual
    button = row.operator("pe.place_sensor", text="Place", icon="RESTRICT_SELECT_OFF")
    button.model = offer.usual
    row.operator("pe.search_sensor", text="", icon="VIEWZOOM").kind = offer.kind
    row = layout.row(align=True)
    row.operator("pe.where", icon="SURFACE_DATA").model = offer.usual
    if settings.id_data.name in where_map.maps:
        row.operator("pe.take_place", icon="EYEDROPPER")
        row.operator("pe.dismiss_places", text="", icon="X")


@panel("Export and Import")
def export(layout: UILayout, settings: PropertyGroup, _context: Context) -> None:
    """Files to take away, and rigs of other programs"""
    layout.operator("pe.export_study", icon="EXPORT")
    layout.operator("pe.import_study", icon="IMPORT")
    layout.operator("pe.render_review", icon="RENDER_STILL")
    layout.operator("pe.export_review", icon="DOCUMENTS")
    row = layout.row(align=True)
    row.operator("pe.export_rig", text="Export Rig", icon="FILE_TICK")
    row.operator("pe.import_rig", text="Import Rig", icon="FILE_FOLDER")
    layout.operator_menu_enum("pe.export_scene", "output", text="Export Scene", icon="SCENE_DATA")
    row = layout.row()
    row.prop(settings, "axles_known", text="Axles")
    row.operator("pe.guess_axles", text="From Wheels", icon="VIEWZOOM")
    if settings.axles_known:
        draw_declared(layout.column(), settings, "reference")


def draw_export(menu: bpy.types.Menu, _context: Context) -> None:
    """File > Export."""
    menu.layout.operator("pe.export_study", text="Study (Perception Entropy, .toml)")
    menu.layout.operator("pe.export_rig", text="Rig of Sensors (Perception Entropy)")
    text = "Fields of View and Scene (Perception Entropy)"
    menu.layout.operator_menu_enum("pe.export_scene", "output", text=shown(text), translate=False)


def draw_import(menu: bpy.types.Menu, _context: Context) -> None:
    """File > Import."""
    menu.layout.operator("pe.import_study", text="Study (Perception Entropy, .toml)")
    menu.layout.operator("pe.import_rig", text="Rig of Sensors (Perception Entropy)")


CLASSES = (main,)

WARNING_CLASSES = (warnings,)  # below the selected sensor's panel, which they would move

EXPORT_CLASSES = (export,)  # below all other panels
