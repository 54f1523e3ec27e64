"""Rigs in and out of other programs' files."""

from .carried import picture_of
from .exporting import export_rig, rig_files, write_files
from .files import Written
from .importing import STAND_INS, ImportedRig, import_rig
from .pictures import Picture
from .table import RIG_FORMATS, RigFormat, rig_format
from .vehicle_info import read_vehicle_info

__all__ = [
    "RIG_FORMATS",
    "STAND_INS",
    "ImportedRig",
    "Picture",
    "RigFormat",
    "Written",
    "export_rig",
    "import_rig",
    "picture_of",
    "read_vehicle_info",
    "rig_files",
    "rig_format",
    "write_files",
]
