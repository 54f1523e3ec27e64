"""Find a sensor of the catalogue by typing a part of its name, and place it."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, StringProperty

from .offered import described, models

_shown: list[tuple[str, str, str, int]] = []
"""What the popup lists: Blender reads the texts after the function that made them is done."""


def _items(
    operator: bpy.types.OperatorProperties, _context: bpy.types.Context
) -> list[tuple[str, str, str, int]]:
    """Return the catalogue's sensors as Blender wants a menu; of the operator's kind alone."""
    names = models(operator.kind or None)
    _shown[:] = [(n, n, described(n), i) for i, n in enumerate(names)]
    return _shown


class PE_OT_search_sensor(bpy.types.Operator):
    """Type a part of a sensor's name, such as QT128, and place it by pointing"""

    bl_idname = "pe.search_sensor"
    bl_label = "Search Sensors"
    bl_options = {"INTERNAL"}
    bl_property = "model"

    kind: StringProperty(name="Kind", description="Kind of sensors to list; all when empty")
    model: EnumProperty(name="Model", description="Sensor of the catalogue", items=_items)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        context.window_manager.invoke_search_popup(self)
        return {"FINISHED"}

    def execute(self, _context: bpy.types.Context) -> set[str]:
        return bpy.ops.pe.place_sensor("INVOKE_DEFAULT", True, model=self.model)


CLASSES = (PE_OT_search_sensor,)
