#!/usr/bin/env python3
"""Search for places of the shuttle's four sensors, and write its page: in three minutes.

usage: tools/example_review.py [RESULTS]

RESULTS is a folder that such a search has left; without it one is made.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[1]
if str(ROOT) not in sys.path:  # run as a script
    sys.path.insert(0, str(ROOT))

from pe_core.study import Study  # noqa: E402
from pe_tools.cli import drive  # noqa: E402
from pe_tools.jobs import Outcome, ScoreJob  # noqa: E402
from pe_tools.page import ReportContext, page_bytes  # noqa: E402
from pe_tools.page.build import outcome_of_folder  # noqa: E402
from tests.review.browser import opened, started  # noqa: E402

EXAMPLE = Path("blend_assets/examples/four_corners")
PAGE = ROOT / "docs" / "reviews" / "four_corners.html"
PICTURE = ROOT / "docs" / "images" / "four_corners_review.png"
COMMAND = ["pe", "optimize", str(EXAMPLE / "study.toml"), "-o", "four_corners"]


def scored(study: Study) -> Outcome:
    """Score a study on its own voxels."""
    outcome = drive(ScoreJob(study))
    assert outcome is not None
    return outcome


def reviewed(results: Path) -> ReportContext:
    """Return the search in a folder of results as the content of its page."""
    outcome = outcome_of_folder(results, scored)
    assert outcome is not None, f"{results} holds no search"
    return ReportContext("The shuttle's four corners", outcome, command=" ".join(COMMAND))


def write(results: Path) -> None:
    """Write page and picture."""
    one = reviewed(results)
    PAGE.parent.mkdir(exist_ok=True)
    PAGE.write_bytes(page_bytes([one]))
    photograph()
    print(PAGE)


def photograph() -> None:
    """Write a screenshot of the page's 3-D view in Chromium."""
    with started() as browser, opened(browser, PAGE, (1280, 900)) as (page, _):
        page.locator(".v3-stage").screenshot(path=PICTURE)


def main(arguments: list[str]) -> int:
    """Search where no results are given, and write the page."""
    if arguments:
        write(Path(arguments[0]))
        return 0
    os.chdir(ROOT)
    with TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "pe_tools", *COMMAND[1:-1], folder, "--no-review"]
        status = subprocess.run(command).returncode
        if status == 0:
            write(Path(folder))
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
