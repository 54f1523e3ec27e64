"""Fixtures around a real Blender. Without one these tests are skipped; with CI=true they fail."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.blender.runner import Blender, Installed, output_of
from tests.blender.stage import Stage
from tests.blender.window import TOOLS, Window
from tests.needed import unavailable

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent


@pytest.fixture(scope="session")
def blender() -> Blender:
    """Return a real Blender, not bpy."""
    finder = [sys.executable, ROOT / "tools" / "real_blender.py"]
    found = subprocess.run(finder, capture_output=True, text=True, timeout=120)
    if found.returncode != 0:
        unavailable(found.stderr.strip().removeprefix("real_blender: "))
    return Blender(found.stdout.strip())


@pytest.fixture(scope="session")
def extension_zip() -> Path:
    """Return the extension, built from the sources as they are."""
    builder = [sys.executable, ROOT / "tools" / "build_extension.py"]
    built = subprocess.run(builder, capture_output=True, text=True, timeout=300)
    assert built.returncode == 0, output_of(built)
    return Path(built.stdout.strip())


@pytest.fixture(scope="session")
def installed(blender, extension_zip, tmp_path_factory) -> Installed:
    """Return Blender with the extension installed into a user folder of its own."""
    own = blender.with_resources(tmp_path_factory.mktemp("blender_user"))
    answer = own.run(
        *("--command", "extension", "install-file", "-r", "user_default", "--enable", extension_zip)
    )
    # install-file gives status 0 also when it refused: only starting with it tells.
    check = Installed(own).script(HERE / "inside_check.py")
    assert check.returncode == 0, f"{output_of(answer)}\n{output_of(check)}"
    return Installed(own)


@pytest.fixture(scope="session")
def sedan() -> Path:
    """Return the vehicle that comes with the project."""
    return ROOT / "blend_assets" / "sedan.blend"


@pytest.fixture(scope="session")
def screenshots() -> Path:
    """Return the folder where pictures of windows are kept for a look: ``$PE_SCREENSHOTS``."""
    folder = Path(os.environ.get("PE_SCREENSHOTS") or ROOT / "test_output").resolve()
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture
def window(installed, sedan, tmp_path):
    """Return Blender in a real window on a screen of its own, showing the sedan."""
    yield from opened(Window, installed, sedan, tmp_path)


@pytest.fixture
def stage(installed, sedan, tmp_path):
    """Return such a window that can be told in Python what to show."""
    yield from opened(Stage, installed, sedan, tmp_path)


def opened(kind, installed, blend, folder):
    """Open a window, hand it over, and close it whatever happened."""
    if missing := [tool for tool in TOOLS if shutil.which(tool) is None]:
        unavailable(f"a window needs {', '.join(missing)}")
    shown = kind(folder)
    try:
        shown.open(installed, blend)
        yield shown
    finally:
        shown.close()
