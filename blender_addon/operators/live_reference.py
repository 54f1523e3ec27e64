"""What the live score is compared with: before the last move, pinned sensors, or a variant."""

from __future__ import annotations

import bpy
from bpy.props import IntProperty

from ..choices import BEFORE_MOVE, PINNED
from ..live import against, latest
from .reports import tell

LABELS = {BEFORE_MOVE: "Before the Last Move", PINNED: "Pinned Sensors"}


class PE_OT_live_against(bpy.types.Operator):
    """Compare the live score with this from now on"""

    bl_idname = "pe.live_against"
    bl_label = "Compare Live With"
    bl_options = {"INTERNAL"}

    key: IntProperty(
        name="Key",
        description="0: the sensors before the last move; -1: pin those that stand here now; "
        "else: the variant of that key",
        options={"HIDDEN", "SKIP_SAVE"},
    )

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: bpy.types.Operator) -> str:
        if properties.key == PINNED:
            return "Pin the sensors as they stand now: compare the live score with them from now on"
        return cls.__doc__

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        if self.key == PINNED:
            reading = latest.reading(scene.name)
            if reading is None or not latest.is_exact(scene.name, reading):
                tell(self, "WARNING", "Live has not scored the sensors as they stand yet")
                return {"CANCELLED"}
            against.pin(scene.name, reading.rig)
        scene.perception_entropy.live.against = self.key
        return {"FINISHED"}


def reference_label(scene: bpy.types.Scene) -> str:
    """Return what the live score of a scene is compared with, for the panel."""
    choice = scene.perception_entropy.live.against
    if choice == PINNED and against.is_pinned(scene.name):
        return LABELS[PINNED]
    names = {row.key: row.name for row in scene.perception_entropy.variants}
    return names.get(choice, LABELS[BEFORE_MOVE])


CLASSES = (PE_OT_live_against,)
