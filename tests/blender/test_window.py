"""The extension in a real window: the sidebar is worked with a real mouse."""

import math

EFFECT_TIMEOUT_S = 20
SCORE_TIMEOUT_S = 180


def test_add_a_sensor_and_score(window, screenshots):
    before = len(window.state["sensors"])
    window.press("pe.add_sensor")
    window.wait_for(
        lambda: len(window.state["sensors"]) == before + 1, EFFECT_TIMEOUT_S, "a new sensor"
    )

    assert not window.state["has_result"], "a result that nobody asked for"
    window.press("pe.score")
    window.wait_for(lambda: window.state["has_result"], SCORE_TIMEOUT_S, "a score")
    window.screenshot(screenshots / "window_score.png")

    assert math.isfinite(window.state["entropy"])
    assert 0.0 <= window.state["coverage"] <= 1.0
    assert "Traceback" not in window.log.read_text()
