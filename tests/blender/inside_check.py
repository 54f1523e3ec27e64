"""Run inside Blender: is the extension installed and registered? Saves the startup file."""

import sys

import bl_ext.user_default.perception_entropy
import bpy

module = bl_ext.user_default.perception_entropy
assert module.__file__.startswith(bpy.utils.user_resource("EXTENSIONS")), module.__file__
assert "perception_entropy" in bpy.types.Scene.bl_rna.properties, "not registered"
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
