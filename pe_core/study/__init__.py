"""Studies: everything a run needs, and their files."""

from ..base.setting import REQUIRED, OneOf, Pair, Panel, Setting, Toggle, settings_of
from ..base.setting_file import value_in_file
from ..base.values import Angle, Number, Whole
from ..search import METHODS, SCHEDULED_METHOD, Robustness
from . import requirement_file, requirement_search
from .catalog_lookup import mounts_table
from .file_names import AREAS, MESH, OPTIMIZED, RESULT, REVIEW, REVIEW_PAGE, SEARCH, STUDY
from .passthrough import passthrough_of_text, passthrough_table, passthrough_text, read_passthrough
from .setting_table import panel_default, setting_keys
from .study import Search, Study, vehicle_digest
from .study_file import load_study, load_study_data, save_study, study_from_dict, study_to_dict

__all__ = [
    "AREAS",
    "MESH",
    "METHODS",
    "OPTIMIZED",
    "REQUIRED",
    "RESULT",
    "REVIEW",
    "REVIEW_PAGE",
    "SCHEDULED_METHOD",
    "SEARCH",
    "STUDY",
    "Angle",
    "Number",
    "OneOf",
    "Pair",
    "Panel",
    "Robustness",
    "Search",
    "Setting",
    "Study",
    "Toggle",
    "Whole",
    "load_study",
    "load_study_data",
    "mounts_table",
    "panel_default",
    "passthrough_of_text",
    "passthrough_table",
    "passthrough_text",
    "read_passthrough",
    "requirement_file",
    "requirement_search",
    "save_study",
    "setting_keys",
    "settings_of",
    "study_from_dict",
    "study_to_dict",
    "value_in_file",
    "vehicle_digest",
]
