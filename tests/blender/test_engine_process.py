"""The engine of a real window: killed at the worst moment, and ended with what it serves."""

import json
import signal

import psutil
import pytest

from tests.blender.runner import output_of
from tests.blender.test_search_window import ask_for
from tests.limits import HANG_S

NAME = "bl_ext.user_default.perception_entropy"
ENGINE = f"__import__('{NAME}.processes.engine_process', fromlist=['*'])"
RUNNING = f"__import__('{NAME}.operators.running_job', fromlist=['*']).current"
LIVE = f"__import__('{NAME}.live.state', fromlist=['*']).live_state(window.scene.name)"
SETTINGS = "window.scene.perception_entropy"
SMALL_SEARCH = f"""
settings = {SETTINGS}
settings.show_overlay = False
settings.score_samples = settings.search_samples = 4096
settings.method, settings.candidates, settings.seed = "random", 8, 3
"""
SEARCH = "bpy.ops.pe.optimize('INVOKE_DEFAULT')"

THREADS = f"""
import sys, threading
from pathlib import Path
ours = [each for name, each in sys.modules.items() if name.startswith({NAME!r})]
files = [Path(each.__file__) for each in ours if getattr(each, "__file__", None)]
kept["threading"] = [str(path) for path in files if b"threading" in path.read_bytes()]
kept["threads"], kept["modules"] = threading.active_count(), len(files)
"""


def engine_of(stage):
    """The process that serves the window."""
    return psutil.Process(stage.do(f"kept['pid'] = {ENGINE}._engine.pid")["pid"])


def wait_for_evaluations(stage, count):
    stage.wait_until(f"{RUNNING} and {RUNNING}.seen.evaluations >= {count}")


@pytest.mark.thorough
def test_killed_in_a_drag_and_in_a_search_it_goes_on(stage, installed, tmp_path):
    """A search that was interrupted so has the bits of one without a window that was not."""
    stage.do(SMALL_SEARCH)
    begun = tmp_path / "begun.blend"
    stage.do(f"bpy.ops.wm.save_as_mainfile(filepath={str(begun)!r}, copy=True)")
    stage.do(f"{SETTINGS}.live.on = True")
    stage.wait_until(f"{LIVE}.score and {LIVE}.score.exact")
    for held in (True, False):
        before = engine_of(stage)
        if held:
            before.suspend()  # it has not answered yet
        stage.do("window.scene.objects['roof_lidar'].location.x += 0.05")
        stage.rest(0.3)
        before.kill()
        stage.wait_until(f"{LIVE}.is_current({LIVE}.score)")
    stage.do(f"window.scene.objects['roof_lidar'].location.x -= 0.1\n{SETTINGS}.live.on = False")
    stage.load(begun)
    stage.do(SEARCH)
    wait_for_evaluations(stage, 16)
    stage.rest(2.5)  # what it goes on with is sent every two seconds
    engine_of(stage).kill()
    found = stage.do(THREADS)
    assert found["threads"] == 1 and not found["threading"], "Blender has none of ours"
    assert found["modules"] > 100
    stage.wait_until(f"{RUNNING} is None and {SETTINGS}.has_result")
    found = stage.do(f"kept['found'] = ({SETTINGS}.result.entropy,)")
    answer = installed.pe(
        begun, ["optimize", "--no-review", "--json", "--output", tmp_path / "out"]
    )
    assert answer.returncode == 0, output_of(answer)
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert result["entropy"] <= result["before"]["entropy"]
    for name in ("optimized.blend", "history.csv"):
        assert (tmp_path / "out" / name).stat().st_size > 0, name
    shown = round(found["found"][0], 6)
    assert shown == round(result["entropy"], 6), "a window and the command line differ"
    assert "bl_ext" not in stage.log.read_text()  # a worker that began may tell of its end


def test_killed_in_an_export_it_writes_the_page_all_the_same(stage, tmp_path):
    page = tmp_path / "page" / "review.html"
    page.parent.mkdir()
    stage.do(SMALL_SEARCH)
    ask_for(stage, page)
    stage.wait_until(f"{RUNNING} and {RUNNING}.progress.fraction > 0.0")
    engine_of(stage).kill()
    stage.wait_until(f"{RUNNING} is None")
    assert "</html>" in page.read_text("utf-8")[-20:]
    names = {path.name for path in page.parent.iterdir()}
    assert names == {page.name, ".perception-entropy.json"}, "nothing unfinished is left"


@pytest.mark.thorough
def test_it_ends_with_the_file_and_with_blender(spent_stage, sedan):
    stage = spent_stage
    stage.do(SMALL_SEARCH + "settings.candidates = 4000\n" + SEARCH)
    wait_for_evaluations(stage, 4)
    engine = engine_of(stage)
    stage.load(sedan)
    engine.wait(HANG_S)
    stage.do(SMALL_SEARCH + "settings.candidates = 4000\n" + SEARCH)
    wait_for_evaluations(stage, 4)
    engine = engine_of(stage)
    family = [engine, *engine.children(recursive=True)]
    engine.parent().send_signal(signal.SIGKILL)
    _, alive = psutil.wait_procs(family, timeout=HANG_S)
    assert not alive, "left behind"
