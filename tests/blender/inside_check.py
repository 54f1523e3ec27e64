"""Run inside Blender: succeeds when the extension is installed and registered."""

import bl_ext.user_default.perception_entropy
import bpy

module = bl_ext.user_default.perception_entropy
assert module.__file__.startswith(bpy.utils.user_resource("EXTENSIONS")), module.__file__
assert "perception_entropy" in bpy.types.Scene.bl_rna.properties, "not registered"
