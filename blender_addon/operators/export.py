"""Export the scene as a study file with its mesh, and import one: the same problem, anywhere."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import bridge, changes
from ..engine import pe
from .exporting import wrote
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
        return wrote(self, path)


class PE_OT_import_study(ImportHelper, bpy.types.Operator):
    """Have the scene hold a study: its vehicle, sensors, mounts, and how it is searched.

    A vehicle that is this one stays"""

    bl_idname = "pe.import_study"
    bl_label = "Import Study"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".toml"
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Studies are imported in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            study = pe.load_study(chosen_file(self.filepath))
            lost = bridge.load_into(context.scene, study)
        except REFUSALS as error:
            return refuse(self, error)
        changes.study.tell()
        if lost:
            tell(self, "WARNING", f"Other than in the file, as a scene holds it: {', '.join(lost)}")
        else:
            tell(self, "INFO", f"Imported {self.filepath}: the same bits")
        return {"FINISHED"}


CLASSES = (PE_OT_export_study, PE_OT_import_study)
