"""Studies: everything a run needs, and their files."""

from ..base.setting import (
    REQUIRED,
    OneOf,
    Pair,
    Panel,
    Setting,
    Several,
    Texts,
    Toggle,
    Triple,
    settings_of,
)
from ..base.setting_file import value_in_file
from ..base.values import Angle, Name, Number, Whole
from ..search import METHODS, SCHEDULED_METHOD, Robustness
from . import requirement_file, requirement_search
from .catalog_lookup import mounts_table
from .condition_file import state_from_dict, state_table
from .condition_set import Conditions, StateInWeather
from .condition_table import ConditionScore, ConditionTable, condition_table
from .file_names import AREAS, MESH, OPTIMIZED, RESULT, REVIEW_PAGE, SEARCH, STUDY
from .objective_setting import OBJECTIVES
from .passthrough import passthrough_of_text, passthrough_table, passthrough_text, read_passthrough
from .setting_table import is_switch, menu_of, panel_default, setting_keys, settings_of_part
from .study import Search, Study, vehicle_digest
from .study_file import load_study, load_study_data, save_study, study_from_dict, study_to_dict

__all__ = ["AREAS", "MESH", "ConditionScore", "ConditionTable", "Conditions", "StateInWeather"]
__all__ += ["METHODS", "OBJECTIVES", "OPTIMIZED", "REQUIRED", "RESULT", "REVIEW_PAGE"]
__all__ += ["SCHEDULED_METHOD", "SEARCH", "STUDY", "Angle", "Number", "OneOf", "Pair", "Panel"]
__all__ += [
    "Name",
    "Robustness",
    "Search",
    "Setting",
    "Several",
    "Study",
    "Texts",
    "Toggle",
    "Triple",
    "Whole",
    "condition_table",
]
__all__ += [
    "is_switch",
    "load_study",
    "load_study_data",
    "menu_of",
    "mounts_table",
    "panel_default",
]
__all__ += ["passthrough_of_text", "passthrough_table", "passthrough_text", "read_passthrough"]
__all__ += ["requirement_file", "requirement_search", "save_study", "setting_keys", "settings_of"]
__all__ += ["settings_of_part"]
__all__ += ["state_from_dict", "state_table", "study_from_dict", "study_to_dict"]
__all__ += ["value_in_file", "vehicle_digest"]
