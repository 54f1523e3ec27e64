"""The live score in a real window: it follows a real mouse, and ends exact to the bit."""

import json
import re

import pytest

from tests.blender.runner import output_of

EFFECT_TIMEOUT_S = 120
SAMPLES = 32_768
LIVE_COLUMN = 0.5
"""Where in the row of *Score* the switch *Live* is."""
MOVES = 12
NAME = "bl_ext.user_default.perception_entropy"
SETTLED = f"""
import threading
import bpy
kept["handlers"] = [
    f.__name__ for name in dir(bpy.app.handlers)
    if isinstance(each := getattr(bpy.app.handlers, name), list)
    for f in each if f.__module__.startswith({NAME!r})
]
kept["threads"] = threading.active_count()
"""
DISABLE = f"import addon_utils; addon_utils.disable({NAME!r})"
ENABLE = f"import addon_utils; addon_utils.enable({NAME!r})"
CALM = """
window.scene.perception_entropy.show_overlay = False  # the picture is not what is tested
for each in window.scene.objects:
    each.select_set(each.name == "roof_lidar", view_layer=window.view_layer)
window.view_layer.objects.active = window.scene.objects["roof_lidar"]
"""


RECORD = f"""
from {NAME}.live import readout
from {NAME}.panels import dashboard
def recorded(module, who):
    plain = module.for_drawing
    def for_drawing(scene):
        found = plain(scene)
        kept[who] = None if found is None else [found.phase, found.label, *found.signature[:2]]
        return found
    module.for_drawing = for_drawing
for who, module in (("panel", dashboard), ("readout", readout)):
    recorded(module, who)
"""


@pytest.fixture
def live(stage):
    """A window on the sedan, the live score switched on by its button."""
    stage.do(CALM)
    stage.do(RECORD)
    _, y = stage.find_button("pe.score")
    sidebar = json.loads((stage.folder / "ready.json").read_text())["sidebar"]
    stage.click(round(sidebar["left"] + LIVE_COLUMN * sidebar["width"]), y)
    stage.wait_for(lambda: stage.state["live"]["on"], EFFECT_TIMEOUT_S, "the switch")
    wait_for_rest(stage)
    return stage


def wait_for_rest(stage, other_than=None):
    """Wait for an exact reading."""

    exact = []

    def rested():
        said = stage.state["live"]
        if said.get("rested") and said["entropy"] != other_than:
            exact.append(said["entropy"])
        return exact

    stage.wait_for(rested, EFFECT_TIMEOUT_S, "an exact score")
    return exact[-1]  # not read again: an undo may have begun the next score meanwhile


def grab_and_move(stage, moves=MOVES):
    """Press G over the view and move the mouse; the sensor follows it until a click."""
    stage.point_at_view()
    stage.key("g")
    for _ in range(moves):
        stage.mouse("mousemove_relative", "--", 4, -3)
        stage.rest(0.1)


def drawn(stage, phase):
    """Wait until panel and read-out are drawn in a phase; both then show one state."""
    both = stage.do("pass", redraw=False)

    def is_drawn():
        nonlocal both
        both = stage.do("pass", redraw=False)
        return [both["panel"][0], both["readout"][0]] == [phase, phase]

    stage.wait_for(is_drawn, EFFECT_TIMEOUT_S, f"panel and read-out {phase}")
    assert both["panel"] == both["readout"]
    return both["panel"]


def next_exact(stage, after, moved_from=None):
    """Wait for the exact score of what stands there after another reading, and after a move."""

    def there():
        said = stage.state["live"]
        is_next = said["rested"] and said["number"] > after["number"]
        return is_next and said["entropy"] != moved_from

    stage.wait_for(there, EFFECT_TIMEOUT_S, "an exact score")
    return stage.state["live"]


