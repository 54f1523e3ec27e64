"""Handles on the active sensor: arcs that turn its yaw and its pitch.

A drag is Blender's own rotation: numbers are typed, Ctrl snaps, Esc cancels, and it is undone.
"""

import math

import bpy
from mathutils import Matrix

from .declared import declared

RADIUS = 0.9
THIN = 2.0
ALPHA = 0.55
YAW = (0.30, 0.56, 0.95)
PITCH = (0.55, 0.80, 0.25)
ROTATIONS = ((YAW, "GLOBAL", (False, False, True)), (PITCH, "LOCAL", (False, True, False)))
"""Colour of each handle, orientation and axis of its rotation."""
FROM_DIAL = Matrix.Rotation(-math.pi / 2.0, 4, "X")
"""Turns the z axis, round which a dial is, into the sensor's y axis."""


@declared
class PE_GGT_handles(bpy.types.GizmoGroup):
    """Turn the active sensor"""

    bl_idname = "PE_GGT_handles"
    bl_label = "Sensor Handles"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"3D", "PERSISTENT"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        if obj is None or context.mode != "OBJECT" or not obj.select_get():
            return False
        return bool(obj.perception_entropy.is_sensor) and len(context.selected_objects) == 1

    def setup(self, _context: bpy.types.Context) -> None:
        for color, orientation, axis in ROTATIONS:
            dial = self.gizmos.new("GIZMO_GT_dial_3d")
            dial.draw_options = {"CLIP"}  # type: ignore[attr-defined]  # of this type of gizmo
            rotation = dial.target_set_operator("transform.rotate")
            rotation.orient_type = orientation
            rotation.constraint_axis = axis
            rotation.release_confirm = True
            dial.color = color
            dial.alpha = ALPHA
            dial.color_highlight = color
            dial.alpha_highlight = 1.0
            dial.scale_basis = RADIUS
            dial.line_width = THIN

    def draw_prepare(self, context: bpy.types.Context) -> None:
        obj = context.active_object
        place = Matrix.Translation(obj.matrix_world.translation)
        turned = obj.matrix_world
        turned = turned.to_quaternion().to_matrix().to_4x4()
        frames = (place, place @ turned @ FROM_DIAL)
        for dial, frame in zip(self.gizmos, frames, strict=True):
            dial.matrix_basis = frame
