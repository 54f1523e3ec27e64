"""Variants and a place asked about, in a real window: by clicks and keys alone."""

from tests.blender.stage import HEIGHT, WIDTH

EFFECT_TIMEOUT_S = 120
ANSWER_TIMEOUT_S = 90


def test_save_move_come_back_and_ask_the_ground_by_clicks(window, screenshots):
    start = window.state["places"]
    window.press_until(
        "pe.save_variant", lambda: window.state["variants"] == ["Variant"], "a variant"
    )
    assert not window.state["variant_changed"]

    window.press("pe.select_sensor")
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
    window.click(WIDTH // 2, HEIGHT - HEIGHT // 6)  # it goes on asking
    window.wait_for(lambda: window.state["answer"] != first, ANSWER_TIMEOUT_S, "another answer")
    window.screenshot(screenshots / "window_place.png")

    window.point_at_view()
    window.key("Escape")
    second = window.state["answer"]
    assert second != first
    assert "Traceback" not in window.log.read_text()
