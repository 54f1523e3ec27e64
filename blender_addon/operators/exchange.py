"""Rigs to and from other programs' files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import bridge
from ..engine import catalog, exchange, pe
from .exporting import wrote
from .file_sensors import stand_sensors
from .reports import REFUSALS, chosen_file, refuse

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
            kept = study.passthrough
            paths, lines = pe.export_rig(*wanted, passthrough=kept, replace=replace)
        except REFUSALS as error:
            return refuse(self, error)
        return wrote(self, *paths, lines=tuple(lines))


class PE_OT_import_rig(ImportHelper, bpy.types.Operator):
    """Put the sensors of another program's file in place of those that stand here, as a variant.

    What stands here and is no variant yet is kept as one"""

    bl_idname = "pe.import_rig"
    bl_label = "Import Rig"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default="*", options={"HIDDEN"})
    format: EnumProperty(items=(*_ROWS, TOLD), name="Format", default="TOLD")
    ask: BoolProperty(
        name="Ask for Models",
        description="Ask for the models that the file does not tell; else usual ones stand in",
        default=True,
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            path = chosen_file(self.filepath)
            found = read_rig(context.scene, path, self.format, {})
            if self.ask and found.to_choose and not bpy.app.background:
                wanted = {"filepath": str(path), "format": self.format}
                return bpy.ops.pe.choose_models("INVOKE_DEFAULT", True, **wanted)
            return bring(self, context.scene, path, found)
        except REFUSALS as error:
            return refuse(self, error)


def models_for(row: bpy.types.PropertyGroup, _context: object, typed: str) -> list[str]:
    """Return the catalogue's names of a row's kind that hold what is typed; all where none does."""
    return catalog.matching(typed, row.kind) or catalog.names(row.kind)


class PE_ModelChoice(bpy.types.PropertyGroup):
    """A sensor of a file, and the model that it is to have."""

    sensor: StringProperty(name="Sensor")
    kind: StringProperty(name="Kind")
    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        search=models_for,
        search_options=set(),
    )


class PE_OT_choose_models(bpy.types.Operator):
    """Say which models the sensors of a rig are that its file does not tell"""

    bl_idname = "pe.choose_models"
    bl_label = "Choose Models"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN"})
    format: EnumProperty(items=(*_ROWS, TOLD), default="TOLD", options={"HIDDEN"})
    rows: CollectionProperty(type=PE_ModelChoice)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        try:
            found = read_rig(context.scene, chosen_file(self.filepath), self.format, {})
        except REFUSALS as error:
            return refuse(self, error)
        self.rows.clear()
        for name in found.to_choose:
            row, sensor = self.rows.add(), found.rig[name]
            row.sensor, row.kind, row.model = name, sensor.kind, sensor.model.name
        return context.window_manager.invoke_props_dialog(self, width=480)

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.label(text="The file does not tell these models:")
        for row in self.rows:
            split = self.layout.split(factor=0.4)
            split.label(text=row.sensor)
            split.prop(row, "model", text="")

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            path = chosen_file(self.filepath)
            chosen = {row.sensor: row.model for row in self.rows}
            return bring(
                self, context.scene, path, read_rig(context.scene, path, self.format, chosen)
            )
        except REFUSALS as error:
            return refuse(self, error)


def read_rig(
    scene: bpy.types.Scene, path: Path, name: str, chosen: Mapping[str, str]
) -> exchange.ImportedRig:
    """Return the rig of a file, with models that were chosen by the sensors' names."""
    reference = bridge.reference_of(scene.perception_entropy)
    return pe.import_rig(_kit_of(path), None if name == "TOLD" else name, reference, chosen)


def bring(
    operator: bpy.types.Operator, scene: bpy.types.Scene, path: Path, found: exchange.ImportedRig
) -> set[str]:
    """Have a rig of a file stand in the scene, as a variant, and tell what has to be known."""
    title = path.stem or path.parent.name
    come = tuple(found.rig), found.lines, f"Read from {path}"
    answer = stand_sensors(operator, scene, title, *come)
    bridge.write_passthrough(scene.perception_entropy, found.passthrough)
    return answer


def _kit_of(path: Path) -> Path:
    """Return the folder where a format has several files and one of them was chosen."""
    several = [row.files for row in exchange.RIG_FORMATS.values() if len(row.files) > 1]
    return path.parent if any(path.name in files for files in several) else path


CLASSES = (PE_OT_export_rig, PE_OT_import_rig, PE_ModelChoice, PE_OT_choose_models)
