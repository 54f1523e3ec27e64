"""Graphics of sensors and their views as plain arrays: lines, triangles, colours and labels.
Blender's 3D view, the review picture and the web page render the same arrays, each with its own
means. Nothing here needs a Blender scene or a GPU."""

from pe_core.lazy_faces import lazy_face

with lazy_face(__name__):
    from .beams import MAX_BEAMS, PREVIEW_BEAMS, RING_FAR_M, BeamChoice, Cast, ChannelMode, cast
    from .beams import channels_of, free_lines, ground_distance, ground_rings, occluded_lines
    from .beams import shown_beams
    from .colors import CIVIDIS, COUNTS, DIFFERENCE, PAPER, VIEWPORT, VIRIDIS, Palette, Rgb, Rgba
    from .colors import color_text, free_tint, is_foreign_tint, linear, linear_of_srgb, on_scale
    from .colors import place_tints, rgb_of, sensor_colors, sensor_colors_on_paper, sensor_palette
    from .colors import srgb_of_linear, with_alpha
    from .drive_by import BRAKE, CONFIRMED, CORNERS, EDGES, FACES, NEVER, UNSEEN, BodiesInTime
    from .drive_by import MovingBody, MovingShape, TimeStrip, color_of_ap, digest, marks_of
    from .drive_by import moving_shape, strip_ends, strip_rows, time_strip
    from .ground import AS_SCORED, COVERAGE, ENTROPY, QUANTITIES, SENSORS, SWATCHES, as_scored
    from .ground import difference_map, fitted_bounds, ground_map, painted_samples, swatches_of
    from .kinds import beam_budget, drawing_of, footprint_faces, footprint_lines, ring_lines
    from .png import as_bytes, png_bytes
    from .primitives import (
        ColorKey,
        GroundSheet,
        LayerShape,
        Primitives,
        Tag,
        boxes_overlap,
        polyline,
    )
    from .sensor_images import BODY_NEAR, NO_ECHO, RANGES, even_angles, field_colors
    from .sensor_images import hidden_lines, range_colors
    from .simplify import simplified
    from .surface_map import FORBIDDEN, colored_surface
    from .surroundings import DASH_M, GAP_M, LANE_M, LINE_M, STRONG_EVERY, surroundings
