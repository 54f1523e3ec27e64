"""Variants, a place asked about and what fixes it, in a real window: by clicks and keys alone."""

import pytest

from tests.blender.stage import HEIGHT, WIDTH

EFFECT_TIMEOUT_S = 120
ANSWER_TIMEOUT_S = 90
OFFERS = (
    "__import__('bl_ext.user_default.perception_entropy.queries.where_map', fromlist=['offers'])"
    ".offers.get(bpy.context.window_manager.windows[0].scene.name)"
)
ADDON = "bl_ext.user_default.perception_entropy"
MODE = f"__import__('{ADDON}.operators.modes', fromlist=['current']).current"
BLIND = (0.4, 1.7, 0.0)
PROMISED = f"""
own = {OFFERS}.found
kept["number"] = [each.added for each in own].index(True)
kept["at"] = [list(each.rig[each.moved[0]].pose.position) for each in own]
kept["moved"] = [each.moved[0] for each in own]
"""


@pytest.mark.thorough
def test_save_move_come_back_ask_the_ground_and_mend_what_is_blind_by_clicks(window, screenshots):
    start = window.state["places"]
    window.press_until(
        "pe.save_variant", lambda: window.state["variants"] == ["Variant"], "a variant"
    )
    assert not window.state["variant_changed"]

    window.press("pe.select_object")
    window.point_at_view()
    window.key("g", "x", "1", "Return")
    window.wait_for(lambda: window.state["places"] != start, EFFECT_TIMEOUT_S, "the move")
    moved = window.state["places"]
    window.wait_for(lambda: window.state["variant_changed"], EFFECT_TIMEOUT_S, "the mark")
    window.screenshot(screenshots / "window_variant_changed.png")

    window.scroll_sidebar()  # the way back stands below the list
    window.press_until("pe.switch_variant", lambda: window.state["places"] == start, "the way back")
    window.wait_for(
        lambda: window.state["variants"] == ["Variant", "Unsaved"],
        EFFECT_TIMEOUT_S,
        "what was not saved to be kept",
    )
    window.screenshot(screenshots / "window_variants.png")

    window.point_at_view()
    window.key("ctrl+z")
    window.wait_for(lambda: window.state["places"] == moved, EFFECT_TIMEOUT_S, "undo in one step")
    assert window.state["variants"] == ["Variant"]

    window.press("pe.ask_place")
    window.click(WIDTH // 4, HEIGHT - HEIGHT // 4)
    window.wait_for(lambda: window.state["answer"], ANSWER_TIMEOUT_S, "an answer")
    first = window.state["answer"]
    assert "up: seen by" in first[0]
    assert any(name in line for line in first for name in window.state["sensors"])
    window.click(*window.place_of(BLIND))  # it goes on asking
    window.wait_for(lambda: window.state["answer"] != first, ANSWER_TIMEOUT_S, "another answer")
    window.screenshot(screenshots / "window_place.png")
    second = window.state["answer"]
    window.point_at_view()
    window.key("Escape")
    window.wait_until(f"{MODE} is None")
    assert not window.state["running"], "what would fix it waits until it is asked"
    window.press("pe.suggest")
    window.wait_until(f"{OFFERS} and {OFFERS}.found", EFFECT_TIMEOUT_S)
    window.screenshot(screenshots / "window_suggest.png")
    assert window.state["answer"] == second != first

    before = window.state["sensors"]
    told = window.do(PROMISED)
    words = f"number={told['number']}" if told["number"] else ""  # else the first button
    window.press("pe.take_suggestion", words)
    window.wait_for(
        lambda: len(window.state["sensors"]) == len(before) + 1, EFFECT_TIMEOUT_S, "the sensor"
    )
    (added,) = set(window.state["sensors"]) - set(before)
    place = zip(window.state["places"][added], told["at"][told["number"]], strict=False)
    assert max(abs(a - b) for a, b in place) < 1e-4
    window.screenshot(screenshots / "window_suggest_taken.png")
    window.point_at_view()
    window.key("ctrl+z")
    window.wait_for(lambda: window.state["sensors"] == before, EFFECT_TIMEOUT_S, "undo")
    assert "Traceback" not in window.log.read_text()
