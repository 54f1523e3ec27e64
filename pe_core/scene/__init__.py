"""The scene: the vehicle, mounted sensors and their housings, and objects on the road."""

from ..lazy_faces import lazy_face

with lazy_face(__name__):
    from ..geometry.grids import PerceptionSpace
    from ..geometry.poses import Pose, rotate, rotation_matrix, rpy_from_matrix
    from .data_sheet import DataSheet
    from .mesh import BodyShape
    from .named_places import PLACE_NAMES, NamedPlace, named_places
    from .objects import Objects
    from .rig import Housing, Rig, Sensor, cuts_body
    from .vehicle import Vehicle
    from .vehicle_description import Reference, guessed_reference, vehicle_line
    from .vehicle_state import Motion, State
