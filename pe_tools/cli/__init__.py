"""The command ``pe``, and the parts that all command lines of the project share."""

from .check_verb import add_check_options, check_study
from .command import Parser, add_run_options, add_score_options, add_sensors_verb, as_typed
from .command import count_up_to, run, with_options
from .drive_by_verb import add_drive_by_options, chosen_stories, drive_by_study
from .exchange_verbs import SUFFIXES, add_export_options, add_rigs_verb, chosen_models, export
from .explain_verbs import add_compare_options, add_explain_options, compare, explain, named_by_file
from .explain_verbs import refuse_different, scored
from .interrupts import leave, noted_when_interrupted
from .run_job import More, add_page_option, drive, front_pages, pages, run_study
from .sweep_verb import add_sweep_options, sweep
from .terminal import BAD_INPUT, DONE, USAGE, Answer, open_missing_streams, show, tell
from .where_verb import add_where_options, where
