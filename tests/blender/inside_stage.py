"""Run inside Blender's window: does what Python from outside asks, through files.

``do.py`` is run once and taken away; ``done.json`` says how it went. All that the windowed tests
report is reported, too.
"""

import json
import sys
import traceback
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))

from inside_window import FOLDER, start_again, view3d, write  # sets the window up

POLL_S = 0.05
KEPT = {}
"""What one piece of code keeps for the next, and for those who asked."""


def obey():
    """Run what is asked for, in the first 3D view's context; a file dialog may fill the window."""
    asked = FOLDER / "do.py"
    if not asked.exists():
        return POLL_S
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
            names = {"bpy": bpy, "kept": KEPT, **place}
            names["start_again"] = start_again
            exec(compile(code, "do.py", "exec"), names)
        if names["redraw"]:
            for each in place["window"].screen.areas:
                each.tag_redraw()
    except Exception:
        problem = traceback.format_exc()
    write("done.json", json.dumps({"problem": problem, "kept": KEPT}, default=str))
    return POLL_S


bpy.app.timers.register(obey, first_interval=POLL_S, persistent=True)
