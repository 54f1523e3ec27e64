"""Studies: their files, the work on them, and the results it leaves."""

from ..search import METHODS
from .folder import FileSet, check_files, prepare_folder
from .job import Job, Progress
from .jobs import OptimizeJob, ScoreJob
from .names import MESH, OPTIMIZED, RESULT, REVIEW, STUDY
from .outcome import HistoryRow, Outcome
from .results import (
    add_to_result,
    export_study,
    files_of_other_runs,
    placements,
    result_dict,
    result_names,
    study_writers,
    write_outcome,
)
from .study import Search, Study, vehicle_digest
from .study_file import load_study, save_study, study_from_dict, study_to_dict

__all__ = [
    "MESH",
    "METHODS",
    "OPTIMIZED",
    "RESULT",
    "REVIEW",
    "STUDY",
    "FileSet",
    "HistoryRow",
    "Job",
    "OptimizeJob",
    "Outcome",
    "Progress",
    "ScoreJob",
    "Search",
    "Study",
    "add_to_result",
    "check_files",
    "export_study",
    "files_of_other_runs",
    "load_study",
    "placements",
    "prepare_folder",
    "result_dict",
    "result_names",
    "save_study",
    "study_from_dict",
    "study_to_dict",
    "study_writers",
    "vehicle_digest",
    "write_outcome",
]
