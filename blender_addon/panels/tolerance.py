"""What a search's placements have to stand: mounting errors, and the loss of a sensor."""

from __future__ import annotations

import bpy

from .layout import Tab, draw_properties


class PE_PT_tolerance(Tab, bpy.types.Panel):
    """What placements have to stand: sensors mounted a little off, or the loss of one"""

    bl_idname = "PE_PT_tolerance"
    bl_label = "Tolerance"
    bl_parent_id = "PE_PT_search"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.perception_entropy, self.layout
        draw_properties(layout, settings, ("mounting_errors",))
        column = layout.column()
        column.active = settings.mounting_errors
        draw_properties(column, settings, ("tolerance_position", "tolerance_angle"))
        draw_properties(layout, settings, ("failures",))
        row = layout.row()
        row.active = settings.mounting_errors or settings.failures
        row.prop(settings, "worst")


CLASSES = (PE_PT_tolerance,)
