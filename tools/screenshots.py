#!/usr/bin/env python3
"""Make the pictures of the documentation in a real window: docs/images/*.png and the film.

A real Blender with the extension of this checkout, on a screen of its own, worked with its mouse
and keyboard. Names of reels make these alone; without names all are made.
"""

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT)]

from tests.blender.runner import Blender, Installed  # noqa: E402
from tests.blender.stage import Stage  # noqa: E402
from tools.shots import REELS, Reel  # noqa: E402
from tools.shots.reel import Camera  # noqa: E402

PREPARE = ROOT / "tools" / "shots" / "prepare.py"
SCALE = "bpy.context.preferences.view.ui_scale = 1.15"


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="reels to make: " + ", ".join(REELS))
    parser.add_argument("--suite", default="trixie", help="which Blender: trixie or sid")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images")
    options = parser.parse_args()
    unknown = [name for name in options.names if name not in REELS]
    if unknown:
        parser.error(f"no reel {unknown[0]!r}; there are {', '.join(REELS)}")
    with tempfile.TemporaryDirectory(prefix="pe-pictures-") as scratch:
        folder = Path(scratch)
        installed = install(folder / "user", options.suite)
        answer = installed.script(PREPARE, folder)
        if answer.returncode:
            print(f"screenshots: {answer.stderr or answer.stdout}", file=sys.stderr)
            return 1
        for name in options.names or REELS:
            shoot(REELS[name], installed, folder, options.out.resolve())
    if {"guide", "tour"} <= set(options.names or REELS):
        subprocess.run([sys.executable, "-m", "tests.addon.panel_digest"], cwd=ROOT, check=True)
    return 0


def shoot(reel: Reel, installed: Installed, folder: Path, out: Path) -> None:
    """Make the pictures of one reel, in a window of its own."""
    blend = folder / reel.blend
    with opened(
        installed, blend if blend.exists() else ROOT / "blend_assets" / reel.blend
    ) as stage:
        stage.do(SCALE)
        stage.rest()
        camera = Camera(stage, out, folder)
        for shot in reel.shots:
            shot(camera)
        for name, size in camera.kept.items():
            print(f"{name}: {size:,} bytes")


@contextmanager
def opened(installed: Installed, blend: Path) -> Iterator[Stage]:
    """A window that shows a file, closed whatever happens."""
    with tempfile.TemporaryDirectory(prefix="pe-stage-") as scratch:
        stage = Stage(Path(scratch))
        try:
            stage.open(installed, blend)
            yield stage
        finally:
            stage.close()


def install(folder: Path, suite: str) -> Installed:
    """Return a Blender with the extension of this checkout in a user folder of its own."""
    folder.mkdir()
    blender = Blender(answer_of("real_blender.py", "--suite", suite)).with_resources(folder)
    archive = answer_of("build_extension.py")
    command = ["extension", "install-file", "-r", "user_default", "--enable", archive]
    blender.run(["--command", *command])
    return Installed(blender)


def answer_of(tool: str, *arguments: str) -> str:
    """The line that one of our tools answers with."""
    command = [sys.executable, str(ROOT / "tools" / tool), *arguments]
    answer = subprocess.run(command, capture_output=True, text=True)
    if answer.returncode:
        raise SystemExit(answer.stderr.strip())
    return answer.stdout.strip().splitlines()[-1]


if __name__ == "__main__":
    sys.exit(main())
