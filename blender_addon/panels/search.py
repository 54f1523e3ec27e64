"""What is scored, and how to search: the prior, the targets, the search."""

from __future__ import annotations

import bpy

from ..choices import FROM_BOXES, OBJECTS
from .layout import Tab, draw_properties


class PE_PT_prior(Tab, bpy.types.Panel):
    """Where objects are to be expected"""

    bl_idname = "PE_PT_prior"
    bl_label = "Prior"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        draw_chosen(self.layout, context.scene.perception_entropy, "prior")

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        boxes = ("boxes",) if settings.prior == FROM_BOXES else ()
        draw_properties(self.layout, settings, ("prior", *boxes))


class PE_PT_targets(Tab, bpy.types.Panel):
    """What is judged: voxels, or objects of the prior"""

    bl_idname = "PE_PT_targets"
    bl_label = "Targets"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        draw_chosen(self.layout, context.scene.perception_entropy, "targets")

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        draw_properties(self.layout, settings, ("targets",))
        if settings.targets == OBJECTS:
            draw_properties(self.layout, settings, ("traffic", "scenes"))
        else:
            draw_voxels(self.layout, settings, "score_samples")


class PE_PT_search(Tab, bpy.types.Panel):
    """How to search"""

    bl_idname = "PE_PT_search"
    bl_label = "Search"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        draw_properties(self.layout, settings, ("method", "candidates"))
        row = self.layout.row(align=True)
        row.prop(settings, "evaluations")
        if not settings.evaluations:
            row.label(text="All")
        self.layout.prop(settings, "seed")
        if settings.targets != OBJECTS:
            draw_voxels(self.layout, settings, "search_samples")


def draw_chosen(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, name: str) -> None:
    """Draw what is chosen of a menu, to be seen also when its panel is closed."""
    layout.label(text=layout.enum_item_name(settings, name, getattr(settings, name)))


def draw_voxels(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, name: str) -> None:
    """Draw a number of voxels, and beside it that 0 means all of them."""
    row = layout.row(align=True)
    row.prop(settings, name)
    if not getattr(settings, name):
        row.label(text="All")


SCORING_CLASSES = (PE_PT_prior, PE_PT_targets)
CLASSES = (PE_PT_search,)
