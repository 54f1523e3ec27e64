"""Verbs of rooms above the command, which finds them at run time."""

import argparse

from pe_core.base.plugins import shipped

from .study_source import StudyFiles
from .terminal import Answer


def review(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Write the review page of studies."""
    page: Answer = shipped("page.review")(source.studies(args), args, source.versions)
    return page


def verify(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Hold the engine to its golden cases."""
    found: Answer = shipped("verify.engine")(args, source.versions)
    return found
