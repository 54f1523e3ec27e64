"""Menus of the sensors to add: by kind, by search, and all of the catalogue by maker."""

from __future__ import annotations

import bpy
from bpy.types import Context, UILayout

from ..language import shown
from ..operators import brief, known_makers, makers, models, offers

KIND = "pe_kind"
"""Name in Blender's context by which a button passes the kind to its menu; without it: all."""


class PE_MT_add_sensor(bpy.types.Menu):
    """Place another sensor of this kind by pointing: search the catalogue, or go by its maker"""

    bl_idname = "PE_MT_add_sensor"
    bl_label = "Place Sensor"

    def draw(self, context: Context) -> None:
        layout, kind = self.layout, getattr(context, KIND, None)
        layout.operator_context = "INVOKE_DEFAULT"
        search = layout.operator("pe.search_sensor", text="Search...", icon="VIEWZOOM")
        search.kind = kind or ""
        layout.separator()
        for maker in makers(kind):
            layout.menu(MAKER_MENUS[maker].bl_idname, text=shown(maker), translate=False)


class MakerMenu:
    """Sensors of one maker in the catalogue"""

    maker: str
    layout: UILayout

    def draw(self, context: Context) -> None:
        self.layout.operator_context = "INVOKE_DEFAULT"
        for name in models(getattr(context, KIND, None), self.maker):
            text = f"{name}   {shown(brief(name))}"
            self.layout.operator("pe.place_sensor", text=text, translate=False).model = name


def _menu_of(maker: str, number: int) -> type[bpy.types.Menu]:
    """Return the menu class of a maker.

    Blender's menu search visits a class once: with one class for all makers, it shows all sensors
    below the first of them.
    """
    name = f"PE_MT_sensors_of_maker_{number}"
    members: dict[str, str | None] = {"bl_idname": name, "bl_label": maker, "maker": maker}
    members["__doc__"] = MakerMenu.__doc__  # the tooltip
    return type(name, (MakerMenu, bpy.types.Menu), members)


MAKER_MENUS = {maker: _menu_of(maker, number) for number, maker in enumerate(known_makers())}


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
        self.layout.menu(PE_MT_add_sensor.bl_idname, icon="RESTRICT_SELECT_OFF")


def draw_add_menu(menu: bpy.types.Menu, context: Context) -> None:
    """Add (Shift A), in Object Mode."""
    if context.mode == "OBJECT":
        menu.layout.menu(PE_MT_add.bl_idname, icon="OUTLINER_OB_CAMERA")


CLASSES = (*MAKER_MENUS.values(), PE_MT_add_sensor, PE_MT_add)
