"""Export of the scene: solids, footprints, glTF, recordings and ego masks (no import)."""

from ..graphics import color_text as color_text
from .footprints import GroundFootprint as GroundFootprint
from .footprints import GroundPlan as GroundPlan
from .footprints import ground_plan as ground_plan
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
from .solid import Solid as Solid
from .solid import blind_volume as blind_volume
from .solid import mounted_view as mounted_view
