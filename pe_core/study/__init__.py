"""Studies: their files, the work on them, and the results it leaves."""

from .jobs import HistoryRow, Job, OptimizeJob, Outcome, Progress, ScoreJob
from .results import (
    MESH,
    STUDY,
    export_study,
    placements,
    prepare_folder,
    result_dict,
    write_outcome,
)
from .study import Search, Study
from .study_file import load_study, save_study, study_from_dict, study_to_dict

__all__ = [
    "MESH",
    "STUDY",
    "HistoryRow",
    "Job",
    "OptimizeJob",
    "Outcome",
    "Progress",
    "ScoreJob",
    "Search",
    "Study",
    "export_study",
    "load_study",
    "placements",
    "prepare_folder",
    "result_dict",
    "save_study",
    "study_from_dict",
    "study_to_dict",
    "write_outcome",
]
