"""Find the axles by the vehicle's wheels."""

from __future__ import annotations

import bpy

from .. import body, bridge
from ..engine import pe
from .reports import REFUSALS, refuse, tell


class PE_OT_guess_axles(bpy.types.Operator):
    """Take the axles from the vehicle's parts that are named as wheels: wheel, tire, tyre"""

    bl_idname = "pe.guess_axles"
    bl_label = "From Wheels"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        try:
            vehicle = body.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
            found = pe.guessed_reference(vehicle)
            if found is None:
                expected = "parts named as wheels, front and rear"
                raise pe.InputError("vehicle", "axles", expected, "none")
        except REFUSALS as error:
            return refuse(self, error)
        bridge.write_reference(scene.perception_entropy, found)
        tell(self, "INFO", f"Rear axle at x {found.rear_axle_x:g} m, z {found.rear_axle_z:g} m")
        return {"FINISHED"}


CLASSES = (PE_OT_guess_axles,)
