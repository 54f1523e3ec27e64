"""The command ``pe``, and the parts that all command lines of the project share."""

from .answers import FilesAnswer, VerifyAnswer
from .check_verb import check, check_study
from .command import Parser, as_typed, run
from .built_verb import found_built
from .explain_verbs import refuse_different, scored
from .interrupts import leave, noted_when_interrupted
from .options import whole
from .region_verb import found_region
from .run_job import More, drive
from .story_text import chosen_stories, story_names
from .study_source import NONE, ONE, PERHAPS, SOME, StudyFiles
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
from .where_verb import where
