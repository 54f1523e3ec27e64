"""Files to take away."""

from __future__ import annotations

import bpy

from .layout import Tab


class PE_PT_export(Tab, bpy.types.Panel):
    """Files to take away"""

    bl_idname = "PE_PT_export"
    bl_label = "Export"
    bl_parent_id = "PE_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.operator("pe.export_study", icon="EXPORT")
        self.layout.operator("pe.import_study", icon="IMPORT")
        self.layout.operator("pe.render_review", icon="RENDER_STILL")


CLASSES = (PE_PT_export,)
