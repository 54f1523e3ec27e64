"""Export the scene as a study file with its mesh: the same problem, to run anywhere."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper

from .. import bridge
from ..engine import pe
from .reports import REFUSALS, chosen_file, refuse, tell


class PE_OT_export_study(ExportHelper, bpy.types.Operator):
    """Write a study (.toml) and the vehicle's mesh (.npz) beside it"""

    bl_idname = "pe.export_study"
    bl_label = "Export Study"

    filename_ext = ".toml"
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            path = chosen_file(self.filepath)
            study = bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
            pe.export_study(study, path, replace_study=True)  # the file dialog has asked
        except REFUSALS as error:
            return refuse(self, error)
        tell(self, "INFO", f"Wrote {path}")
        return {"FINISHED"}


CLASSES = (PE_OT_export_study,)
