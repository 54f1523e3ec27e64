"""Rigs to and from other programs' files."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import bridge, changes
from ..engine import catalog, exchange, pe
from .known_rigs import record_of
from .reports import REFUSALS, chosen_file, refuse, tell
from .variants import stand_as_variant

_ROWS = tuple((row.name, row.title, "", k) for k, row in enumerate(exchange.RIG_FORMATS.values()))
TOLD = ("TOLD", "By Name", "As the file's name tells", len(_ROWS))


class PE_OT_export_rig(ExportHelper, bpy.types.Operator):
    """Write the sensors for another program: URDF, ROS 2, Autoware, nuScenes, CARLA and others"""

    bl_idname = "pe.export_rig"
    bl_label = "Export Rig"

    filename_ext = ""
    check_extension = None
    format: EnumProperty(items=_ROWS, name="Format", description="Whose file it is to be")
    replace: BoolProperty(
        name="Replace", description="Replace files of a folder that are there", default=False
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        files = exchange.rig_format(self.format).files
        self.filepath = files[0] if len(files) == 1 else f"{self.format}_rig"
        return super().invoke(context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene, row = context.scene, exchange.rig_format(self.format)
        try:
            path = chosen_file(self.filepath)
            study = bridge.study_from_scene(scene, context.evaluated_depsgraph_get())
            # Of one file the dialog has asked.
            replace = self.replace or not (row.beside or len(row.files) > 1)
            wanted = (study.rig, self.format, path, study.reference)
            paths, lines = pe.export_rig(*wanted, replace=replace)
        except REFUSALS as error:
            return refuse(self, error)
        for line in lines:
            tell(self, "WARNING", line)
        tell(self, "INFO", f"Wrote {', '.join(each.name for each in paths)}")
        return {"FINISHED"}


class PE_OT_import_rig(ImportHelper, bpy.types.Operator):
    """Put the sensors of another program's file in place of those that stand here, as a variant.

    What stands here and is no variant yet is kept as one"""

    bl_idname = "pe.import_rig"
    bl_label = "Import Rig"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default="*", options={"HIDDEN"})
    format: EnumProperty(items=(*_ROWS, TOLD), name="Format", default="TOLD")

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        try:
            path = chosen_file(self.filepath)
            reference = bridge.reference_of(scene.perception_entropy)
            name = None if self.format == "TOLD" else self.format
            found = pe.import_rig(_kit_of(path), name, reference)
            before = bridge.records_of_scene(scene)
            records = tuple(record_of(_of_file(scene, sensor)) for sensor in found.rig)
            note = f"Read from {path}. {' '.join(found.lines)}"
            title = stand_as_variant(scene, path.stem or path.parent.name, records, note, before)
        except REFUSALS as error:
            return refuse(self, error)
        changes.study.tell()
        for line in found.lines:
            tell(self, "WARNING", line)
        tell(self, "INFO", f"Added {title}: {len(records)} sensors")
        return {"FINISHED"}


def _kit_of(path: Path) -> Path:
    """Return the folder where a format has several files and one of them was chosen."""
    several = [row.files for row in exchange.RIG_FORMATS.values() if len(row.files) > 1]
    return path.parent if any(path.name in files for files in several) else path


def _of_file(scene: bpy.types.Scene, sensor: pe.Sensor) -> catalog.KnownSensor:
    """Return a sensor as known rigs have them; a model that nobody has becomes the file's own."""
    name = sensor.model.name
    if name not in catalog.entries() or catalog.load(name) is not sensor.model:
        name = bridge.add_own_sensor(scene, name, catalog.to_table(sensor.model))
    return catalog.KnownSensor(sensor.name, name, sensor.pose)


CLASSES = (PE_OT_export_rig, PE_OT_import_rig)
