"""The command ``pe``, and the parts that all command lines of the project share."""

from .check_verb import add_check_options, check_study
from .choose_verb import choose, plots, resumed
from .command import (
    Parser,
    add_run_options,
    add_score_options,
    add_sensors_verb,
    as_typed,
    count_up_to,
    run,
    with_options,
)
from .exchange_verbs import (
    SUFFIXES,
    add_export_options,
    add_rigs_verb,
    chosen_models,
    export,
    study_of_rig,
)
from .explain_verbs import (
    add_compare_options,
    add_explain_options,
    compare,
    explain,
    named_by_file,
    refuse_different,
    scored,
)
from .interrupts import leave, noted_when_interrupted
from .run_job import (
    More,
    add_page_option,
    begun_search,
    carry_out,
    drive,
    job_and_folder,
    pages,
    with_pages,
)
from .sweep_verb import add_sweep_options, sweep
from .terminal import BAD_INPUT, DONE, USAGE, Answer, open_missing_streams, show, tell

__all__ = [
    "BAD_INPUT",
    "DONE",
    "SUFFIXES",
    "USAGE",
    "Answer",
    "More",
    "Parser",
    "add_check_options",
    "add_compare_options",
    "add_explain_options",
    "add_export_options",
    "add_page_option",
    "add_rigs_verb",
    "add_run_options",
    "add_score_options",
    "add_sensors_verb",
    "add_sweep_options",
    "as_typed",
    "begun_search",
    "carry_out",
    "check_study",
    "choose",
    "chosen_models",
    "compare",
    "count_up_to",
    "drive",
    "explain",
    "export",
    "job_and_folder",
    "leave",
    "named_by_file",
    "noted_when_interrupted",
    "open_missing_streams",
    "pages",
    "plots",
    "refuse_different",
    "resumed",
    "run",
    "scored",
    "show",
    "study_of_rig",
    "sweep",
    "tell",
    "with_options",
    "with_pages",
]
