"""``pe validate``: the scores, compared with the published results of trained detectors.

`published` has the placements and results, `scores` what is compared with them, `tasks` what is
computed, `ranks` and `correlations` the statistics, `page`, `findings` and `plots` show them.
"""

from __future__ import annotations

import argparse

from ..cli import Answer, count_up_to
from ..reproduction.verbs import add_page_options, output_folder

FOLDER, QUICK_FOLDER = "docs/validity", "validity-quick"
OWN_FOLDER, OWN_QUICK_FOLDER = "docs/validity/own", "validity-own-quick"
MAX_RUNS = 10_000


def add_verb(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb to the parser of ``pe``; what it does is imported when it is called."""
    about = "compare the scores with published results of detectors"
    parser = verbs.add_parser("validate", help=about)
    add_page_options(parser, FOLDER, QUICK_FOLDER, "on few voxels and objects, in a minute")
    own = parser.add_argument_group("our own study")
    about = f"train detectors at the placements of the plan (default folder {OWN_FOLDER})"
    own.add_argument("--own", action="store_true", help=about)
    about = "the study of camera placements instead of that of LiDARs"
    which = own.add_mutually_exclusive_group()
    which.add_argument("--cameras", action="store_true", help=about)
    about = "the study before and after a search: its searches, unless they are done, and its runs"
    which.add_argument("--after-search", action="store_true", help=about)
    own.add_argument("--resume", action="store_true", help="go on where the folder's runs end")
    about = "do at most so many runs now"
    own.add_argument("--runs", type=count_up_to(MAX_RUNS), metavar="N", help=about)
    about = 'write the curves of [ap] model = "scans", fitted to the runs, to this file'
    own.add_argument("--curves", metavar="FILE", help=about)
    parser.set_defaults(function=_validate)


def _validate(args: argparse.Namespace) -> Answer:
    if args.own or args.cameras or args.after_search:
        from .own.command import validate_own

        args.default_output, args.default_quick_output = OWN_FOLDER, OWN_QUICK_FOLDER
        return validate_own(args, output_folder(args))
    from .validate import validate

    return validate(args, output_folder(args))
