"""How to score and to search."""

from __future__ import annotations

import bpy

from ..choices import FROM_BOXES, OBJECTS
from .layout import Tab, draw_properties


class PE_PT_search(Tab, bpy.types.Panel):
    """How to score and to search"""

    bl_idname = "PE_PT_search"
    bl_label = "Search"
    bl_parent_id = "PE_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        boxes = ("boxes",) if settings.prior == FROM_BOXES else ()
        draw_properties(self.layout, settings, ("prior", *boxes, "targets"))
        objects = settings.targets == OBJECTS
        if objects:
            draw_properties(self.layout, settings, ("traffic", "scenes"))
        draw_properties(self.layout, settings, ("method", "candidates"))
        row = self.layout.row(align=True)
        row.prop(settings, "evaluations")
        if not settings.evaluations:
            row.label(text="All")
        self.layout.prop(settings, "seed")
        for name in () if objects else ("search_samples", "score_samples"):
            draw_voxels(self.layout, settings, name)


def draw_voxels(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, name: str) -> None:
    """Draw a number of voxels, and beside it that 0 means all of them."""
    row = layout.row(align=True)
    row.prop(settings, name)
    if not getattr(settings, name):
        row.label(text="All")


CLASSES = (PE_PT_search,)
