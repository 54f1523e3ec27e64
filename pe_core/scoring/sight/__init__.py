"""Visibility by location: the ground map, blind ground round the vehicle, reach."""

from ...lazy_faces import lazy_face

with lazy_face(__name__):
    from .blind_ground import (
        BLIND_TO_M,
        SECTOR_RADIUS_M,
        BlindGround,
        BlindSector,
        BlindSpot,
        reach_text,
        shown_end,
        shown_reach,
        shown_start,
    )
    from .ground_cells import outlines
    from .reach import Reach, ends_with_space, reach_line
    from .sight import Sight
    from .surround_view import NO_CAMERA, VEHICLE, SurroundView
    from .visibility import GroundSight, VisibleShares
