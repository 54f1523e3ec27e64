"""The scene for other programs: solids, footprints, glTF, recordings."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from .. import bridge
from ..engine import exchange, outputs
from .exporting import ExportJob, ExportOperator, ExportSteps, WrittenFiles
from .reports import chosen_file

_ROWS = tuple((row.name, row.title, "", k) for k, row in enumerate(outputs.SCENE_OUTPUTS.values()))


class PE_OT_export_scene(ExportOperator, bpy.types.Operator):
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

    def job(self, context: bpy.types.Context) -> ExportJob:
        """Read the scene; work its files out beside the window."""
        row = outputs.scene_output(self.output)
        path = _with_ending(chosen_file(self.filepath), row)
        study = bridge.study_from_scene(context.scene, context.evaluated_depsgraph_get())
        replace = self.replace or not row.has_several  # of one file the dialog has asked
        reach = self.range_m or None
        steps = PE_OT_export_scene.steps  # the operator ends with its dialog
        return ExportJob(study, lambda job: steps(job, row, path, reach, replace))

    @staticmethod
    def steps(
        job: ExportJob, row: outputs.SceneOutput, path: Path, reach: float | None, replace: bool
    ) -> ExportSteps:
        """Make the files in a thread, then write them."""

        def work() -> tuple[dict[str, bytes], list[str]]:
            return outputs.scene_files(job.study, row.name, reach)

        made = yield from job.made(f"exporting {row.title}", 0.0, work)
        if made is None:
            return None
        files, lines = made
        paths = exchange.write_files(files, path, inside=row.has_several, replace=replace)
        return WrittenFiles(tuple(paths), tuple(lines))


def _with_ending(path: Path, row: outputs.SceneOutput) -> Path:
    """Return the path with the output's own ending where it has none."""
    return path if row.has_several or path.suffix else path.with_suffix(Path(row.file).suffix)


CLASSES = (PE_OT_export_scene,)
