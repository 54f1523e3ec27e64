"""Export the scene as a study file with its mesh: the same problem, to run anywhere."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper

from .. import bridge
from ..engine import pe


class PE_OT_export_study(ExportHelper, bpy.types.Operator):
    """Write a study (.toml) and the vehicle's mesh (.npz) beside it"""

    bl_idname = "pe.export_study"
    bl_label = "Export Study"

    filename_ext = ".toml"
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        path = Path(bpy.path.abspath(self.filepath))
        try:
            study = bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
            pe.export_study(study, path, replace_study=True)  # the file dialog has asked
        except pe.InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"Wrote {path}")
        return {"FINISHED"}


CLASSES = (PE_OT_export_study,)
