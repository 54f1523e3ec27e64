"""The extension in a real window: the sidebar is worked with a real mouse."""

import math

EFFECT_TIMEOUT_S = 120
SCORE_TIMEOUT_S = 180


def test_add_score_and_optimize_beside_the_window_esc_keeps_the_best_and_undo_brings_back(
    window, screenshots
):
    before = len(window.state["sensors"])
    window.press_until(
        "pe.add_sensor", lambda: len(window.state["sensors"]) == before + 1, "a new sensor"
    )

    assert not window.state["has_result"], "a result that nobody asked for"
    window.press_until("pe.score", lambda: window.state["has_result"], "a score")
    window.screenshot(screenshots / "window_score.png")

    assert math.isfinite(window.state["entropy"])
    assert 0.0 <= window.state["coverage"] <= 1.0

    start = window.state["places"]
    window.press_until("pe.optimize", lambda: window.state["running"], "the search to start")
    window.wait_for(lambda: window.state["better_found"], SCORE_TIMEOUT_S, "a better placement")
    window.screenshot(screenshots / "window_optimize.png")
    assert window.state["running"], "the search was over before anyone could press Esc"

    window.point_at_view()
    window.key("ctrl+z")
    assert window.state["running"] and window.state["places"] == start
    window.key("Escape")
    window.wait_for(lambda: window.state["places"] != start, EFFECT_TIMEOUT_S, "the best so far")
    window.wait_for(lambda: not window.state["running"], SCORE_TIMEOUT_S, "the search to stop")
    window.wait_for(lambda: window.state["kind"] == "optimize", EFFECT_TIMEOUT_S, "a result")
    assert window.state["places"] != start, "the best so far was not kept"

    window.key("ctrl+z")
    window.wait_for(lambda: window.state["places"] == start, EFFECT_TIMEOUT_S, "the old placement")
    assert len(window.state["variants"]) == 2, "undo has lost what the search found"
    assert "Traceback" not in window.log.read_text()
