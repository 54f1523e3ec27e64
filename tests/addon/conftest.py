"""The add-on in bpy, without a window. Where there is no bpy the tests are skipped."""

import ctypes
import importlib
import importlib.util
import os
import sys

import pytest

from tests.few_errors import all_errors, few_errors

__all__ = ["all_errors", "few_errors"]
HAVE_BPY = importlib.util.find_spec("bpy") is not None
if HAVE_BPY:
    importlib.import_module("bpy")  # mathutils comes with it
# There is no bpy for every Python; where CI runs there is.
collect_ignore_glob = [] if HAVE_BPY or os.environ.get("CI") == "true" else ["test_*.py"]


def pytest_terminal_summary(terminalreporter) -> None:
    """Say why these tests are not there."""
    if not HAVE_BPY:
        terminalreporter.write_line("tests/addon skipped: there is no bpy in this Python")


@pytest.fixture(autouse=True)
def blender_s_own_words():
    """Have what Blender prints taken for the test's output, not left to be printed at the end."""
    yield
    ctypes.CDLL(None).fflush(None)


def sent(content):
    """Return content as it comes out of the engine's process: pickled, but for shared objects."""
    from blender_addon.processes import engine_process
    from pe_tools.engine_process.messages import packed, unpacked

    shared = {}
    kinds = tuple(engine_process.shared_types())

    def number_of(part):
        if not isinstance(part, kinds):
            return None
        shared[id(part)] = part
        return id(part)

    return unpacked(packed(content, number_of), shared.__getitem__)


@pytest.fixture(scope="session")
def everything_is_sent():
    """Have all that a window would send to the engine's process, and get from it, sent here too."""
    from blender_addon.engine import engine_process
    from blender_addon.operators.jobs import JobRow, Task

    call_here = engine_process.call_here
    finish = JobRow.finish
    make = Task.__new__

    def made(cls, job, *arguments, **options):
        sent(job)  # here it runs itself: what it counts is its own
        return make(cls, job, *arguments, **options)

    def called(function, arguments, deliver, fail, step=None):
        call_here(function, sent(arguments), lambda found: deliver(sent(found)), fail, step)

    def finished(self, scene, task, found, job):
        return finish(self, scene, task, sent(found), job)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engine_process, "call_here", called)
        patch.setattr(JobRow, "finish", finished)
        patch.setattr(Task, "__new__", made)
        yield


@pytest.fixture(scope="session")
def registered(everything_is_sent):
    """Return the add-on with its classes registered, once for all tests; nothing of it runs yet."""
    import bpy

    import blender_addon

    loaded = "tensorflow" in sys.modules
    assert not loaded, "TensorFlow in bpy's process: its LLVM and Mesa's crash at the first picture"
    bpy.ops.wm.read_factory_settings(use_empty=True)
    blender_addon.register()
    blender_addon.stop()
    yield blender_addon
    blender_addon.start()
    blender_addon.unregister()


@pytest.fixture
def addon(registered):
    """Return the add-on, started in an empty scene, and stop it in the end."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    registered.start()
    try:
        yield registered
    finally:
        registered.stop()


@pytest.fixture
def unregistered(registered):
    """Return the add-on for tests that register its classes themselves."""
    import bpy

    registered.start()
    registered.unregister()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    try:
        yield registered
    finally:
        registered.register()
        registered.stop()


@pytest.fixture
def scene(addon, few_errors):
    """Return the empty scene, set to score fast: few voxels, candidates and mounting errors."""
    import bpy

    settings = bpy.context.scene.perception_entropy
    settings.score_samples = settings.search_samples = 4096
    settings.candidates = 2
    settings.method = "random"
    return bpy.context.scene


@pytest.fixture
def small_pictures(monkeypatch):
    """Draw few pixels, for the picture and the page: what is in them does not depend on that."""
    from pe_tools.page.pictures import sensor_views, vehicle_picture

    monkeypatch.setattr(vehicle_picture, "SIZE", (192, 108))
    monkeypatch.setattr(sensor_views, "MAX_WIDTH", 128)


@pytest.fixture
def car(scene):
    """Return a scene with a car and a LiDAR of few beams on its roof."""
    from tests.addon import scenes

    scenes.add_car(scene)
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(-0.43, 0.0, 1.8))
    return scene
