"""The mesh file of a requirement's test body, chosen in Blender's file browser."""

from __future__ import annotations

import os
from pathlib import Path

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ImportHelper

from .. import signals
from ..engine import pe
from ..properties.requirement_fields import OWN
from .reports import USER_ERRORS, OperatorResult, chosen_file, report, report_error
from .requirements import RequirementRow

FILTER = "*.glb;*.stl;*.obj;*.ply;*.npz"


class PE_OT_open_body_mesh(RequirementRow, ImportHelper, bpy.types.Operator):
    """Choose the file of a closed mesh as the test body of the selected requirement"""

    bl_idname = "pe.open_body_mesh"
    bl_label = "Open Body Mesh"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default=FILTER, options={"HIDDEN"})

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        row = settings.requirements[settings.requirement_index]
        try:
            if row.body != OWN:
                row.body = OWN
            row.body_mesh = _as_stored(chosen_file(self.filepath))
            if row.problem:
                raise pe.InputError("scene", "mesh", "a file that can be a test body", row.problem)
        except USER_ERRORS as error:
            return report_error(self, error)
        signals.study_changed.emit()
        report(self, "INFO", f"{row.name}: the body is {row.body_mesh}")
        return {"FINISHED"}


def _as_stored(file: Path) -> str:
    """Return a file in the Blender file's folder relative to it, so that both can be moved."""
    beside = Path(bpy.data.filepath).parent if bpy.data.filepath else None
    if beside is not None and file.is_relative_to(beside):
        return f"//{file.relative_to(beside).as_posix()}"
    return os.fspath(file)


CLASSES = (PE_OT_open_body_mesh,)
