"""Files to take away."""

from __future__ import annotations

import bpy

from .layout import Tab, draw_properties

AXLES = ("rear_axle_x", "rear_axle_z", "wheelbase", "front_overhang", "rear_overhang")


class PE_PT_export(Tab, bpy.types.Panel):
    """Files to take away, and rigs of other programs"""

    bl_idname = "PE_PT_export"
    bl_label = "Export and Import"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator("pe.export_study", icon="EXPORT")
        layout.operator("pe.import_study", icon="IMPORT")
        layout.operator("pe.render_review", icon="RENDER_STILL")
        layout.operator("pe.export_review", icon="DOCUMENTS")
        row = layout.row(align=True)
        row.operator("pe.export_rig", text="Export Rig", icon="FILE_TICK")
        row.operator("pe.import_rig", text="Import Rig", icon="FILE_FOLDER")
        row = layout.row(align=True)
        row.operator("pe.sensors_to_objects", text="To Objects", icon="OUTLINER_OB_CAMERA")
        row.operator("pe.sensors_from_objects", text="From Objects", icon="OUTLINER_OB_EMPTY")
        layout.operator_menu_enum(
            "pe.export_scene", "output", text="Export Scene", icon="SCENE_DATA"
        )
        draw_axles(layout, context.scene.perception_entropy)


def draw_axles(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw the positions of the axles, and the button that finds them."""
    row = layout.row()
    row.prop(settings, "axles_known", text="Axles")
    row.operator("pe.guess_axles", text="From Wheels", icon="VIEWZOOM")
    if settings.axles_known:
        draw_properties(layout.column(), settings, AXLES)


def draw_export(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    """File > Export."""
    menu.layout.operator("pe.export_study", text="Study (Perception Entropy, .toml)")
    menu.layout.operator("pe.export_rig", text="Rig of Sensors (Perception Entropy)")
    text = "Sensors as Cameras and Empties (Perception Entropy)"
    menu.layout.operator("pe.sensors_to_objects", text=text)
    text = "Fields of View and Scene (Perception Entropy)"
    menu.layout.operator_menu_enum("pe.export_scene", "output", text=text)


def draw_import(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    """File > Import."""
    menu.layout.operator("pe.import_study", text="Study (Perception Entropy, .toml)")
    menu.layout.operator("pe.import_rig", text="Rig of Sensors (Perception Entropy)")
    text = "Cameras and Empties as Sensors (Perception Entropy)"
    menu.layout.operator("pe.sensors_from_objects", text=text)


def register() -> None:
    """Add the entries to Blender's own menus."""
    bpy.types.TOPBAR_MT_file_export.append(draw_export)
    bpy.types.TOPBAR_MT_file_import.append(draw_import)


def unregister() -> None:
    """Remove the entries from Blender's own menus."""
    bpy.types.TOPBAR_MT_file_import.remove(draw_import)
    bpy.types.TOPBAR_MT_file_export.remove(draw_export)


CLASSES = (PE_PT_export,)
