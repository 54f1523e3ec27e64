"""Studies: everything a run needs, and their files."""

from ..lazy_faces import lazy_face

with lazy_face(__name__):
    from ..base.codec import Declared, Node, read, write, write_fields
    from ..base.setting import (
        REQUIRED,
        Named,
        OneOf,
        Pair,
        Panel,
        Part,
        Setting,
        Several,
        Texts,
        Toggle,
        Triple,
        key_of,
        setting,
        settings_of,
        value_in_file,
    )
    from ..base.values import Angle, Name, Number, Whole
    from ..search import METHODS, SCHEDULED_METHOD, Robustness
    from . import requirement_file, requirement_search
    from .condition_table import ConditionScore, ConditionTable, condition_table
    from .conditions import Conditions, StateInWeather
    from .document import AxisBounds, Document, Optimize, SensorTable
    from .file_names import AREAS, MESH, OPTIMIZED, RESULT, REVIEW_PAGE, SCHEMA, SEARCH, STUDY
    from .mounting_file import mounts_table
    from .study import OBJECTIVES, Search, Study
    from .study_file import (
        is_switch,
        load_study,
        load_study_data,
        menu_of,
        panel_default,
        read_rig_line,
        rig_line,
        save_study,
        setting_keys,
        settings_of_part,
        study_from_dict,
        study_schema,
        study_to_dict,
    )
    from .suggestion import Suggestion
    from .vehicle_edges import Distance, Edge, MetresOrDistance, VehicleEdges
