"""Import and export of sensor rigs in the file formats of other programs."""

from pe_core.study.passthrough import Passthrough as Passthrough

from .autoware import read_vehicle_info as read_vehicle_info
from .exporting import export_rig as export_rig
from .exporting import lost_line as lost_line
from .exporting import rig_files as rig_files
from .exporting import write_files as write_files
from .foreign_values import MAX_BEAMS as MAX_BEAMS
from .foreign_values import Written as Written
from .foreign_values import require_at_most as require_at_most
from .frames import pose_from_quaternion as pose_from_quaternion
from .importing import STAND_INS as STAND_INS
from .importing import ImportedRig as ImportedRig
from .importing import import_rig as import_rig
from .lens_pictures import Picture as Picture
from .lens_pictures import straight as straight
from .portable import PortableSensor as PortableSensor
from .portable import with_pictures as with_pictures
from .portable_kinds import picture_of as picture_of
from .portable_kinds import portable_sensors as portable_sensors
from .rig_formats import FILES as FILES
from .rig_formats import MAX_RANGE as MAX_RANGE
from .rig_formats import MIN_RANGE as MIN_RANGE
from .rig_formats import MODEL as MODEL
from .rig_formats import RIG_FORMATS as RIG_FORMATS
from .rig_formats import format_of_file as format_of_file
from .rig_formats import rig_format as rig_format
