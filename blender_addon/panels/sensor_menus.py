"""The menu of the sensors to add: by kind, or by a search of the catalogue."""

import bpy
from bpy.types import Context

from ..language import shown
from ..operators import offers


class PE_MT_add(bpy.types.Menu):
    """Sensors at the 3D cursor, or on the roof; or placed by pointing"""

    bl_idname = "PE_MT_add"
    bl_label = "Perception"

    def draw(self, _context: Context) -> None:
        for offer in offers():
            add = self.layout.operator(
                "pe.add_sensor", text=shown(offer.label), icon="ADD", translate=False
            )
            add.model = offer.usual
        self.layout.separator()
        self.layout.operator_context = "INVOKE_DEFAULT"
        self.layout.operator("pe.search_sensor", text="Search...", icon="VIEWZOOM")


def draw_add_menu(menu: bpy.types.Menu, context: Context) -> None:
    """Add (Shift A), in Object Mode."""
    if context.mode == "OBJECT":
        menu.layout.menu(PE_MT_add.bl_idname, icon="OUTLINER_OB_CAMERA")


CLASSES = (PE_MT_add,)