def test_a_drag_is_followed_and_ends_exact_to_the_bit(live, screenshots, installed, tmp_path):
    """The change stays when the hand lets go: Blender's last update of a move begins none."""
    begun = live.state["live"]
    start = begun["entropy"]
    grab_and_move(live)
    live.wait_for(lambda: live.state["live"].get("before") == start, EFFECT_TIMEOUT_S, "a score")
    assert live.state["live"]["entropy"] != start
    live.photograph(screenshots / "window_live_drag.png")
    assert drawn(live, "at rest")[1] == "before this move"
    held = next_exact(live, begun)  # held still until it is scored
    assert held["before"] == start
    live.mouse("click", 1)
    let_go = next_exact(live, held)
    assert (let_go["before"], let_go["entropy"]) == (start, held["entropy"])
    live.photograph(screenshots / "window_live_rest.png")

    copy = tmp_path / "moved.blend"
    end = let_go["entropy"]
    live.do(f"bpy.ops.wm.save_as_mainfile(filepath={str(copy)!r}, copy=True)")
    answer = installed.pe(copy, ["score", "--samples", SAMPLES, "--json", "--output", tmp_path])
    assert answer.returncode == 0, output_of(answer)
    found = json.loads((tmp_path / "result.json").read_text())
    assert found["entropy"] == end, "a window and the command line differ"

    live.point_at_view()
    live.key("g")
    live.mouse("mousemove_relative", "--", 60, -20)
    held = next_exact(live, let_go, moved_from=end)  # the key alone may be scored first
    assert held["before"] == end
    live.key("Escape")
    # On a busy machine the end of the move may be scored once more before the key is heeded.
    live.wait_for(lambda: wait_for_rest(live) == end, EFFECT_TIMEOUT_S, "the score from before")
    assert live.state["live"]["before"] == end
    assert drawn(live, "at rest")[2] == end

    live.key("ctrl+z")
    live.wait_for(lambda: wait_for_rest(live) == start, EFFECT_TIMEOUT_S, "the start's score")
    assert drawn(live, "at rest")[2] == start
    assert "Traceback" not in live.log.read_text()


@pytest.mark.thorough
def test_disabled_in_the_middle_of_anything_it_leaves_nothing_and_works_again(
    live, spent_stage, screenshots
):
    """During a drag, at rest, during a search by its button, and during one begun by a script."""
    grab_and_move(live, moves=4)
    live.do(DISABLE)
    live.mouse("click", 1)
    live.do(SETTLED)
    gone = live.do("kept['done'] = True")
    assert gone["handlers"] == [] and gone["threads"] == 1
    live.do(ENABLE)
    live.wait_until("window.scene.perception_entropy.live.on is not None")
    assert "Traceback" not in live.log.read_text()

    stage = spent_stage
    said = len(live.log.read_text())
    names = "[each.name for each in bpy.context.preferences.filepaths.asset_libraries]"
    stage.do("window.scene.perception_entropy.live.on = False")
    stage.wait_until(f"'Perception Entropy' in {names}")
    stage.do(f"bpy.ops.preferences.addon_disable(module={NAME!r})")
    stage.wait_until(f"'Perception Entropy' not in {names}")
    stage.do(f"bpy.ops.preferences.addon_enable(module={NAME!r})")
    stage.wait_until(f"'Perception Entropy' in {names}")

    stage.do(CALM)
    places = stage.state["places"]
    stage.press_until("pe.optimize", lambda: stage.state["running"], "the search to start")
    stage.do(DISABLE)
    stage.do(ENABLE)
    stage.wait_until("bpy.ops.pe.score.poll() and bpy.ops.pe.optimize.poll()")
    stage.screenshot(screenshots / "window_disabled_and_enabled.png")
    stage.press("pe.score")
    stage.wait_until("window.scene.perception_entropy.has_result", timeout_s=2 * EFFECT_TIMEOUT_S)
    assert stage.state["places"] == places, "the search that was ended has moved something"

    for _ in range(2):  # no event comes in between: the removed operator's handler is gone
        stage.do("bpy.ops.pe.optimize('INVOKE_DEFAULT')")
        stage.do(DISABLE)
        stage.rest()
        stage.do(ENABLE)
    stage.do("bpy.ops.pe.optimize('INVOKE_DEFAULT')")
    stage.wait_for(lambda: stage.state["running"], EFFECT_TIMEOUT_S, "the search to start")
    stage.point_at_view()
    stage.key("Escape")
    stage.wait_for(lambda: not stage.state["running"], EFFECT_TIMEOUT_S, "the search to end")
    assert not re.search("Traceback|Error:", stage.log.read_text()[said:])
