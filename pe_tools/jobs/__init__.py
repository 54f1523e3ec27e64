"""Jobs that score and optimize studies, their checkpoints, and the files of their results."""

from .check_job import CheckJob
from .checkpoint import (
    FRONT_SEARCH,
    SAVE_EVERY_S,
    BegunSearch,
    Checkpoint,
    FrontCheckpoint,
    FrontJournals,
    SearchState,
    front_study,
    read_front_search,
    read_search,
)
from .condition_files import condition_lines, conditions_csv
from .designed import design_study
from .folder import FileSet, check_files, prepare_folder
from .front_files import (
    FRONT_JSON,
    FRONT_NAMES,
    FRONT_PAGE,
    FRONT_PLOT,
    front_dict,
    write_front,
)
from .front_job import FrontJob, has_front
from .job import HistoryRow, Job, Outcome, Progress, StartEnd, best_so_far
from .results import (
    add_to_result,
    files_of_other_runs,
    placements,
    result_dict,
    result_names,
    runners_up,
    set_aside_files_of_other_runs,
    write_outcome,
)
from .score_and_optimize import OptimizeJob, ScoreJob
from .searched_figure import SearchedFigure, searched_figure, searched_on
from .stopping import stop_text, sureness_lines
from .study_export import export_study, fingerprint, study_writers
from .trade_off import Design, TradeOff

__all__ = [
    "FRONT_JSON",
    "FRONT_NAMES",
    "FRONT_PAGE",
    "FRONT_PLOT",
    "FRONT_SEARCH",
    "SAVE_EVERY_S",
    "BegunSearch",
    "CheckJob",
    "Checkpoint",
    "Design",
    "FileSet",
    "FrontCheckpoint",
    "FrontJob",
    "FrontJournals",
    "HistoryRow",
    "Job",
    "OptimizeJob",
    "Outcome",
    "Progress",
    "ScoreJob",
    "SearchState",
    "SearchedFigure",
    "StartEnd",
    "TradeOff",
    "add_to_result",
    "best_so_far",
    "check_files",
    "condition_lines",
    "conditions_csv",
    "design_study",
    "export_study",
    "files_of_other_runs",
    "fingerprint",
    "front_dict",
    "front_study",
    "has_front",
    "placements",
    "prepare_folder",
    "read_front_search",
    "read_search",
    "result_dict",
    "result_names",
    "runners_up",
    "searched_figure",
    "searched_on",
    "set_aside_files_of_other_runs",
    "stop_text",
    "study_writers",
    "sureness_lines",
    "write_front",
    "write_outcome",
]
