"""Rigs in and out of other programs' files."""

from .exporting import export_rig, rig_files, write_files
from .files import Written
from .importing import ImportedRig, import_rig
from .table import RIG_FORMATS, RigFormat, rig_format

__all__ = [
    "RIG_FORMATS",
    "ImportedRig",
    "RigFormat",
    "Written",
    "export_rig",
    "import_rig",
    "rig_files",
    "rig_format",
    "write_files",
]
