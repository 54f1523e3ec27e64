"""Run inside Blender's window: lays the screen out for the test and reports through files.

``ready.json``   once our tab of the sidebar has been drawn: where the sidebar is
``drawn.json``   again and again: what time it is, and when something was last drawn
``..._answer.json``   where the button is that ``button.json`` asks for, and other answers
``state.json``   again and again: what the scene holds
``copied.txt``   what was copied by Ctrl+C, which tells the button under the mouse
``done.json``    how the Python went that ``do.py`` asked for, once
"""

import json
import math
import sys
import time
import traceback
from pathlib import Path

import bpy
from bl_ext.user_default.perception_entropy.live import state
from bl_ext.user_default.perception_entropy.operators import placement, running_job
from bl_ext.user_default.perception_entropy.queries import location_query
from mathutils import Euler

FOLDER = Path(sys.argv[-1])
CATEGORY = "Perception"
VIEW_CENTER_M = (0.0, -0.6, 0.7)
VIEW_DISTANCE_M = 9.0
VIEW_ROTATION = (math.radians(66.0), 0.0, math.radians(128.0))
STEP_S = 0.1
REPORT_S = 0.1
TURN_S = 0.01
IDLE_S = 0.05
ROW_STEP = 18
"""A button is 20 pixels high at this scale: smaller steps cannot miss one."""
COLUMNS = (0.7, 0.25, 0.45)
"""Where to look in a row: its middle may be the gap between two buttons."""
KEPT = {}
"""What one piece of code keeps for the next, and for those who asked."""


def write(name, document):
    """Write a file of which a reader never sees half."""
    partial = FOLDER / f"{name}.partial"
    partial.write_text(document if isinstance(document, str) else json.dumps(document))
    partial.replace(FOLDER / name)


