"""The scene for other programs: solids, footprints, glTF, recordings."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty
from bpy_extras.io_utils import ExportHelper

from .. import bridge
from ..engine import outputs
from .reports import REFUSALS, chosen_file, refuse, tell

_ROWS = tuple((row.name, row.title, "", k) for k, row in enumerate(outputs.SCENE_OUTPUTS.values()))


class PE_OT_export_scene(ExportHelper, bpy.types.Operator):
    """Write vehicle, sensors and what they see for CAD, viewers and other programs"""

    bl_idname = "pe.export_scene"
    bl_label = "Export Scene"

    filename_ext = ""
    check_extension = None
    output: EnumProperty(items=_ROWS, name="Output", description="What is to be written")
    range_m: FloatProperty(
        name="Range",
        description="How far fields of view are drawn; 0: as far as is usual for the output",
        default=0.0,
        min=0.0,
        subtype="DISTANCE",
    )
    replace: BoolProperty(
        name="Replace", description="Replace files of a folder that are there", default=False
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.filepath = outputs.scene_output(self.output).file
        return super().invoke(context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        row = outputs.scene_output(self.output)
        try:
            path = _with_ending(chosen_file(self.filepath), row)
            study = bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
            replace = self.replace or not row.has_several  # of one file the dialog has asked
            reach = self.range_m or None
            paths, lines = outputs.export_scene(study, row.name, path, reach, replace=replace)
        except REFUSALS as error:
            return refuse(self, error)
        for line in lines:
            tell(self, "WARNING", line)
        tell(self, "INFO", f"Wrote {', '.join(each.name for each in paths)}")
        return {"FINISHED"}


def _with_ending(path: Path, row: outputs.SceneOutput) -> Path:
    """Return the path with the output's own ending where it has none."""
    return path if row.has_several or path.suffix else path.with_suffix(Path(row.file).suffix)


CLASSES = (PE_OT_export_scene,)
