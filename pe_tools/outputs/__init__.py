"""Export of the scene: glTF, a picture, and what plugins add (no import)."""

from pe_core.lazy_faces import lazy_face

with lazy_face(__name__):
    from .output_formats import OF_EXAMPLE, SceneOutput, export_scene, output_files, scene_files
    from .output_formats import scene_output, scene_outputs
    from .request import BLIND, BODY, OutputRequest
    from .solid import MountedView, Solid, mounted_view
