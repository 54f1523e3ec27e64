"""Rigs in and out of other programs' files."""

from .carried import CarriedSensor, carried, picture_of, with_pictures
from .exporting import export_rig, rig_files, write_files
from .files import Written
from .importing import STAND_INS, ImportedRig, import_rig
from .limits import MAX_BEAMS, require_at_most
from .losses import MAX_RANGE, MIN_RANGE, MODEL, lost_line
from .passthrough import Passthrough
from .passthrough_file import (
    passthrough_of_text,
    passthrough_table,
    passthrough_text,
    read_passthrough,
)
from .pictures import Picture, straight
from .quaternions import pose_from_quaternion
from .table import RIG_FORMATS, RigFormat, rig_format
from .vehicle_info import read_vehicle_info

__all__ = [
    "MAX_BEAMS",
    "MAX_RANGE",
    "MIN_RANGE",
    "MODEL",
    "RIG_FORMATS",
    "STAND_INS",
    "CarriedSensor",
    "ImportedRig",
    "Passthrough",
    "Picture",
    "RigFormat",
    "Written",
    "carried",
    "export_rig",
    "import_rig",
    "lost_line",
    "passthrough_of_text",
    "passthrough_table",
    "passthrough_text",
    "picture_of",
    "pose_from_quaternion",
    "read_passthrough",
    "read_vehicle_info",
    "require_at_most",
    "rig_files",
    "rig_format",
    "straight",
    "with_pictures",
    "write_files",
]
