"""Requirements: a list with verdicts, and the settings of the one that is selected."""

from __future__ import annotations

import bpy

from ..operators import ShownVerdict, shown_verdicts
from .layout import Tab, columns, draw_properties, draw_sentence

ICONS = {True: "CHECKMARK", False: "CANCEL", None: "QUESTION"}
"""By what is known of a requirement: met, not met, not checked."""


class PE_UL_requirements(bpy.types.UIList):
    """The requirements: verdict, name, margin"""

    def draw_item(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        _settings: bpy.types.PropertyGroup,
        item: bpy.types.PropertyGroup,
        _icon: int,
        _active_data: bpy.types.PropertyGroup,
        _active_property: str,
    ) -> None:
        verdict = shown_verdicts(context.scene).get(item.name)
        row = layout.row(align=True)
        row.prop(item, "enabled", text="")
        text = _short_margin(verdict)
        name, margin = columns(row, 0.66 if text else 0.98)
        name.active = item.enabled
        icon = "BLANK1" if verdict is None else ICONS[verdict.met]
        name.alert = verdict is not None and verdict.met is False
        name.prop(item, "name", text="", emboss=False, icon=icon)
        margin.alignment = "RIGHT"
        margin.label(text=text, translate=False)


def _short_margin(verdict: ShownVerdict | None) -> str:
    """Return the margin without its words, for a narrow column."""
    if verdict is None:
        return ""
    text = verdict.margin.removeprefix("margin ").replace(
        "at least", "\N{GREATER-THAN OR EQUAL TO}"
    )
    if text.startswith("fails "):
        text = f"\N{MINUS SIGN}{text.removeprefix('fails ').removesuffix(' inside')}"
    return text


class PE_PT_requirements(Tab, bpy.types.Panel):
    """Zones in which test bodies have to be seen: met or not, and by which margin"""

    bl_idname = "PE_PT_requirements"
    bl_label = "Requirements"
    bl_options = {"DEFAULT_CLOSED"}
    bl_ui_units_x = 17  # where it is called as a popup

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        verdicts = shown_verdicts(context.scene).values()
        if not verdicts:
            return
        met = sum(verdict.met is True for verdict in verdicts)
        known = any(verdict.met is not None for verdict in verdicts)
        text = f"{met} of {len(verdicts)} met" if known else str(len(verdicts))
        self.layout.label(text=text, translate=False)  # visible also when closed

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.perception_entropy, self.layout
        row = layout.row()
        row.template_list(
            *(PE_UL_requirements.__name__, "", settings, "requirements"),
            *(settings, "requirement_index"),
            rows=4,
        )
        buttons = row.column(align=True)
        buttons.operator("pe.add_requirement", text="", icon="ADD")
        buttons.operator("pe.remove_requirement", text="", icon="REMOVE")
        if not settings.requirements:
            draw_sentence(layout, context, "Add a preset of a regulation or test, or an own zone")
            return
        layout.operator("pe.check_requirements", icon="VIEWZOOM")
        layout.prop(settings, "keep_requirements")
        if settings.requirement_index < len(settings.requirements):
            draw_requirement(layout, context, settings.requirements[settings.requirement_index])


def draw_requirement(
    layout: bpy.types.UILayout, context: bpy.types.Context, row: bpy.types.PropertyGroup
) -> None:
    """Draw the last verdict and the settings of a requirement."""
    verdict = shown_verdicts(context.scene).get(row.name)
    if verdict is not None and verdict.sentence:
        text = verdict.sentence[:1].upper() + verdict.sentence[1:]
        draw_sentence(layout, context, text, icon=ICONS[verdict.met])
    if row.problem:
        draw_sentence(layout, context, row.problem, icon="ERROR")
    draw_properties(layout, row, ("body",))
    if row.x_from:
        for axis in "xy":
            pair = layout.column(align=True)
            pair.prop(row, f"{axis}_from")
            pair.prop(row, f"{axis}_to")
    draw_properties(layout, row, ("step", "sensors", "kinds", "one_lost", "mounting"))


CLASSES = (PE_UL_requirements, PE_PT_requirements)
