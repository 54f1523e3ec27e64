"""``pe validate``: the scores, compared with the published results of trained detectors.

`published` has the placements and results, `scores` what is compared with them, `tasks` what is
computed, `ranks` and `correlations` the statistics, `page`, `findings` and `plots` show them.
"""

from __future__ import annotations

import argparse

from ..cli import Answer
from ..reproduction.verbs import add_page_options, output_folder

FOLDER, QUICK_FOLDER = "docs/validity", "validity-quick"


def add_verb(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb to the parser of ``pe``; what it does is imported when it is called."""
    about = "compare the scores with published results of detectors"
    parser = verbs.add_parser("validate", help=about)
    add_page_options(parser, FOLDER, QUICK_FOLDER, "on few voxels and objects, in a minute")
    parser.set_defaults(function=_validate)


def _validate(args: argparse.Namespace) -> Answer:
    from .validate import validate

    return validate(args, output_folder(args))
