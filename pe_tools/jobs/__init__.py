"""Jobs that score and optimize studies, their checkpoints, and the files of their results."""

from .checkpoint import SAVE_EVERY_S, BegunSearch, Checkpoint, SearchState, read_search
from .choice_job import ChoiceJob, Design, TradeOff
from .designed import design_study
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
from .job import HistoryRow, Job, Outcome, Progress
from .results import (
    add_to_result,
    files_of_other_runs,
    placements,
    result_dict,
    result_names,
    set_aside_files_of_other_runs,
    write_outcome,
)
from .score_and_optimize import OptimizeJob, ScoreJob
from .study_export import export_study, fingerprint, study_writers

__all__ = [
    "DESIGNS",
    "FRONT_CSV",
    "FRONT_JSON",
    "FRONT_NAMES",
    "FRONT_PLOT",
    "SAVE_EVERY_S",
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
    "ScoreJob",
    "SearchState",
    "TradeOff",
    "add_to_result",
    "check_files",
    "design_study",
    "export_study",
    "files_of_other_runs",
    "fingerprint",
    "front_dict",
    "placements",
    "prepare_folder",
    "read_search",
    "result_dict",
    "result_names",
    "set_aside_files_of_other_runs",
    "study_writers",
    "write_front",
    "write_outcome",
]
