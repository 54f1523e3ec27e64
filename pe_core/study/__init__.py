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
    setting,
    settings_of,
    value_in_file,
)
from ..base.values import Angle, Name, Number, Whole
from ..search import METHODS, SCHEDULED_METHOD, Robustness
from . import requirement_file, requirement_search
from .condition_table import ConditionScore, ConditionTable, condition_table
from .conditions import Conditions, StateInWeather, state_from_dict, state_table
from .file_names import AREAS, MESH, OPTIMIZED, RESULT, REVIEW_PAGE, SCHEMA, SEARCH, STUDY
from .mounting_file import mounts_table
from .passthrough import passthrough_of_text, passthrough_table, passthrough_text, read_passthrough
from .study import OBJECTIVES, Search, Study, vehicle_digest
from .study_file import (
    is_switch,
    load_study,
    load_study_data,
    menu_of,
    panel_default,
    save_study,
    setting_keys,
    settings_of_part,
    study_from_dict,
    study_to_dict,
)
from .time_file import by_name_of_text, by_name_text, stories_of_rows, story_table

__all__ = ["AREAS", "MESH", "METHODS", "OBJECTIVES", "OPTIMIZED", "REQUIRED", "RESULT"]
__all__ += ["REVIEW_PAGE", "SCHEDULED_METHOD", "SCHEMA", "SEARCH", "STUDY"]
__all__ += ["Angle", "ConditionScore", "ConditionTable", "Conditions", "Name", "Number", "OneOf"]
__all__ += ["Pair", "Panel", "Robustness", "Search", "Setting", "Several", "StateInWeather"]
__all__ += ["Study", "Texts", "Toggle", "Triple", "Whole"]
__all__ += ["condition_table", "is_switch", "load_study", "load_study_data", "menu_of"]
__all__ += ["mounts_table", "panel_default", "passthrough_of_text", "passthrough_table"]
__all__ += ["passthrough_text", "read_passthrough", "requirement_file", "requirement_search"]
__all__ += ["save_study", "setting", "setting_keys", "settings_of", "settings_of_part"]
__all__ += ["state_from_dict", "state_table", "study_from_dict", "study_to_dict"]
__all__ += ["by_name_of_text", "by_name_text", "stories_of_rows", "story_table", "value_in_file"]
__all__ += ["vehicle_digest"]
