"""Requirements: a list with verdicts, and the settings of the one that is selected."""

from typing import Any

from bpy.types import Context, PropertyGroup, UILayout

from ..document import after_of, full_table
from ..operators import shown_verdicts
from ..panel_text import draw_label, is_simple
from ..properties.requirement import BODIES_ASKED, OF_GROUND
from .layout import (
    draw_declared,
    draw_list,
    draw_properties,
    draw_sentence,
    panel,
    row_list,
    section,
)
from .score_details import draw_offers

BELOW_SCALE = 0.75
"""Height of a requirement's second line, with its regulation and its figure."""
ICONS = {True: "CHECKMARK", False: "CANCEL", None: "QUESTION"}
"""By what is known of a requirement: met, not met, not checked."""


@row_list("PE_UL_requirements")
def requirements_rows(context: Context, layout: UILayout, _settings: Any, item: Any) -> None:
    """The requirements: verdict and name; below them the margin, or at first the regulation"""
    verdict = shown_verdicts(context.scene).get(item.name)
    lines = layout.column(align=True)
    row = lines.row(align=True)
    row.prop(item, "enabled", text="")
    name = row.row(align=True)
    name.active = item.enabled
    icon = "BLANK1" if verdict is None else ICONS[verdict.met]
    name.alert = verdict is not None and verdict.met is False
    name.prop(item, "name", text="", emboss=False, icon=icon)
    below = lines.row(align=True)
    below.scale_y = BELOW_SCALE
    below.active = verdict is not None
    told = verdict.margin if verdict is not None and verdict.margin else after_of(item)
    draw_label(below, told, "BLANK1")


def _requirements_header(layout: UILayout, context: Context) -> None:
    verdicts = shown_verdicts(context.scene).values()
    if not verdicts:
        return
    checked = [verdict.met for verdict in verdicts if verdict.met is not None]
    met = sum(checked)
    text = f"{met} of {len(checked)} met" if checked else str(len(verdicts))
    draw_label(layout, text)  # visible also when closed


@panel("Requirements", simple=True, bl_ui_units_x=17, preset=_requirements_header)
def requirements(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Zones in which test bodies have to be seen: met or not, and by which margin"""
    draw_list(layout, requirements_rows, settings, "requirements", height=4)
    if not settings.requirements:
        draw_sentence(layout, context, "Add a preset of a regulation or test, or an own zone")
        return
    layout.operator("pe.check_requirements", icon="VIEWZOOM")
    layout.prop(settings, "keep_requirements")
    if settings.requirement_index < len(settings.requirements):
        draw_requirement(layout, context, settings.requirements[settings.requirement_index])


def draw_requirement(layout: UILayout, context: Context, row: PropertyGroup) -> None:
    """Draw the last verdict and the settings of a requirement."""
    verdict = shown_verdicts(context.scene).get(row.name)
    if verdict is not None and verdict.sentence:
        text = verdict.sentence[:1].upper() + verdict.sentence[1:]
        draw_sentence(layout, context, text, icon=ICONS[verdict.met])
    if verdict is not None and verdict.met is False:
        draw_offers(layout, context, row.name)
    if row.problem:
        draw_sentence(layout, context, row.problem, icon="ERROR")
    if is_simple(context.scene):
        return
    if not (table := full_table(row)):
        draw_sentence(layout, context, "The stored table is damaged: remove the requirement")
        return
    _draw_source(layout, context, after_of(row), str(table.get("source", "")))
    draw_properties(layout, row, ("asks",))
    if row.asks == BODIES_ASKED:
        draw_properties(layout, row, ("bodies",))
    _draw_zone(layout, row)
    _draw_criterion(layout, row)
    draw_declared(layout, row, "requirement.robust_to")


def _draw_source(layout: UILayout, context: Context, check: str, source: str) -> None:
    """Draw what the requirement is after, and its source where that is opened."""
    if not source:
        return
    header, inside = layout.panel("PE_requirement_source", default_closed=True)
    if check:
        header.label(text=f"After {check}", translate=False)
    else:
        draw_label(header, "Source")
    if inside is not None:
        draw_sentence(inside, context, source)


def _draw_zone(layout: UILayout, row: PropertyGroup) -> None:
    """Draw the zone: its shape with its places, and what is less often changed."""
    draw_properties(layout, row, ("shape", "zone", "step"))
    inside = section(layout, "requirement_planes", "Height and Planes")
    if inside is not None:
        draw_declared(inside, row, "requirement.zone", ("step",))


def _draw_criterion(layout: UILayout, row: PropertyGroup) -> None:
    """Draw what has to be seen; 0 stands for what is not asked for."""
    if row.asks != BODIES_ASKED:
        draw_properties(layout, row, OF_GROUND)
        return
    draw_properties(layout, row, ("sensors", "kinds"))
    inside = section(layout, "requirement_criterion", "Points, Pixels, Shares")
    if inside is not None:
        draw_declared(inside, row, "requirement.criterion", ("sensors", "kinds", *OF_GROUND))


CLASSES = (requirements_rows, requirements)
