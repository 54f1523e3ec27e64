"""What would mend it, in a real window: a click on blind ground, ghosts, one click takes it."""

EFFECT_TIMEOUT_S, FOUND_TIMEOUT_S = 60, 120
OFFERS = (
    "__import__('bl_ext.user_default.perception_entropy.where_map', fromlist=['offers'])"
    ".offers.get(bpy.context.window_manager.windows[0].scene.name)"
)
BLIND = (0.4, 1.7, 0.0)
PROMISED = f"""
own = {OFFERS}.found
kept["number"] = [each.added for each in own].index(True)
kept["at"] = [list(each.rig[each.moved[0]].pose.position) for each in own]
kept["moved"] = [each.moved[0] for each in own]
"""


def test_a_click_on_blind_ground_tells_what_mends_it_and_one_click_takes_it(window, screenshots):
    before = window.state["sensors"]
    window.press("pe.ask_place")
    window.settle()
    window.click(*window.place_of(BLIND))
    window.wait_until(f"{OFFERS} and {OFFERS}.found", FOUND_TIMEOUT_S)
    window.key("Escape")
    window.screenshot(screenshots / "window_suggest.png")

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
