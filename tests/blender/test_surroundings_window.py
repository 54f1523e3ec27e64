"""The road and its test bodies in a real window: a body that is grabbed is counted as it moves."""

EFFECT_TIMEOUT_S = 60
SEEN = (
    "__import__('bl_ext.user_default.perception_entropy.body_query', fromlist=['seen'])"
    ".seen(bpy.context.window_manager.windows[0].scene)"
)
CHILD = f"kept['child'] = {SEEN}['child'].to_dict()"


def test_a_grabbed_body_says_what_sees_it_while_it_moves(window, screenshots):
    window.do("window.scene.perception_entropy.panels = 'ALL'")
    window.do("bpy.ops.pe.surroundings()")
    window.wait_until(f"len({SEEN}) == 6", EFFECT_TIMEOUT_S)
    window.do("look = area.spaces.active.region_3d; look.view_distance = 22.0")
    window.settle()
    window.screenshot(screenshots / "window_surroundings.png")
    before = window.do(CHILD)["child"]
    x, y = before["place"]
    window.click(*window.place_of((x, y, 0.5)))
    window.key("g")
    start = window.place_of((x, y, 0.5))
    for step in range(1, 9):
        window.point_at(start[0] - 10 * step, start[1] + 6 * step)
        window.rest(0.1)
    window.wait_until(f"{SEEN}['child'].standing.place[0] != {x!r}", EFFECT_TIMEOUT_S)
    held = window.do(CHILD, redraw=False)["child"]
    window.photograph(screenshots / "window_surroundings_grabbed.png")
    assert held["sensors"] != before["sensors"]
    window.press_button()
    window.key("ctrl+z")
    window.wait_until(f"{SEEN}['child'].standing.place[0] == {x!r}", EFFECT_TIMEOUT_S)
    assert window.do(CHILD)["child"] == before
    assert "Traceback" not in window.log.read_text()
