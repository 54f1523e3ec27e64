"""Export of the scene: glTF, a picture, and what plugins add (no import)."""

from .output_formats import OF_EXAMPLE as OF_EXAMPLE
from .output_formats import SceneOutput as SceneOutput
from .output_formats import export_scene as export_scene
from .output_formats import output_files as output_files
from .output_formats import scene_files as scene_files
from .output_formats import scene_output as scene_output
from .output_formats import scene_outputs as scene_outputs
from .request import BLIND as BLIND
from .request import BODY as BODY
from .request import OutputRequest as OutputRequest
from .solid import MountedView as MountedView
from .solid import Solid as Solid
from .solid import mounted_view as mounted_view
