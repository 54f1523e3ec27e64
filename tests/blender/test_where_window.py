"""*Where?* in a real window: colours on the body, and a click that places the sensor."""

from tests.blender.stage import WIDTH

EFFECT_TIMEOUT_S = 60
PLACES_TIMEOUT_S = 150
FOUND = (
    "__import__('bl_ext.user_default.perception_entropy.queries.where_map', fromlist=['maps'])"
    ".maps.get(bpy.context.window_manager.windows[0].scene.name)"
)
ADDON = "bl_ext.user_default.perception_entropy"
MODE = f"__import__('{ADDON}.operators.modes', fromlist=['current']).current"
NEAREST = f"""
found = {FOUND}
look = area.spaces.active.region_3d.view_matrix.inverted().translation
free = [each for each in found.places if each.value is not None]
seen = min(free, key=lambda each: sum((a - b) ** 2 for a, b in zip(each.point, look)))
kept["point"], kept["at"] = list(seen.point), list(seen.pose.position)
"""


def test_the_body_is_coloured_and_a_click_places_the_sensor(window, screenshots):
    before = window.state["sensors"]
    window.do('bpy.context.window_manager.operator_properties_last("pe.where").places = 400')
    window.press("pe.where")
    window.settle()
    window.point_at(WIDTH - 270, 213)  # the dialog's title: over a field Return would edit it
    window.mouse("key", "Return")
    window.wait_until(f"{FOUND} and {FOUND}.error is not None", PLACES_TIMEOUT_S)
    window.screenshot(screenshots / "window_where.png", aside=False)

    window.wait_until(f"{MODE} is None")  # it begins by its button
    window.press("pe.take_place")
    window.wait_until(f"{MODE} is not None")
    window.point_at_view()
    window.key("g")  # another tool ends it
    window.wait_until(f"{MODE} is None")
    window.key("Escape")
    window.press("pe.take_place")
    window.wait_until(f"{MODE} is not None")
    near = window.do(NEAREST)
    window.hover(*window.place_of(tuple(near["point"])))
    window.screenshot(screenshots / "window_pick_a_place.png", aside=False)
    window.click(*window.place_of(tuple(near["point"])))
    window.wait_for(
        lambda: len(window.state["sensors"]) == len(before) + 1, EFFECT_TIMEOUT_S, "the sensor"
    )
    (added,) = set(window.state["sensors"]) - set(before)
    assert (
        max(abs(a - b) for a, b in zip(window.state["places"][added], near["at"], strict=True))
        < 0.5
    )
    window.wait_until(f"{MODE} is None")
    window.point_at_view()
    window.key("ctrl+z")
    window.wait_for(lambda: window.state["sensors"] == before, EFFECT_TIMEOUT_S, "undo")
    assert "Traceback" not in window.log.read_text()
