"""The prior p_S(s): how likely a voxel belongs to an object."""

from ..lazy_faces import lazy_face

with lazy_face(__name__):
    from .boxes import Boxes, BoxReport
    from .classes import HIGHWAY_CLASSES, ROAD_CLASSES, ObjectClass
    from .prior import Focus, Prior
