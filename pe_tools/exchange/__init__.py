"""Import and export of sensor rigs in the file formats of other programs."""

from pe_core.study.passthrough import Passthrough

from .autoware import read_vehicle_info
from .exporting import export_rig, rig_files, write_files
from .foreign_values import MAX_BEAMS, Written, require_at_most
from .frames import pose_from_quaternion
from .importing import STAND_INS, ImportedRig, import_rig
from .lens_pictures import Picture, straight
from .losses import MAX_RANGE, MIN_RANGE, MODEL, lost_line
from .portable import PortableSensor, with_pictures
from .portable_kinds import picture_of, portable_sensors
from .rig_formats import FILES, RIG_FORMATS, RigFormat, format_of_file, rig_format

__all__ = [
    "FILES",
    "MAX_BEAMS",
    "MAX_RANGE",
    "MIN_RANGE",
    "MODEL",
    "RIG_FORMATS",
    "STAND_INS",
    "ImportedRig",
    "Passthrough",
    "Picture",
    "PortableSensor",
    "RigFormat",
    "Written",
    "export_rig",
    "format_of_file",
    "import_rig",
    "lost_line",
    "picture_of",
    "portable_sensors",
    "pose_from_quaternion",
    "read_vehicle_info",
    "require_at_most",
    "rig_files",
    "rig_format",
    "straight",
    "with_pictures",
    "write_files",
]
