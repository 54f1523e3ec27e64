"""Add and remove focus weights: rows of the panel's list."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty

from .. import changes
from ..choices import REGION_ITEMS
from ..properties import DEFAULT_REGION
from .reports import tell


class PE_OT_add_focus(bpy.types.Operator):
    """Let a region, or some classes of objects, count more than the prior says"""

    bl_idname = "pe.add_focus"
    bl_label = "Add Focus"
    bl_options = {"REGISTER", "UNDO"}

    region: EnumProperty(
        items=REGION_ITEMS,
        name="Region",
        description="Which part of the ground",
        default=DEFAULT_REGION,
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = context.scene.perception_entropy
        name = free_name({row.name for row in settings.focus})
        row = settings.focus.add()
        row.name, row.region = name, self.region
        settings.focus_index = len(settings.focus) - 1
        changes.study.tell()
        tell(self, "INFO", f"Added {name}")
        return {"FINISHED"}


class PE_OT_remove_focus(bpy.types.Operator):
    """Remove the focus that is selected in the list"""

    bl_idname = "pe.remove_focus"
    bl_label = "Remove Focus"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        settings = context.scene.perception_entropy
        if settings.focus_index >= len(settings.focus):
            cls.poll_message_set("No focus is selected")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = context.scene.perception_entropy
        index = settings.focus_index
        name = settings.focus[index].name
        settings.focus.remove(index)
        settings.focus_index = max(0, min(index, len(settings.focus) - 1))
        changes.study.tell()
        tell(self, "INFO", f"Removed {name}")
        return {"FINISHED"}


def free_name(taken: set[str]) -> str:
    """Return the first of "Focus 1", "Focus 2" and so on that is not taken."""
    number = 1
    while f"Focus {number}" in taken:
        number += 1
    return f"Focus {number}"


CLASSES = (PE_OT_add_focus, PE_OT_remove_focus)
