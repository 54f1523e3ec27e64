#!/usr/bin/env python3
"""Search for places of the shuttle's six sensors, and write its page: in ten minutes.

usage: tools/example_review.py [RESULTS]

RESULTS is a folder that such a search has left; without it one is made.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[1]
if str(ROOT) not in sys.path:  # run as a script
    sys.path.insert(0, str(ROOT))

from tests.review.browser import opened, started  # noqa: E402

FEW_COLORS = ("-colors", "128", "-define", "png:compression-level=9")
"""Options of ImageMagick: beams of all shades do not compress."""
EXAMPLE = Path("blend_assets/examples/four_corners")
PAGE = ROOT / "docs" / "reviews" / "four_corners.html"
PICTURE = ROOT / "docs" / "images" / "four_corners_review.png"
COMMAND = ["pe", "optimize", str(EXAMPLE / "study.toml"), "-o", "The shuttle's four corners"]


def write(results: Path) -> None:
    """Write page and picture."""
    PAGE.parent.mkdir(exist_ok=True)
    shutil.copyfile(results / "review.html", PAGE)
    photograph()
    print(PAGE)


def photograph() -> None:
    """Write a screenshot of the page's 3-D view in Chromium."""
    with started() as browser, opened(browser, PAGE, (1280, 900)) as (page, _):
        page.locator(".v3-stage").screenshot(path=PICTURE)
    subprocess.run(["convert", PICTURE, *FEW_COLORS, f"PNG8:{PICTURE}"], check=True)


def main(arguments: list[str]) -> int:
    """Search where no results are given, and write the page."""
    if arguments:
        write(Path(arguments[0]))
        return 0
    with TemporaryDirectory() as folder:  # the page has the command as it was typed
        (Path(folder) / EXAMPLE.parts[0]).symlink_to(ROOT / EXAMPLE.parts[0])
        command = [sys.executable, "-m", "pe_tools", *COMMAND[1:]]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        status = subprocess.run(command, cwd=folder, env=environment).returncode
        if status == 0:
            write(Path(folder) / COMMAND[-1])
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