def view3d():
    """Return window, area and sidebar of the first 3D view."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    return window, area, next(region for region in area.regions if region.type == "UI")


def fill_the_window():
    """First step: one large 3D view with its sidebar."""
    window, area, _ = view3d()
    window.scene.perception_entropy.result_json = ""  # the file may come with one
    look = area.spaces.active.region_3d
    look.view_location = VIEW_CENTER_M
    look.view_distance = VIEW_DISTANCE_M
    look.view_rotation = Euler(VIEW_ROTATION).to_quaternion()
    with bpy.context.temp_override(window=window, area=area):
        bpy.ops.screen.screen_full_area()
    bpy.app.timers.register(show_sidebar, first_interval=STEP_S)


def start_again(blend):
    """Load a file in place of what is shown, and lay the window out as at the start."""

    def load():
        for other in bpy.context.window_manager.windows[1:]:  # a picture's, before the sidebar
            with bpy.context.temp_override(window=other):
                bpy.ops.wm.window_close()
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            bpy.ops.wm.open_mainfile(filepath=blend)
        bpy.app.timers.register(fill_the_window, first_interval=STEP_S, persistent=True)

    bpy.app.timers.register(load, first_interval=REPORT_S)


def show_sidebar():
    """Second step, after the new layout was drawn."""
    view3d()[1].spaces.active.show_region_ui = True
    bpy.app.timers.register(show_tab, first_interval=STEP_S)


def show_tab():
    """Third step: the tab exists only after the sidebar was drawn; ask until it does."""
    _, area, sidebar = view3d()
    try:
        sidebar.active_panel_category = CATEGORY
    except (AttributeError, TypeError):
        return STEP_S
    area.tag_redraw()
    bpy.app.timers.register(say_ready, first_interval=STEP_S)


def say_ready():
    """Last step: where the sidebar is, counted from the top left as X does."""
    window, _, sidebar = view3d()
    if sidebar.active_panel_category != CATEGORY:
        return STEP_S
    top = window.height - (sidebar.y + sidebar.height)
    report_state()
    place = {"left": sidebar.x, "top": top, "width": sidebar.width, "bottom": top + sidebar.height}
    write("ready.json", {"sidebar": place})


def report_state():
    """Write what the scene holds, again and again."""
    scene = bpy.context.window_manager.windows[0].scene
    if not hasattr(scene, "perception_entropy"):  # the extension is switched off
        return REPORT_S
    if not any(
        area.type == "VIEW_3D" for area in bpy.context.window_manager.windows[0].screen.areas
    ):
        return REPORT_S  # a file dialog fills the window
    found = scene.perception_entropy
    sensors = [each for each in scene.objects if each.perception_entropy.is_sensor]
    state = {
        "sensors": [each.name for each in sensors],
        "places": {each.name: list(each.matrix_world.translation) for each in sensors},
        "running": running_job.current is not None,
        "better_found": running_job.current is not None and better_found(running_job.current.seen),
        "kind": found.result and found.result.kind,
        "has_result": found.has_result,
        "entropy": found.result and found.result.entropy,
        "coverage": found.result and found.result.coverage,
        "stale": found.result_stale,
        "live": live_reading(scene),
        "variants": [row.name for row in found.variants],
        "variant_changed": found.variant_changed,
        "answer": answer_of(scene),
    }
    held = placement.current
    state |= {
        "placing": held is not None,
        "held": pose_of(held.matrix) if held and held.matrix else None,
        "preview": held.score if held else "",
        "camera": scene.camera.name if scene.camera else None,
        "perspective": view3d()[1].spaces.active.region_3d.view_perspective,
        "view": view_seen(),
        "own_results": [s.name for s in sensors if found.result and s.name in found.result.sensors],
    }
    write("state.json", state)
    report_copied()
    return REPORT_S


def live_reading(scene):
    """What the live score says of the scene."""
    reading = state.live_state(scene.name).score
    said = {"on": scene.perception_entropy.live.on, "note": state.live_state(scene.name).note}
    if reading is None:
        return said
    summary = reading.summary
    before = None if reading.before is None else reading.before.entropy
    return {
        **said,
        "entropy": summary.entropy,
        "coverage": summary.coverage,
        "rested": state.live_state(scene.name).is_current(reading),
        "number": reading.number,
        "before": before,
    }


def view_seen():
    """How the 3D view looks at the scene."""
    look = view3d()[1].spaces.active.region_3d
    numbers = [*look.view_rotation, *look.view_location, look.view_distance]
    return {
        "perspective": look.view_perspective,
        "along_axis": look.is_orthographic_side_view,
        "numbers": numbers,
    }


def pose_of(matrix):
    """Return a placement as x, y, z and angles."""
    return [*matrix.translation, *matrix.to_euler()]


def answer_of(scene):
    """Lines that are told of the place that was asked about."""
    answer = location_query.answer(scene)
    return [] if answer is None else list(answer.lines)


def better_found(job):
    """Whether a search has found a placement better than the start."""
    return len(getattr(job, "history", ())) > 1


def report_answers():
    """Answer the requests there are: one turn of each answer at each call."""
    for what, answer in (("button", look_for_button), ("turns", count_turns)):
        asked = FOLDER / f"{what}.json"
        if asked.exists():
            request = json.loads(asked.read_text())
            asked.unlink()
            answers[what] = answer(**request)
    for what, answer in list(answers.items()):
        try:
            next(answer)
        except StopIteration as ended:
            del answers[what]
            write(f"{what}_answer.json", ended.value)
    return TURN_S if answers else IDLE_S


def count_turns(count):
    """Let Blender handle the events that came before: it does so once a turn."""
    for _ in range(count):
        yield
    return {}


def look_for_button(operator, words, first):
    """Move the mouse down the sidebar until the button under it calls the operator.

    Blender does not tell scripts where its buttons are, but whether one is under the mouse, and its
    Python call.
    """
    call = f"bpy.ops.{operator}("
    window, area, sidebar = view3d()
    for x, y in [*first, *sidebar_places(window, sidebar)]:
        window.cursor_warp(x, window.height - y)
        yield  # the move is an event of the next turn, which runs timers before it
        yield
        with bpy.context.temp_override(window=window, area=area, region=sidebar):
            said = copied_call()
        if call in said and words in said:
            return {"place": [x, y]}
    return {"place": None}


def sidebar_places(window, sidebar):
    """Yield places in the sidebar from its top down, column by column; y from the window's top.

    A button that is cut by the sidebar's end is none: there a click takes the editor's edge.
    """
    top = window.height - (sidebar.y + sidebar.height)
    for column in COLUMNS:
        for y in range(top + ROW_STEP, top + sidebar.height - ROW_STEP, ROW_STEP):
            yield round(sidebar.x + column * sidebar.width), y


def copied_call():
    """Return the Python call of the button under the mouse, "" where there is none."""
    if not bpy.ops.ui.copy_python_command_button.poll():
        return ""
    bpy.ops.ui.copy_python_command_button()
    manager = bpy.context.window_manager
    said = manager.clipboard
    manager.clipboard = ""
    return said


answers = {}
"""Generators that find the answers to requests, by what they are about."""
drawn_at = time.monotonic()


def note_drawing():
    """Remember when something was drawn."""
    global drawn_at
    drawn_at = time.monotonic()


def report_drawing():
    """Tell when something was last drawn."""
    write("drawn.json", {"now": time.monotonic(), "drawn": drawn_at})
    return REPORT_S


def report_copied():
    """Hand over what Ctrl+C copied, once."""
    manager = bpy.context.window_manager
    if copied := manager.clipboard:
        manager.clipboard = ""
        write("copied.txt", copied)


def obey():
    """Run what is asked for, in the first 3D view's context; a file dialog may fill the window."""
    asked = FOLDER / "do.py"
    if not asked.exists():
        return IDLE_S
    code = asked.read_text()
    asked.unlink()
    problem = ""
    try:
        place = {"window": bpy.context.window_manager.windows[0]}
        if any(area.type == "VIEW_3D" for area in place["window"].screen.areas):
            _, area, _ = view3d()
            region = next(each for each in area.regions if each.type == "WINDOW")
            place |= {"area": area, "region": region}
        with bpy.context.temp_override(**place):
            names = {"bpy": bpy, "kept": KEPT, "start_again": start_again, **place}
            exec(compile(code, "do.py", "exec"), names)
        if names["redraw"]:
            for each in place["window"].screen.areas:
                each.tag_redraw()
    except Exception:
        problem = traceback.format_exc()
    write("done.json", json.dumps({"problem": problem, "kept": KEPT}, default=str))
    return IDLE_S


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(fill_the_window, first_interval=STEP_S, persistent=True)
for report in (report_state, report_drawing, report_answers, obey):
    bpy.app.timers.register(report, first_interval=STEP_S, persistent=True)
for space in (bpy.types.SpaceView3D, bpy.types.SpaceFileBrowser):
    for kind in ("WINDOW", "UI") if space is bpy.types.SpaceView3D else ("WINDOW",):
        space.draw_handler_add(note_drawing, (), kind, "POST_PIXEL")
