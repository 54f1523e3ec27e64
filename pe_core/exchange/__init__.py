"""Rigs in and out of other programs' files."""

from .exporting import export_rig, rig_files, write_files
from .files import Written
from .importing import ImportedRig, import_rig
from .table import RIG_FORMATS, RigFormat, rig_format
from .vehicle_info import read_vehicle_info

__all__ = [
    "RIG_FORMATS",
    "ImportedRig",
    "RigFormat",
    "Written",
    "export_rig",
    "import_rig",
    "read_vehicle_info",
    "rig_files",
    "rig_format",
    "write_files",
]
