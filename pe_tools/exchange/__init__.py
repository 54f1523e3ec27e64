"""Import and export of sensor rigs in the file formats of other programs."""

from pe_core.lazy_faces import lazy_face

with lazy_face(__name__):
    from .autoware import read_vehicle_info
    from .exporting import export_rig, lost_line, rig_files, write_files
    from .foreign_values import MAX_BEAMS, Written, require_at_most
    from .frames import pose_from_quaternion
    from .importing import ImportedRig, import_rig
    from .lens_pictures import Picture, straight
    from .osi import mounting_position
    from .portable import PortableSensor, SceneFacts, with_pictures
    from .portable_kinds import picture_of, portable_sensors
    from .rig_formats import (
        FILES,
        MAX_RANGE,
        MIN_RANGE,
        MODEL,
        RIG_FORMATS,
        format_of_file,
        format_to_read,
        origin_of,
        rig_format,
    )
