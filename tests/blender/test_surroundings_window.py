"""The road and its test bodies in a real window: a body that is grabbed is counted as it moves."""

import subprocess

import pytest

EFFECT_TIMEOUT_S = 60
SEEN = (
    "__import__('bl_ext.user_default.perception_entropy.queries.body_query', fromlist=['seen'])"
    ".seen(bpy.context.window_manager.windows[0].scene)"
)
CHILD = f"kept['child'] = {SEEN}['child'].to_dict()"
OURS = "__import__('bl_ext.user_default.perception_entropy.{}', fromlist=['*'])"
PICTURES = OURS.format("operators.camera_pictures")
STRIP = OURS.format("operators.camera_strip")
GROUND = OURS.format("overlay.layer_cache") + ".shown_of(window.scene.name, 'birds_eye')"
BOX = f"""
name = {OURS.format("operators.birds_eye")}.PLATE_NAME
main = next(each for each in area.regions if each.type == "WINDOW")
kind = {OURS.format("view.plates")}.BIRDS_EYE
((left, bottom, right, top),) = {OURS.format("view.viewport")}.plate_boxes(main.as_pointer(), kind)
kept["box"] = [main.x + left, window.height - main.y - top, right - left, top - bottom]
kept["taken"] = sorted(key.name for key in {PICTURES}.rendered if key.plate == name)
"""
THREE = """
for name, place, turn in (
    ("front", (0.6, 0.0, 1.35), 0.0),
    ("left", (0.8, 0.95, 1.0), 1.57),
    ("rear", (-2.5, 0.0, 1.0), 3.14),
):
    bpy.ops.pe.add_sensor(model="Camera 120 deg")
    made = bpy.context.object
    made.name, made.location, made.rotation_euler = name, place, (0.0, 0.25, turn)
view = window.scene.perception_entropy.view
view.show_cameras, view.show_ground = True, False
bpy.ops.pe.surroundings()
"""
WHERE = f"""
((region, drawn),) = {STRIP}._in_strip.items()
kept["names"], box = [name for name, _ in drawn], dict(drawn)["left"]
main = next(each for each in area.regions if each.type == "WINDOW")
kept["at"] = [main.x + (box[0] + box[2]) / 2, window.height - main.y - (box[1] + box[3]) / 2]
"""
REDRAWN = f"""
pictures = {PICTURES}
view = window.scene.perception_entropy.view
def redraw():
    bpy.ops.wm.redraw_timer(type="DRAW_WIN", iterations=1)
kept["left"] = []
for _ in range(14):
    pictures.note_change()
    redraw()
    pictures.render_requested()
    kept["left"].append(len(pictures.requested))
view.show_cameras = view.show_birds_eye = False
redraw()
kept["kept"] = len(pictures.rendered)
"""


@pytest.mark.thorough
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


def colors_in(picture, box) -> int:
    """Return the number of colours of a part (left, top, width, height) of a picture."""
    left, top, width, height = map(round, box)
    part = f"{width}x{height}+{left}+{top}"
    command = ["convert", picture, "-crop", part, "-format", "%k", "info:"]
    return int(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def test_a_click_on_a_picture_of_the_strip_looks_through_its_camera(window, screenshots):
    window.do(THREE)
    window.wait_until(f"len({PICTURES}.rendered) == 3", EFFECT_TIMEOUT_S)
    window.settle()
    window.screenshot(screenshots / "window_strip.png")
    told = window.do(WHERE)
    assert told["names"] == ["front", "left", "rear"]
    window.click(*map(round, told["at"]))
    window.wait_until(
        "window.scene.camera and window.scene.camera.parent.name == 'left'", EFFECT_TIMEOUT_S
    )
    window.settle()
    window.screenshot(screenshots / "window_strip_through.png")
    window.do("bpy.ops.pe.look_back()")
    window.do("window.scene.perception_entropy.view.show_birds_eye = True")
    window.wait_until(GROUND, EFFECT_TIMEOUT_S)
    window.do("pass")  # with the mouse aside, 5.2 draws when it is told to
    window.wait_until(f"len({PICTURES}.rendered) == 7", EFFECT_TIMEOUT_S)
    window.settle()
    shown = screenshots / "window_birds_eye.png"
    window.photograph(shown)
    plate = window.do(BOX)
    assert plate["taken"] == ["", "front", "left", "rear"]
    assert colors_in(shown, plate["box"]) > 500, "the road and the vehicle, in shades"
    redrawn = window.do(REDRAWN)
    assert set(redrawn["left"]) == {6} and redrawn["kept"] == 0, "one a redraw, in turn"
    assert "Traceback" not in window.log.read_text()
