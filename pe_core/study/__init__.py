"""Studies: their files, the work on them, and the results it leaves."""

from ..search import METHODS, SCHEDULED_METHOD, Robustness
from .checkpoint import SAVE_EVERY_S, Checkpoint
from .choice_job import ChoiceJob, Design, TradeOff
from .designed import design_study
from .exporting import export_study, study_writers
from .fingerprint import fingerprint
from .folder import FileSet, check_files, prepare_folder
from .front_files import (
    DESIGNS,
    FRONT_CSV,
    FRONT_JSON,
    FRONT_NAMES,
    FRONT_PLOT,
    front_dict,
    write_front,
)
from .job import Job, Progress
from .jobs import OptimizeJob, ScoreJob
from .mounted import mounts_told
from .names import AREAS, MESH, OPTIMIZED, RESULT, REVIEW, REVIEW_PAGE, SEARCH, STUDY
from .outcome import HistoryRow, Outcome
from .results import (
    add_to_result,
    files_of_other_runs,
    placements,
    result_dict,
    result_names,
    set_aside_files_of_other_runs,
    write_outcome,
)
from .search_state import BegunSearch, SearchState, read_search
from .study import Search, Study, vehicle_digest
from .study_file import load_study, load_study_data, save_study, study_from_dict, study_to_dict

__all__ = [
    "AREAS",
    "DESIGNS",
    "FRONT_CSV",
    "FRONT_JSON",
    "FRONT_NAMES",
    "FRONT_PLOT",
    "MESH",
    "METHODS",
    "OPTIMIZED",
    "RESULT",
    "REVIEW",
    "REVIEW_PAGE",
    "SAVE_EVERY_S",
    "SCHEDULED_METHOD",
    "SEARCH",
    "STUDY",
    "BegunSearch",
    "Checkpoint",
    "ChoiceJob",
    "Design",
    "FileSet",
    "HistoryRow",
    "Job",
    "OptimizeJob",
    "Outcome",
    "Progress",
    "Robustness",
    "ScoreJob",
    "Search",
    "SearchState",
    "Study",
    "TradeOff",
    "add_to_result",
    "check_files",
    "design_study",
    "export_study",
    "files_of_other_runs",
    "fingerprint",
    "front_dict",
    "load_study",
    "load_study_data",
    "mounts_told",
    "placements",
    "prepare_folder",
    "read_search",
    "result_dict",
    "result_names",
    "save_study",
    "set_aside_files_of_other_runs",
    "study_from_dict",
    "study_to_dict",
    "study_writers",
    "vehicle_digest",
    "write_front",
    "write_outcome",
]
