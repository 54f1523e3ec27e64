"""Rigs to and from other programs' files."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from pathlib import Path

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import bridge
from ..engine import catalog, exchange, pe
from ..language import draw_label
from .export_job import report_files
from .replace_sensors import replace_sensors
from .reports import (
    USER_ERRORS,
    OperatorResult,
    begin_in_results_folder,
    chosen_file,
    report_error,
)

_FORMAT_ITEMS = tuple(
    (row.name, row.title, "", k) for k, row in enumerate(exchange.RIG_FORMATS.values())
)
BY_NAME = ("TOLD", "By Name", "By the file's name", len(_FORMAT_ITEMS))


class PE_OT_export_rig(ExportHelper, bpy.types.Operator):
    """Write the sensors for another program: URDF, ROS 2, Autoware, nuScenes, CARLA and others"""

    bl_idname = "pe.export_rig"
    bl_label = "Export Rig"

    filename_ext = ""
    check_extension = None
    format: EnumProperty(
        items=_FORMAT_ITEMS,
        name="Format",
        description="The program and format to write for; the suffix of the file's name follows it",
    )
    format_named: StringProperty(
        description="The format that the file's name had last", options={"HIDDEN", "SKIP_SAVE"}
    )
    replace: BoolProperty(
        name="Replace", description="Replace existing files of a folder", default=False
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        self.filepath = self.format_named = ""
        self.check(context)
        begin_in_results_folder(self)
        return super().invoke(context, event)

    def check(self, _context: bpy.types.Context) -> bool:
        """While the dialog is open: a typed name chooses the format, a chosen format the suffix."""
        before = self.format, self.filepath
        if self.format != self.format_named:
            files = exchange.rig_format(self.format).files
            usual = files[0] if len(files) == 1 else f"{self.format}_rig"
            path = Path(self.filepath)
            known = len(files) == 1 and path.suffix and self.filepath
            self.filepath = str(path.with_suffix(Path(usual).suffix) if known else usual)
        else:
            with contextlib.suppress(pe.InputError):
                self.format = exchange.format_of_file(Path(self.filepath), exchange.FILES)
        self.format_named = self.format
        return (self.format, self.filepath) != before

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene = context.scene
        try:
            path = chosen_file(self.filepath)
            is_told = self.properties.is_property_set("format") or not path.suffix
            told = self.format if is_told else None
            name = exchange.format_of_file(path, exchange.FILES, told)
            row = exchange.rig_format(name)
            study = bridge.study_from_scene(scene, context.evaluated_depsgraph_get())
            # Of one file the dialog has asked.
            replace = self.replace or not (row.beside or len(row.files) > 1)
            wanted = (study.rig, name, path, study.reference)
            passthrough = study.passthrough
            paths, lines = pe.export_rig(*wanted, passthrough=passthrough, replace=replace)
        except USER_ERRORS as error:
            return report_error(self, error)
        return report_files(self, *paths, lines=tuple(lines))


class PE_OT_import_rig(ImportHelper, bpy.types.Operator):
    """Replace the sensors of the scene by those of another program's file, as a variant.

    Present sensors that are no variant yet are saved as one"""

    bl_idname = "pe.import_rig"
    bl_label = "Import Rig"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default="*", options={"HIDDEN"})
    format: EnumProperty(items=(*_FORMAT_ITEMS, BY_NAME), name="Format", default="TOLD")
    ask: BoolProperty(
        name="Ask for Models",
        description="Ask for the models that the file does not name; otherwise default models are "
        "used",
        default=True,
    )

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        try:
            path = chosen_file(self.filepath)
            rig_file = read_rig(context.scene, path, self.format, {})
            if self.ask and rig_file.to_choose and not bpy.app.background:
                wanted = {"filepath": str(path), "format": self.format}
                return bpy.ops.pe.choose_models("INVOKE_DEFAULT", True, **wanted)
            return place_rig(self, context.scene, path, rig_file)
        except USER_ERRORS as error:
            return report_error(self, error)


def models_for(row: bpy.types.PropertyGroup, _context: object, typed: str) -> list[str]:
    """Return models of a row's kind whose names contain what is typed; all where none does."""
    return catalog.matching(typed, row.kind) or catalog.names(row.kind)


class PE_ModelChoice(bpy.types.PropertyGroup):
    """A sensor of a file, and the model chosen for it."""

    sensor: StringProperty(name="Sensor")
    kind: StringProperty(name="Kind")
    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        search=models_for,
        search_options=set(),
    )


class PE_OT_choose_models(bpy.types.Operator):
    """Choose the models of imported sensors, because the file does not name them"""

    bl_idname = "pe.choose_models"
    bl_label = "Choose Models"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN"})
    format: EnumProperty(items=(*_FORMAT_ITEMS, BY_NAME), default="TOLD", options={"HIDDEN"})
    rows: CollectionProperty(type=PE_ModelChoice)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
        try:
            rig_file = read_rig(context.scene, chosen_file(self.filepath), self.format, {})
        except USER_ERRORS as error:
            return report_error(self, error)
        self.rows.clear()
        for name in rig_file.to_choose:
            row, sensor = self.rows.add(), rig_file.rig[name]
            row.sensor, row.kind, row.model = name, sensor.kind, sensor.model.name
        return context.window_manager.invoke_props_dialog(self, width=480)

    def draw(self, _context: bpy.types.Context) -> None:
        draw_label(self.layout, "The file does not name the models of:")
        for row in self.rows:
            split = self.layout.split(factor=0.4)
            split.label(text=row.sensor, translate=False)
            split.prop(row, "model", text="")

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        try:
            path = chosen_file(self.filepath)
            models = {row.sensor: row.model for row in self.rows}
            return place_rig(
                self, context.scene, path, read_rig(context.scene, path, self.format, models)
            )
        except USER_ERRORS as error:
            return report_error(self, error)


def read_rig(
    scene: bpy.types.Scene, path: Path, name: str, chosen: Mapping[str, str]
) -> exchange.ImportedRig:
    """Return the rig of a file, with the chosen models by the sensors' names."""
    reference = bridge.reference_of(scene.perception_entropy)
    return pe.import_rig(_folder_of(path), None if name == "TOLD" else name, reference, chosen)


def place_rig(
    operator: bpy.types.Operator, scene: bpy.types.Scene, path: Path, found: exchange.ImportedRig
) -> OperatorResult:
    """Put the rig of a file into the scene, as a variant, and report warnings."""
    title = path.stem or path.parent.name
    come = tuple(found.rig), found.lines, f"Read from {path}"
    answer = replace_sensors(operator, scene, title, *come)
    bridge.write_passthrough(scene.perception_entropy, found.passthrough)
    return answer


def _folder_of(path: Path) -> Path:
    """Return the folder of a chosen file, where its format has several files."""
    several = [row.files for row in exchange.RIG_FORMATS.values() if len(row.files) > 1]
    return path.parent if any(path.name in files for files in several) else path


CLASSES = (
    PE_OT_export_rig,
    PE_OT_import_rig,
    PE_ModelChoice,
    PE_OT_choose_models,
)
