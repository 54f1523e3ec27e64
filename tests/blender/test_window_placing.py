"""Sensors placed with a real mouse: pointing at the car, clicking, going on, leaving."""

import math

import pytest

EFFECT_TIMEOUT_S = 120
ROOF = (-0.4, 0.0, 1.45)
HOOD = (1.5, 0.0, 0.9)
GROUND = (0.0, -6.0, 0.0)
"""Places of the sedan, nearly, and one beside it [m]."""
YAW = "kept['angles'] = list(bpy.data.objects['roof_lidar'].rotation_euler)"


def sensors(window):
    return set(window.state["sensors"])


def over(window, point):
    """Move the mouse to a point of the scene."""
    window.hover(*window.place_of(point))


def start(window):
    """Press the button and hold a sensor over the roof, until it is there."""
    window.press_until("pe.place_sensor", lambda: window.state["placing"], "a sensor to place")
    over(window, ROOF)
    held_at(window, lambda place: place is not None and place[2] > 1.4)


def held_at(window, condition):
    """Wait until the sensor that is held stands where it should."""
    window.wait_for(lambda: condition(window.state["held"]), EFFECT_TIMEOUT_S, "the sensor there")


def test_a_click_places_what_is_held_shift_goes_on_esc_leaves_and_undo_takes_each_back(
    window, screenshots
):
    before = sensors(window)
    start(window)
    window.wait_for(lambda: "nats" in window.state["preview"], EFFECT_TIMEOUT_S, "a preview")
    window.screenshot(screenshots / "window_placing.png", aside=False)
    upright = window.state["held"]
    window.key("n")
    held_at(window, lambda place: place != upright)
    window.key("n")
    held_at(window, lambda place: place == upright)
    window.key("bracketright")
    held_at(window, lambda place: place[2] == pytest.approx(upright[2] + 0.01, abs=2e-3))
    assert sensors(window) == before, "a sensor before the click"

    held = window.state["held"]
    window.press_button()
    window.wait_for(lambda: len(sensors(window)) == len(before) + 1, EFFECT_TIMEOUT_S, "a sensor")
    (name,) = sensors(window) - before
    window.wait_for(
        lambda: math.dist(window.state["places"][name], held[:3]) < 0.01,
        EFFECT_TIMEOUT_S,
        "the sensor where it was held",
    )
    assert not window.state["placing"]

    window.key("ctrl+z")
    window.wait_for(lambda: sensors(window) == before, EFFECT_TIMEOUT_S, "one undo step")

    start(window)
    for number, place in enumerate((ROOF, HOOD), start=1):
        with window.holding("shift"):
            window.click(*window.place_of(place))
            window.wait_for(
                lambda more=number: len(sensors(window)) == len(before) + more,
                EFFECT_TIMEOUT_S,
                "one more",
            )
        assert window.state["placing"], "Shift was to go on"
    over(window, GROUND)
    held_at(window, lambda place: place is None)
    window.key("Escape")
    window.wait_for(lambda: not window.state["placing"], EFFECT_TIMEOUT_S, "the end")
    assert len(sensors(window)) == len(before) + 2

    window.key("ctrl+z")
    window.wait_for(lambda: len(sensors(window)) == len(before) + 1, EFFECT_TIMEOUT_S, "one step")
    window.key("ctrl+z")
    window.wait_for(lambda: sensors(window) == before, EFFECT_TIMEOUT_S, "the other step")
    assert "Traceback" not in window.log.read_text()


def test_both_sides_a_typed_height_and_a_drag_along_the_surface(window, screenshots):
    before = sensors(window)
    start(window)
    over(window, (1.5, 0.5, 0.9))
    held_at(window, lambda place: place is not None and place[2] < 1.2)
    window.key("m")
    window.key("z")
    for key in ("1", "period", "2", "5"):
        window.key(key)
    held_at(window, lambda place: place[2] == pytest.approx(1.25))
    window.screenshot(screenshots / "window_both_sides.png", aside=False)
    window.press_button()
    window.wait_for(lambda: len(sensors(window)) == len(before) + 2, EFFECT_TIMEOUT_S, "two")
    one, other = (window.state["places"][name] for name in sensors(window) - before)
    assert one[:3] == pytest.approx((other[0], -other[1], other[2]), abs=1e-4)
    assert one[2] == pytest.approx(1.25)

    window.press_until(
        "pe.place_sensor",
        lambda: window.state["placing"],
        "the sensor to drag",
        words='sensor="LiDAR',
    )
    over(window, (-0.4, 0.03, 1.45))
    held_at(window, lambda place: place is not None and place[2] > 1.4)
    assert 0.0 < window.state["held"][1] < 0.1, "the magnet leaves linked mirror images apart"
    window.screenshot(screenshots / "window_drag_along.png", aside=False)
    window.press_button()
    window.wait_for(lambda: not window.state["placing"], EFFECT_TIMEOUT_S, "the end")
    window.screenshot(screenshots / "window_handles.png")
    assert len(sensors(window)) == len(before) + 2
    assert "Traceback" not in window.log.read_text()


def test_a_handle_turns_the_yaw_of_the_active_sensor_and_is_undone(window):
    x, y = window.place_of(tuple(window.state["places"]["roof_lidar"][:3]))
    for below in (18, 21, 24, 27, 30):  # the arc passes there
        window.drag((x, y + below), (x + 70, y + below - 14))
        window.settle()
        roll, pitch, yaw = window.do(YAW)["angles"]
        if yaw:
            break
    assert abs(yaw) > 0.1 and (roll, pitch) == pytest.approx((0.0, 0.0), abs=1e-5)
    window.point_at_view()
    window.key("ctrl+z")
    window.settle()
    assert window.do(YAW)["angles"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)


@pytest.mark.thorough
def test_look_through_a_camera_and_esc_comes_back(window, screenshots):
    before = sensors(window)
    window.do("bpy.context.scene.perception_entropy.kind_to_add = 'camera'")
    window.press_until(
        "pe.add_sensor", lambda: sensors(window) != before, "a sensor", words="Camera"
    )
    (name,) = sensors(window) - before
    window.point_at_view()
    window.key("KP_3")
    window.wait_for(lambda: window.state["view"]["along_axis"], EFFECT_TIMEOUT_S, "a side view")
    view = window.state["view"]
    window.press_until(
        "pe.look_through", lambda: window.state["perspective"] == "CAMERA", "its view"
    )
    assert window.state["camera"] == f"{name} view"
    window.screenshot(screenshots / "window_look_through.png")
    window.point_at_view()
    window.key("Escape")
    window.wait_for(lambda: window.state["camera"] is None, EFFECT_TIMEOUT_S, "the way back")
    seen = window.state["view"]
    assert (seen["perspective"], seen["along_axis"]) == ("ORTHO", True)
    assert seen["numbers"] == pytest.approx(view["numbers"], abs=1e-5)

    window.press_until(
        "pe.look_through", lambda: window.state["perspective"] == "CAMERA", "its view"
    )
    window.point_at_view()
    window.key("ctrl+z")
    window.wait_for(lambda: window.state["camera"] is None, EFFECT_TIMEOUT_S, "undo")
    window.wait_for(
        lambda: window.state["view"]["perspective"] == "ORTHO",
        EFFECT_TIMEOUT_S,
        "the view as it was",
    )
    assert window.state["view"]["numbers"] == pytest.approx(view["numbers"], abs=1e-5)
    assert "Traceback" not in window.log.read_text()
