"""Jobs that score and optimize studies, their checkpoints, and the files of their results."""

from pe_core.lazy_faces import lazy_face

with lazy_face(__name__):
    from .built_job import BuiltJob
    from .check_job import Checked, CheckJob, SuggestJob
    from .checkpoint import SAVE_EVERY_S, BegunSearch, Checkpoint, FrontCheckpoint, checkpoint_of
    from .checkpoint import read_search, resume
    from .folder import FileSet, check_files, prepare_folder
    from .front_files import FRONT_JSON, FRONT_NAMES, FRONT_PAGE, front_dict, write_front
    from .front_job import FrontJob, FrontJournals, has_front
    from .job import HistoryRow, Job, Outcome, Progress, StartEnd, StudyEvaluators, best_so_far
    from .optimize_job import OptimizeJob
    from .region_job import RegionJob, region_mount, region_places, study_on_region
    from .result_record import FrontRecord, OpenTable, PlacedSensors, ResultRecord, placements
    from .results import SearchState, add_to_result, condition_lines
    from .results import result_dict, result_names, run_record, score_facts, stored_result
    from .results import is_result_of, write_outcome
    from .score_job import ScoreJob
    from .searched_figure import SearchedFigure, searched_figure, searched_on
    from .stopping import scatter_text, stop_text, sureness_lines
    from .study_export import export_study, fingerprint, study_text, study_writers
    from .trade_off import Design, TradeOff, design_study
    from .watched_job import JobRun, JobStep, WatchedJob
    from .where_job import APART_M, BEST, PLACE_FIGURES, PlaceFigure, PlaceMap, WhereJob
