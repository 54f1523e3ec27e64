"""Requirements in a real window: verdicts follow a dragged sensor, and name what it loses."""

import threading

from tests.blender.test_live import NAME

EFFECT_TIMEOUT_S = 120
PRESETS = ("r158_detection", "ncap26_reverse_static", "ncap26_forward_child", "park_aid_rear")
LOST = {"Behind, detection", "Park aid, rear"}
"""What the camera alone meets; the LiDAR on the roof sees the children, who are tall."""
HELD = f"""
bpy.ops.pe.add_sensor(model="Camera 120 deg")
camera = bpy.context.object
camera.name, camera.location = "behind", (-2.6, 0.0, 1.3)
camera.rotation_euler = (0.0, 1.05, 3.14159)
for preset in {PRESETS!r}:
    bpy.ops.pe.add_row(rows="requirements", kind=preset)
window.scene.perception_entropy.requirement_index = 0
for each in ("beams", "frustums", "ground", "blind", "reach"):
    setattr(window.scene.perception_entropy.view, "show_" + each, False)
for each in window.scene.objects:
    each.select_set(each == camera, view_layer=window.view_layer)
window.view_layer.objects.active = camera
bpy.ops.ed.undo_push(message="held to requirements")
"""
READ = f"""
from {NAME}.overlay.layer_cache import shown_of
kept["legend"] = next((
    [item.shape.legend.title, [text for _, text in item.shape.legend.classes]]
    for item in shown_of(window.scene.name, "requirements").values()
    if hasattr(item.shape, "verdicts")
), ["", []])
"""


CHECK = f"""
from {NAME}.operators import running_job
settings = window.scene.perception_entropy
settings.view.show_requirements = False
bpy.ops.pe.add_row(rows="requirements", kind="ALL")
known = kept["known"] = []
def tick():
    known.append(sum(bool(row.verdict) for row in settings.requirements))
    return 0.01 if running_job.current is not None else None
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.pe.check_requirements("INVOKE_DEFAULT")
bpy.app.timers.register(tick)
"""
ROWS = """
import json
rows = window.scene.perception_entropy.requirements
kept["found"] = [json.loads(row.verdict) if row.verdict else None for row in rows]
"""


def legend(stage):
    """The title and the lines of the requirements' legend in the 3D view."""
    title, lines = stage.do(READ, redraw=False)["legend"]
    return title, lines


def wait_for_title(stage, title):
    """Wait for a legend with that title; return its lines."""
    stage.wait_for(lambda: legend(stage)[0] == title, EFFECT_TIMEOUT_S, f"{title!r}")
    return legend(stage)[1]


def named(lines, news):
    """Names of requirements that the legend says are lost, or won."""
    return {line.removeprefix(news) for line in lines if line.startswith(news)}


def dragged(stage, moves):
    """Work the mouse in a thread of its own; return the titles that are shown meanwhile."""
    steps = ("mousemove_relative", "--", 3, -2, "sleep", 0.05)
    thread = threading.Thread(target=stage.mouse, args=steps * moves)
    titles = []
    thread.start()
    while thread.is_alive():
        titles.append(legend(stage)[0])
    thread.join()
    return titles


def test_verdicts_follow_a_turned_camera_and_a_check_of_all_is_ended_by_esc(stage, screenshots):
    """A mouse moves the camera behind; then keys turn it aside, and Ctrl+Z turns it back."""
    stage.do(HELD)
    wait_for_title(stage, "4 of 4 requirements met")
    stage.point_at_view()
    stage.key("g")
    titles = dragged(stage, 60)
    assert any(title.endswith(" requirements met, preview") for title in titles), titles
    stage.key("Escape")
    wait_for_title(stage, "4 of 4 requirements met")

    stage.key("r", "z", "9", "0")
    lines = wait_for_title(stage, "2 of 4 requirements met")  # it is not let go yet
    assert named(lines, "lost: ") == LOST and not named(lines, "won: ")
    stage.photograph(screenshots / "window_requirements_lost.png")
    stage.key("Return")
    stage.settle()
    title, lines = legend(stage)
    assert title == "2 of 4 requirements met" and named(lines, "lost: ") == LOST

    stage.point_at_view()
    stage.key("ctrl+z")
    lines = wait_for_title(stage, "4 of 4 requirements met")
    assert named(lines, "won: ") == LOST and not named(lines, "lost: ")
    stage.photograph(screenshots / "window_requirements_won.png")

    # A check of all presets leaves the window free, and Esc keeps what it found.
    stage.point_at_view()
    stage.do(CHECK)
    running = f"__import__('{NAME}.operators.running_job', fromlist=['current']).current"
    known = "sum(bool(row.verdict) for row in window.scene.perception_entropy.requirements)"
    stage.wait_until(f"{known} > 0 or {running} is None", EFFECT_TIMEOUT_S)
    stage.key("Escape")
    stage.wait_until(f"{running} is None", EFFECT_TIMEOUT_S)
    stage.photograph(screenshots / "window_check.png")
    answer = stage.do(ROWS)
    assert len(answer["known"]) > 10, "the window stood still"
    assert any(count > 0 for count in answer["known"][:-1]), "verdicts come while it runs"
    assert any(answer["found"]), "Esc keeps what is known"
    assert "Traceback" not in stage.log.read_text()
