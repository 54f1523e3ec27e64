"""The verb ``review``, and the page that every search leaves: options alone.

What they do is imported when they are called, so that the other verbs start without it.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pe_core import Outcome
    from pe_core.app import Answer


def add_verbs(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb to the parser of ``pe``, and the page to what a search leaves."""
    from .engine import app

    review = verbs.add_parser("review", help="write a page to hand on: what the sensors see")
    about = "study file (TOML), or a folder of results"
    review.add_argument("studies", nargs="+", metavar="STUDY", help=about)
    add_review_options(review)
    app.add_score_options(review)
    review.set_defaults(function=_review)
    add_page()


def add_review_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``review`` besides what is reviewed."""
    parser.add_argument("-o", "--output", required=True, metavar="DIR", help="folder for the page")
    parser.add_argument("--replace", action="store_true", help="replace a page that is there")
    about = "title of the page, in place of the studies' names"
    parser.add_argument("--title", default="", metavar="TEXT", help=about)
    parser.add_argument("--author", default="", metavar="TEXT", help="who made it")
    about = "date on the page, any text; 'today' is the day of the run (none without it)"
    parser.add_argument("--date", default="", metavar="TEXT", help=about)
    parser.add_argument("--revision", default="", metavar="TEXT", help="revision of the page")


def add_page() -> None:
    """Have every search leave a page beside its results."""
    from .engine import app, studies

    if not any(studies.REVIEW_PAGE in more.names for more in app.pages):
        app.pages.append(app.More([studies.REVIEW_PAGE], _leave))


def _review(args: argparse.Namespace) -> Answer:
    from .making import review

    return review(args)


def _leave(outcome: Outcome, data: dict[str, Any], folder: Path) -> None:
    from .making import leave

    leave(outcome, data, folder)
