"""Fixtures around a real Blender. Without one these tests are skipped; with CI=true they fail."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.blender.runner import Blender, Installed, output_of
from tests.blender.stage import TOOLS, WIDTH, Stage
from tests.limits import HANG_S
from tests.needed import unavailable

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
PLAIN_DRAWING = """
bpy.context.preferences.system.viewport_aa = "OFF"
bpy.context.preferences.view.smooth_view = 0
"""
"""A view that stands still is drawn once, not eight times, and jumps to where it is sent."""
QUICK_SCORE = """
window.scene.perception_entropy.score_samples = 16_384
space = area.spaces.active
for each in ("floor", "axis_x", "axis_y", "outline_selected", "relationship_lines", "cursor"):
    setattr(space.overlay, "show_" + each, False)
space.shading.light, space.shading.show_object_outline = "FLAT", False
bpy.ops.ed.undo_push(message="before the test")
"""
"""Few samples, and of the view's own decoration nothing: software draws it, pixel by pixel."""
PASSED = pytest.StashKey[bool]()


@pytest.fixture(scope="session")
def blender() -> Blender:
    """Return a real Blender, not bpy."""
    finder = [sys.executable, ROOT / "tools" / "real_blender.py"]
    found = subprocess.run(finder, capture_output=True, text=True, timeout=HANG_S)
    if found.returncode != 0:
        unavailable(found.stderr.strip().removeprefix("real_blender: "))
    return Blender(found.stdout.strip())


@pytest.fixture(scope="session")
def extension_zip() -> Path:
    """Return the extension, built from the sources as they are."""
    builder = [sys.executable, ROOT / "tools" / "build_extension.py"]
    built = subprocess.run(builder, capture_output=True, text=True, timeout=HANG_S)
    assert built.returncode == 0, output_of(built)
    return Path(built.stdout.strip())


@pytest.fixture(scope="session")
def installed(blender, extension_zip, tmp_path_factory) -> Installed:
    """Return Blender with the extension installed into a user folder of its own."""
    own = blender.with_resources(tmp_path_factory.mktemp("blender_user"))
    answer = own.run(
        ["--command", "extension", "install-file", "-r", "user_default", "--enable", extension_zip]
    )
    # install-file gives status 0 also when it refused: only starting with it tells.
    installed = Installed(own, tmp_path_factory.mktemp("startup") / "startup.blend")
    check = installed.script(HERE / "inside_check.py", installed.startup)
    assert check.returncode == 0, f"{output_of(answer)}\n{output_of(check)}"
    return installed


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


class SharedWindow:
    """One window for all tests: each begins with the file loaded anew.

    A window is closed, and the next test opens another, after a test that failed and after one that
    takes `spent_stage`.
    """

    def __init__(self, installed, blend, new_folder):
        self._installed = installed
        self._blend = blend
        self._new_folder = new_folder
        self._stage = None

    def begin(self) -> Stage:
        """Return the window, showing the file as it was saved."""
        if self._stage is None:
            self._stage = Stage(self._new_folder(), WIDTH)
            self._stage.open(self._installed, self._blend)
            self._stage.do(PLAIN_DRAWING)
        else:
            self._stage.load(self._blend)
        self._stage.do(QUICK_SCORE)
        return self._stage

    def close(self) -> None:
        """Close the window, if one is open."""
        if self._stage is not None:
            self._stage.close()
            self._stage = None


@pytest.fixture(scope="session")
def shared_window(installed, sedan, tmp_path_factory):
    """Return the window of all tests, and close it in the end."""
    if missing := [tool for tool in TOOLS if shutil.which(tool) is None]:
        unavailable(f"a window needs {', '.join(missing)}")
    shared = SharedWindow(installed, sedan, lambda: tmp_path_factory.mktemp("window"))
    yield shared
    shared.close()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """Remember of each test whether its body passed."""
    report = yield
    if call.when == "call":
        item.stash[PASSED] = report.passed
    return report


@pytest.fixture
def stage(shared_window, request):
    """Return Blender in a real window, showing the sedan, that also runs Python from outside."""
    try:
        shown = shared_window.begin()
        yield shown
    finally:
        if not request.node.stash.get(PASSED, False) or "spent_stage" in request.fixturenames:
            shared_window.close()


@pytest.fixture
def spent_stage(stage):
    """Return the window for a test after which none should begin in it, as it switches us off.

    Such tests come last (`tests/conftest.py`), so that the others share one window.
    """
    return stage


@pytest.fixture
def window(stage):
    """Return the same window, for tests that work it with mouse and keyboard alone."""
    return stage
