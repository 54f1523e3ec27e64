"""Take the scale off a sensor: its size on the screen is its display size, not a scale."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty
from mathutils import Matrix

from .reports import tell


class PE_OT_apply_scale(bpy.types.Operator):
    """Take scale and mirroring off this sensor; it stays where it is and looks where it looks"""

    bl_idname = "pe.apply_scale"
    bl_label = "Apply Scale"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the active one when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.mode == "OBJECT"

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.scene.objects.get(self.name) if self.name else context.active_object
        if obj is None or not obj.perception_entropy.is_sensor:
            tell(self, "WARNING", "No sensor to take the scale off")
            return {"CANCELLED"}
        obj.matrix_world = rigid(obj.matrix_world)
        context.view_layer.update()
        return {"FINISHED"}


def rigid(matrix: Matrix) -> Matrix:
    """(4, 4) the same place, looking along the same x with z as near as can be, not scaled."""
    ahead = matrix.col[0].to_3d().normalized()
    up = matrix.col[2].to_3d()
    left = up.cross(ahead).normalized()
    turned = Matrix((ahead, left, ahead.cross(left))).transposed()
    return Matrix.Translation(matrix.to_translation()) @ turned.to_4x4()


CLASSES = (PE_OT_apply_scale,)
