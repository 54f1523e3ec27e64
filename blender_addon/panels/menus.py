"""Entries in Blender's own menus: Add, Object, its right click and the Outliner's; F3 searches."""

import bpy
from bpy.types import Context, UILayout

from ..operators import offers


class PE_MT_add(bpy.types.Menu):
    """Sensors at the 3D cursor, or on the roof; or placed by pointing"""

    bl_idname = "PE_MT_add"
    bl_label = "Perception"

    def draw(self, _context: Context) -> None:
        for offer in offers():
            add = self.layout.operator(
                "pe.add_sensor", text=offer.label, icon="ADD", translate=False
            )
            add.model = offer.usual
        self.layout.separator()
        self.layout.operator_context = "INVOKE_DEFAULT"
        self.layout.operator("pe.search_sensor", text="Search...", icon="VIEWZOOM")


def draw_add_menu(menu: bpy.types.Menu, context: Context) -> None:
    """Add (Shift A), in Object Mode."""
    if context.mode == "OBJECT":
        menu.layout.menu(PE_MT_add.bl_idname, icon="OUTLINER_OB_CAMERA")


class PE_MT_object(bpy.types.Menu):
    """Sensors of the vehicle: place, turn, mirror, look through, score and search"""

    bl_idname = "PE_MT_object"
    bl_label = "Perception"

    def draw(self, context: Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        draw_of_sensor(layout)
        layout.separator()
        layout.operator("pe.place_sensor", icon="RESTRICT_SELECT_OFF")
        layout.operator("pe.add_no_go")
        layout.operator("pe.use_selected", text="Use Selected Objects as Vehicle")
        layout.operator("pe.turn_round", text="Turn the Vehicle Round")
        layout.separator()
        layout.operator("pe.score", text="Score the Sensors", icon="VIEWZOOM")
        layout.operator("pe.optimize", text="Optimize the Sensors", icon="ORIENTATION_GIMBAL")
        live = context.scene.perception_entropy.live
        layout.prop(live, "on", text="Live Score")
        layout.operator("pe.check_requirements")
        layout.operator("pe.ask_place", icon="EYEDROPPER")
        layout.operator("pe.save_variant")
        layout.operator("pe.ghost_variant", text="Show Ghost of the Variant")


def draw_of_sensor(layout: UILayout) -> None:
    """Draw what can be done with a sensor; Blender greys out what cannot."""
    layout.operator("pe.look_through", icon="HIDE_OFF")
    layout.operator("pe.mirror_sensor", text="Mirror Sensor", icon="MOD_MIRROR")


def draw_object_menu(menu: bpy.types.Menu, _context: Context) -> None:
    """Object menu of 3D views."""
    menu.layout.separator()
    menu.layout.menu(PE_MT_object.bl_idname, icon="OUTLINER_OB_CAMERA")


def draw_context_menu(menu: bpy.types.Menu, context: Context) -> None:
    """Right click on an object: of a sensor what is done with it, of a mesh to be the vehicle."""
    obj = context.active_object
    layout = menu.layout
    if obj is None or context.mode != "OBJECT":
        return
    is_sensor = obj.perception_entropy.is_sensor
    if not is_sensor and obj.type != "MESH":
        return
    layout.separator()
    layout.operator_context = "INVOKE_DEFAULT"
    if is_sensor:
        draw_of_sensor(layout)
    elif context.scene.perception_entropy.vehicle is None:
        layout.operator("pe.use_selected", text="Use Selected Objects as Vehicle")
    else:
        layout.operator("pe.place_sensor", icon="RESTRICT_SELECT_OFF")


CLASSES = (PE_MT_add, PE_MT_object)
