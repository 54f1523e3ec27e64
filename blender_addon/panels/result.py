"""Score and Optimize, always in the same place, and below them what the last one found."""

from __future__ import annotations

import bpy

from ..operators import ShownScore, running, shown_score
from .layout import columns
from .words import draw_sentence, draw_warning


def draw_actions(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw what sets to work; while something does, how far it is, in the same place."""
    row = layout.row(align=True)
    row.scale_y = 1.5
    if running.current is None:
        row.operator("pe.score", icon="VIEWZOOM")
        row.prop(settings.live, "on", toggle=True, icon="REC")
        row.operator("pe.optimize", icon="ORIENTATION_GIMBAL")
        return
    row.progress(text=running.current.text, factor=running.current.progress.fraction)
    row.operator("pe.cancel", text="", icon="CANCEL")
    if running.current.notice:
        layout.label(text=running.current.notice, icon="INFO")


def draw_result(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw one score: the live one, or the stored one where that is of the scene or Live is off."""
    settings, live = context.scene.perception_entropy, shown_score(context.scene)
    if live is not None and not live.stored:
        draw_live(layout, settings, live)
    elif settings.has_result:
        draw_stored(layout, context)


def draw_live(
    layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, live: ShownScore
) -> None:
    """Draw the live score, as the corner of the 3D view tells it."""
    column = layout.box().column(align=True)
    draw_figure(column, "Entropy", f"{live.entropy:.3f} ± {max(live.stderr, 1e-3):.3f} nats")
    draw_figure(column, "Coverage", f"{live.coverage:.1%}")
    state = "Live: at rest, on a sample" if live.exact else "Live: a preview, on a sample"
    column.label(text=state, icon="REC")
    if settings.has_result:
        layout.label(text="Changed since it was scored", icon="FILE_REFRESH")


def draw_stored(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the stored result: figures with names and units, and whether they still stand."""
    settings = context.scene.perception_entropy
    column = layout.box().column(align=True)
    column.active = not settings.result_stale
    error = f" ± {max(settings.result_stderr, 1e-4):.4f}" if settings.result_stderr else ""
    draw_figure(column, "Entropy", f"{settings.result_entropy:.4f}{error} nats")
    if settings.result_kind == "optimize":
        gain = settings.result_entropy - settings.result_before
        draw_figure(column, "Before", f"{settings.result_before:.4f}  ({gain:+.4f})")
    draw_figure(column, "Coverage", f"{settings.result_coverage:.1%}")
    if settings.result_ap:
        draw_figure(column, "Expected AP", settings.result_ap)
    for name in ("mounted_off", "sensor_lost"):
        if told := getattr(settings, f"result_{name}"):
            draw_figure(column, name.replace("_", " ").title(), told)
    state = layout.column(align=True)
    if settings.result_fragile:
        text = settings.result_fragile
        draw_sentence(state, context, text[:1].upper() + text[1:], icon="ERROR")
    for line in settings.result_missing.splitlines():
        draw_sentence(state, context, f"Scored without it: {line}", icon="ERROR")
    if settings.result_stale:
        state.label(text="Changed since this was scored", icon="FILE_REFRESH")


def draw_figure(layout: bpy.types.UILayout, name: str, value: str) -> None:
    """Draw a figure with its name."""
    left, right = columns(layout, 0.34)
    left.label(text=name)
    right.label(text=value, translate=False)


def draw_vehicle_told(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the vehicle in a line, and what is odd about it, under its field."""
    settings = context.scene.perception_entropy
    if settings.vehicle is not None and settings.vehicle_line:
        draw_sentence(layout, context, settings.vehicle_line)
    told = [w for w in context.scene.perception_entropy.result_warnings if not w.subject]
    if told:
        box = layout.box().column(align=True)
        for warning in told:
            draw_warning(box, context, warning)
