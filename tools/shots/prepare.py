"""Run inside Blender without a window: an empty file, and the sedan as somebody else's mesh."""

import sys
from pathlib import Path

import bpy

FOLDER = Path(sys.argv[-1])
SEDAN = Path(__file__).resolve().parents[2] / "blend_assets" / "sedan.blend"

bpy.context.preferences.filepaths.save_version = 0
bpy.ops.wm.read_homefile(use_factory_startup=True)
for each in tuple(bpy.data.objects):
    bpy.data.objects.remove(each)
bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "empty.blend"))

bpy.ops.wm.open_mainfile(filepath=str(SEDAN))
for each in bpy.context.scene.objects:
    each.select_set(each.type == "MESH" and not each.perception_entropy.is_sensor)
bpy.ops.wm.obj_export(
    filepath=str(FOLDER / "sedan.obj"), export_selected_objects=True, forward_axis="Y", up_axis="Z"
)
