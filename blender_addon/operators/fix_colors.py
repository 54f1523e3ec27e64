"""Keep the ground map's colours as they are, whatever is moved."""

from __future__ import annotations

import bpy

from ..overlay.store import shown
from .reports import tell

RANGES = {"ENTROPY": "entropy_range", "COVERAGE": "coverage_range"}
"""By quantity: where a fixed range is kept."""


class PE_OT_fix_colors(bpy.types.Operator):
    """Keep the range of the ground map's colours as the legend tells it now"""

    bl_idname = "pe.fix_colors"
    bl_label = "Fix Colors"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        view = context.scene.perception_entropy.view
        items = shown.items(context.scene.name, "ground").values()
        bounds = next((i.shape.legend.bounds for i in items if i.shape.legend is not None), None)
        if bounds is None or view.ground_difference or view.ground_quantity not in RANGES:
            tell(self, "WARNING", "No map of entropy or coverage is shown")
            return {"CANCELLED"}
        setattr(view, RANGES[view.ground_quantity], bounds)
        view.ground_range = "FIXED"
        return {"FINISHED"}


CLASSES = (PE_OT_fix_colors,)
