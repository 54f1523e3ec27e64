"""What packages built on the engine leave beside a search's results."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..study import Outcome
from .work import Data, More

pages: list[More] = []
"""More files of a search: packages built on the engine add to it, with their verbs."""


def add_page_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that leaves the pages out."""
    names = ", ".join(name for page in pages for name in page.names)
    parser.add_argument(
        "--no-review", action="store_false", dest="review", help=f"no {names or 'review'}"
    )


def with_pages(args: argparse.Namespace, more: More | None = None) -> More | None:
    """Return what else a run leaves: `more`, and of a search the pages that are asked for."""
    asked = args.kind == "optimize" and args.review
    each = [*([more] if more else []), *(pages if asked else [])]
    if not each:
        return None

    def write(outcome: Outcome, data: Data, folder: Path) -> None:
        # Pages tell how to run it again.
        data["run"] = {**data["run"], "command": args.command_line}
        for one in each:
            one.write(outcome, data, folder)

    return More([name for one in each for name in one.names], write)
