"""What is drawn of sensors and of what they see: plain arrays, colours and words.

Blender's 3D view, the review's picture and the page draw the same ones, each in its own way. No
scene of Blender's, no GPU.
"""

from .beams import BeamChoice, Beams, ChannelMode, channels_of, shown_beams
from .bent import outline
from .casts import A_DRAFT, MOST, Cast, cast
from .colors import (
    CIVIDIS,
    COUNTS,
    PAPER,
    SENSOR_COLORS,
    VIEWPORT,
    VIRIDIS,
    Palette,
    Rgba,
    on_scale,
    sensor_color,
    sensor_color_on_paper,
    sensor_palette,
    with_alpha,
)
from .frustums import (
    footprint,
    footprint_faces,
    footprint_lines,
    frustum_faces,
    frustum_lines,
    frustum_points,
    ring_lines,
)
from .ground import (
    AS_SCORED,
    COUNT_NAMES,
    COVERAGE,
    ENTROPY,
    QUANTITIES,
    SENSORS,
    SWATCHES,
    as_scored,
    ground_map,
)
from .hidden import hidden_lines
from .kinds import DRAWINGS, Look, Sketch, beam_budget, drawing_of
from .png import as_bytes, png_bytes
from .primitives import ColorKey, GroundSheet, LayerShape, Primitives, Tag, fan, polyline
from .range_image import BODY_NEAR, NO_ECHO, RANGES, even_angles, range_colors, range_share
from .rays import RING_FAR_M, free_lines, ground_distance, ground_rings, stopped_lines

__all__ = [
    "AS_SCORED",
    "A_DRAFT",
    "BODY_NEAR",
    "CIVIDIS",
    "COUNTS",
    "COUNT_NAMES",
    "COVERAGE",
    "DRAWINGS",
    "ENTROPY",
    "MOST",
    "NO_ECHO",
    "PAPER",
    "QUANTITIES",
    "RANGES",
    "RING_FAR_M",
    "SENSORS",
    "SENSOR_COLORS",
    "SWATCHES",
    "VIEWPORT",
    "VIRIDIS",
    "BeamChoice",
    "Beams",
    "Cast",
    "ChannelMode",
    "ColorKey",
    "GroundSheet",
    "LayerShape",
    "Look",
    "Palette",
    "Primitives",
    "Rgba",
    "Sketch",
    "Tag",
    "as_bytes",
    "as_scored",
    "beam_budget",
    "cast",
    "channels_of",
    "drawing_of",
    "even_angles",
    "fan",
    "footprint",
    "footprint_faces",
    "footprint_lines",
    "free_lines",
    "frustum_faces",
    "frustum_lines",
    "frustum_points",
    "ground_distance",
    "ground_map",
    "ground_rings",
    "hidden_lines",
    "on_scale",
    "outline",
    "png_bytes",
    "polyline",
    "range_colors",
    "range_share",
    "ring_lines",
    "sensor_color",
    "sensor_color_on_paper",
    "sensor_palette",
    "shown_beams",
    "stopped_lines",
    "with_alpha",
]
