"""The command ``pe``, and the parts that all command lines of the project share."""

from pe_core.lazy_faces import lazy_face

with lazy_face(__name__):
    from ..jobs import FrontRecord, ResultRecord
    from .answers import BuiltAnswer, CatalogAnswer, CheckAnswer, CompareAnswer, CurvesAnswer
    from .answers import ExplainAnswer, FilesAnswer, KeysAnswer, PresetsAnswer, RegionAnswer
    from .answers import RigsAnswer, SensorAnswer, ServeReply, SweepAnswer, VerifyAnswer
    from .answers import WhereAnswer
    from .built_verb import compare_all, found_built
    from .catalog_verb import show_sensors
    from .check_verb import check, check_study
    from .command import Parser, as_typed, run
    from .exchange_verbs import export, import_study
    from .explain_verbs import explain, refuse_different, scored
    from .interrupts import leave, noted_when_interrupted
    from .new_verb import new
    from .options import whole
    from .region_verb import found_region, region
    from .run_job import More, drive, run_study
    from .serve_verb import serve
    from .set_verb import set_keys
    from .shipped_verbs import review, verify
    from .scenario_text import chosen_scenarios, scenario_names
    from .study_source import NONE, ONE, PERHAPS, SOME, StudyFiles
    from .sweep_verb import sweep
    from .terminal import (
        BAD_INPUT,
        DONE,
        NOT_MET,
        USAGE,
        Answer,
        answered,
        open_missing_streams,
        show,
        tell,
    )
    from .verbs import VERBS, Verb, answer, command_parser
    from .where_verb import where, where_study
