"""The command ``pe``, and what all command lines share."""

from .choosing import check_not_resumed, choose, plots
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
from .exchanging import add_export_options, chosen_models, export
from .explaining import (
    add_compare_options,
    add_explain_options,
    compare,
    explain,
    named_by_file,
    refuse_different,
    scored,
)
from .interrupts import leave, noted_when_interrupted
from .leaving import add_page_option, pages, with_pages
from .resuming import begun_search, job_and_folder
from .rigs import add_rigs_verb, study_of_rig
from .status import BAD_INPUT, DONE, INTERRUPTED, USAGE, Answer
from .summary import summary
from .sweeping import add_sweep_options, sweep
from .terminal import open_missing_streams, printable, show, tell
from .work import More, carry_out, drive

__all__ = [
    "BAD_INPUT",
    "DONE",
    "INTERRUPTED",
    "USAGE",
    "Answer",
    "More",
    "Parser",
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
    "check_not_resumed",
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
    "printable",
    "refuse_different",
    "run",
    "scored",
    "show",
    "study_of_rig",
    "summary",
    "sweep",
    "tell",
    "with_options",
    "with_pages",
]
