"""How to search: the method, mounts and limits."""

from typing import Any

from bpy.types import Context, PropertyGroup, UILayout

from ..choices import BY_GROUP, BY_MESH, BY_PARTS, EXPECTED_AP, OBJECTS, ON_SLOTS, RANDOM
from ..engine import advice
from ..live import shown_score
from ..panel_text import is_simple
from .dashboard import draw_limits
from .layout import (
    draw_declared,
    draw_list,
    draw_properties,
    draw_sentence,
    panel,
    row_list,
    section,
)
from .variant_panels import draw_front

ICONS = {BY_PARTS: "OBJECT_DATA", BY_GROUP: "WPAINT_HLT", BY_MESH: "MESH_DATA"}
ELSEWHERE = ("objective", "evaluations", "seed", "search_samples", "search_conditions")
"""Settings of a search that are drawn before the others, or in another panel."""
SLOTS_ICON = "OUTLINER_COLLECTION"


@panel("Search", simple=True)
def search(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """How to search"""
    draw_properties(layout, settings, ("objective",))
    if is_simple(context.scene):
        draw_properties(layout, settings, ("evaluations",))
        return
    layout.row(align=True).prop(settings, "method", expand=True)
    own = ("candidates",) if settings.method == RANDOM else ()
    draw_properties(layout, settings, (*own, "evaluations", "seed"))
    if settings.targets != OBJECTS:
        by_ap = settings.objective == EXPECTED_AP
        names = ("scenes", "ap_model") if by_ap else ("search_samples",)
        draw_properties(layout, settings, names)
    draw_declared(layout, settings, "search", ELSEWHERE)
    inside = section(layout, "mounts", "Mounts", count=str(len(settings.mounts) or ""))
    if inside is not None:
        draw_mounts(inside, settings)


@row_list("PE_UL_mounts")
def mounts_rows(_context: Context, layout: UILayout, _settings: Any, item: Any) -> None:
    """The mounts: faces or slots, and name"""
    icon = SLOTS_ICON if item.kind == ON_SLOTS else ICONS[item.faces]
    layout.prop(item, "name", text="", emboss=False, icon=icon)


def draw_mounts(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw where sensors may be mounted: surfaces of the vehicle, or slots of a rack."""
    draw_list(layout, mounts_rows, settings, "mounts")
    if settings.mount_index < len(settings.mounts):
        draw_mount(layout, settings.mounts[settings.mount_index])


def draw_mount(layout: UILayout, mount: PropertyGroup) -> None:
    """Draw the settings of one mount."""
    layout.row(align=True).prop(mount, "kind", expand=True)
    if mount.kind == ON_SLOTS:
        draw_properties(layout, mount, ("slots",))
        return
    layout.row(align=True).prop(mount, "faces", expand=True)
    if mount.faces == BY_PARTS:
        column = layout.column(align=True)
        for row in mount.parts:
            column.prop(row, "part", text="")
        column.operator("pe.mount_parts", icon="RESTRICT_SELECT_OFF")
    else:
        draw_properties(layout, mount, ("group" if mount.faces == BY_GROUP else "area",))
    draw_declared(layout, mount, "optimize.mount")


@panel("Limits", parent="PE_PT_search")
def limits(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """What placements of a search keep to, tolerate and trade off, and when it ends"""
    shown = shown_score(context.scene)
    figures = () if shown is None else shown.figures[-1:]
    draw_limits(layout, settings, figures[-1] if figures else None)
    for line in advice.built_lines(figures) if figures else ():
        draw_sentence(layout, context, line)
    draw_declared(layout, settings, "constraints")
    layout.operator("pe.add_no_go", icon="CUBE")
    obj = context.active_object
    if obj is not None and not obj.perception_entropy.is_sensor:
        layout.label(text=f"{obj.name}:", translate=False)
        draw_properties(layout, obj.perception_entropy, ("is_no_go",))
    draw_declared(layout.column(), settings, "optimize.grid")
    draw_tolerance(layout.column(), settings)
    draw_goals(layout.column(), settings, context)


def draw_tolerance(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw what placements have to tolerate: mounting errors, or the loss of a sensor."""
    draw_properties(layout, settings, ("mounting_errors",))
    column = layout.column()
    column.active = settings.mounting_errors
    draw_declared(column, settings, "tolerance", ("failures", "worst"))
    draw_properties(layout, settings, ("failures",))
    row = layout.row()
    row.active = settings.mounting_errors or settings.failures
    row.prop(settings, "worst")


def draw_goals(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Draw when a search ends, from where it starts, its analysis, and the front."""
    draw_declared(layout, settings, "optimize.stop")
    draw_properties(layout, settings, ("start_variants",))
    draw_declared(layout, settings, "goals")
    draw_declared(layout, settings, "optimize.front")
    layout.operator("pe.choose_sensors", text="Find Front", icon="FCURVE")
    if settings.front.rows:
        draw_front(layout, settings, context)


CLASSES = (mounts_rows, search, limits)
