"""What the add-on costs Blender's window, measured in a real one.

    python -m benchmarks.live_window [--suite sid] [--triangles 1000000] [CHECKOUT ...]

A Pandar64 of four sensors on the sedan is moved step by step, with *Live*, map, beams and blind
ground on; first with the extension disabled, for Blender's own time. Then requirements are checked
and a search is stopped by keys, while a timer looks how long the window stands still. Each checkout
is measured in turn; without one, this. No test: a busy machine only makes it slower, so the load is
told too.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import psutil

from tests.blender.runner import Blender, Installed
from tests.blender.stage import Stage

ROOT = Path(__file__).resolve().parents[1]
NAME = "bl_ext.user_default.perception_entropy"
STEPS = 40
STOPS = 3
DONE_S = 900
SET_UP = """
settings, view = window.scene.perception_entropy, window.scene.perception_entropy.view
for model, name, place, turn in (
    ("Camera 60 deg", "cam_front", (0.5, 0.0, 1.45), 0.0),
    ("Pandar40", "lidar_bumper", (2.35, 0.0, 0.6), 0.0),
    ("Camera 120 deg", "cam_left", (0.3, 1.0, 1.0), 1.5708),
):
    bpy.ops.pe.add_sensor(model=model)
    made = bpy.context.object
    made.name, made.location, made.rotation_euler.z = name, place, turn
view.show_ground = view.show_beams = view.show_blind = True
settings.live.on = settings.show_overlay = True
bpy.ops.pe.add_row(rows="requirements", kind="ALL")
"""
FINE = """
body = next(each for each in settings.vehicle.all_objects if each.type == "MESH")
cuts = body.modifiers.new("fine", "SUBSURF")
cuts.subdivision_type = "SIMPLE"
while len(body.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons) * 2 < {count}:
    cuts.levels += 1
    bpy.context.view_layer.update()
"""
WALK = """
import time
roof, steps = window.scene.objects["roof_lidar"], []
kept["steps"] = steps

def step(roof=roof, steps=steps, window=window, bpy=bpy, time=time, kept=kept):
    begun = time.perf_counter()
    roof.location.x += 0.01 if len(steps) % 20 < 10 else -0.01
    window.view_layer.update()
    moved = time.perf_counter()
    number = kept["asked"]() if "asked" in kept else 0
    with bpy.context.temp_override(window=window):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
    steps.append((begun, moved, time.perf_counter(), number))
    return 0.1 if len(steps) < {steps} else None

bpy.app.timers.register(step)
"""
SCORES = """
import time
from {name}.live import state
scores, drawn, put = [], [], state.LiveState.put
of = state.live_state(window.scene.name)
kept["scores"], kept["drawn"], kept["asked"] = scores, drawn, lambda: of.requests

def noted(self, score, put=put, scores=scores, time=time):
    put(self, score)
    scores.append((time.perf_counter(), score.number))

def draw(of=of, drawn=drawn, time=time):
    drawn.append((time.perf_counter(), of.score.number if of.score else 0))

state.LiveState.put = noted
bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL")
"""
PULSE = """
import time
pulse = [time.perf_counter()]
kept["pulse"] = pulse

def beat(pulse=pulse, time=time):
    pulse.append(time.perf_counter())
    return 0.01

bpy.app.timers.register(beat)
kept["stopped"] = None
"""
OPEN = """
import time
kept["scores"].clear()
kept["opened"] = None

def load(kept=kept, time=time, bpy=bpy):
    kept["opened"] = time.perf_counter()
    bpy.ops.wm.open_mainfile(filepath={blend!r})

bpy.app.timers.register(load, first_interval=0.1)
"""
JOBS = f"__import__('{NAME}.operators.running_job', fromlist=['*'])"
RUNNING = f"{JOBS}.current"
SCORE = f"__import__('{NAME}.live.state', fromlist=['*']).live_state(window.scene.name).score"
LAYERS = ("ground", "beams", "blind")
WAIT_END = f"""
import time
kept["freed"] = kept["ended"] = None

def look(kept=kept, time=time):
    if {RUNNING} is None and kept["freed"] is None:
        kept["freed"] = time.time()
    if {RUNNING} is None and not {JOBS}.stopped:
        kept["ended"] = time.time()
        return None
    return 0.005

bpy.app.timers.register(look)
"""


def main() -> int:
    """Measure, and print a line a figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--suite", default="trixie")
    parser.add_argument("--triangles", type=int, default=0, help="of the body, about")
    parser.add_argument("checkouts", nargs="*", type=Path, default=[ROOT])
    chosen = parser.parse_args()
    for checkout in chosen.checkouts:
        with tempfile.TemporaryDirectory() as folder:
            installed = install(chosen.suite, checkout.resolve(), Path(folder))
            print(f"{checkout}, load {psutil.getloadavg()[0]:.1f}")
            for name, figure in measured(installed, Path(folder), chosen.triangles).items():
                print(f"  {name:34s} {figure}")
    return 0


def install(suite: str, checkout: Path, folder: Path) -> Installed:
    """Build the extension of a checkout and install it into a user folder of its own."""
    finder = [sys.executable, ROOT / "tools" / "real_blender.py", "--suite", suite]
    (folder / "user").mkdir()
    compiled = {"PYTHONDONTWRITEBYTECODE": ""}  # as for who uses it: not anew at each start
    blender = Blender(said_by(finder), compiled).with_resources(folder / "user")
    built = said_by([sys.executable, checkout / "tools" / "build_extension.py"])
    command = ["extension", "install-file", "-r", "user_default", "--enable", built]
    blender.run(["--command", *command])
    return Installed(blender)


def said_by(command: Sequence[object]) -> str:
    """Return what a command prints."""
    answer = subprocess.run([*map(str, command)], capture_output=True, text=True, check=True)
    return answer.stdout.strip()


def measured(installed: Installed, folder: Path, triangles: int) -> dict[str, str]:
    """Return the figures of one extension."""
    screen = folder / "screen"
    screen.mkdir()
    stage = Stage(screen)
    found = dict[str, str]()
    try:
        stage.open(installed, ROOT / "blend_assets" / "sedan.blend")
        stage.do(SET_UP + (FINE.format(count=triangles) if triangles else ""))
        stage.wait_until(f"{SCORE} and {SCORE}.exact", DONE_S)
        stage.do("window.scene.perception_entropy.show_overlay = False")
        stage.do(f"import addon_utils; addon_utils.disable({NAME!r})")
        own = walked(stage)
        stage.do(
            f"import addon_utils; addon_utils.enable({NAME!r})\n{SET_UP.partition('view.')[0]}"
        )
        stage.do("settings = window.scene.perception_entropy\nsettings.show_overlay = True")
        stage.do("window.scene.perception_entropy.live.on = True")
        stage.do("".join(f"window.scene.perception_entropy.view.show_{n} = True\n" for n in LAYERS))
        stage.wait_until(f"{SCORE} and {SCORE}.exact", DONE_S)
        stage.do(SCORES.format(name=NAME))
        ours = walked(stage)
        scores = stage.do("pass")["scores"]
        drawn = stage.do("pass")["drawn"]
        redraws = [[end - moved for _, moved, end, _ in each] for each in (own, ours)]
        found["Blender's own redraw"], found["redraw with the extension"] = map(told, redraws)
        ratio = statistics.median(redraws[1]) / statistics.median(redraws[0])
        found["their medians' ratio"] = f"{ratio:.2f}"
        found["move, Blender's own"] = told([moved - begun for begun, moved, *_ in own])
        found["move with the extension"] = told([moved - begun for begun, moved, *_ in ours])
        found["move to its score"] = told(delays(ours, scores))
        found["move to the picture of its score"] = told(delays(ours, drawn))
        pictures = [min(at for at, _ in drawn if at > moved) for _, moved, *_ in ours]
        behind = zip(delays(ours, drawn), ours, pictures, strict=False)
        found["read-out behind the picture"] = told([d + s[1] - p for d, s, p in behind])
        stage.do(PULSE)
        stage.do("bpy.ops.pe.check_requirements('INVOKE_DEFAULT')")
        stage.wait_until(f"{RUNNING} is None", DONE_S)
        found["window still in a check, longest"] = longest(stage)
        stage.do(PULSE)
        stage.do("bpy.ops.pe.optimize('INVOKE_DEFAULT')")
        stage.wait_until(f"{RUNNING} and {RUNNING}.progress.evaluations > 20", DONE_S)
        found["window still in a search, longest"] = longest(stage)
        found["memory, with processes"] = memory(stage)
        stage.point_at_view()
        freed, ended = zip(*(stopped(stage) for _ in range(STOPS)), strict=True)
        found["Esc to a free window"] = told(freed)
        found["Esc to the result of the best"] = told(ended)
        found["opened file to its first score"] = told(
            [opened(stage, folder / f"moved{number}.blend") for number in range(STOPS)]
        )
    finally:
        stage.close()
    return found


def delays(steps: Sequence[Sequence[float]], came: Sequence[Sequence[float]]) -> list[float]:
    """Return how long after each move something of it, or of a later one, came first."""
    after = [[at for at, number in came if at > s[1] and number >= s[3]] for s in steps]
    return [min(each) - step[1] for each, step in zip(after, steps, strict=True) if each]


def stopped(stage: Stage) -> tuple[float, float]:
    """Press Esc in a search; return the time until the window is free, and until the result of the
    best so far is there [s]."""
    stage.do(f"if not {RUNNING}: bpy.ops.pe.optimize('INVOKE_DEFAULT')")
    stage.wait_until(f"{RUNNING} and {RUNNING}.progress.evaluations > 20", DONE_S)
    stage.do(WAIT_END, redraw=False)
    stage.rest(0.5)
    begun = time.time()
    stage.key("Escape")
    stage.wait_until("kept['ended']", DONE_S)
    kept = stage.do("pass", redraw=False)
    return kept["freed"] - begun, kept["ended"] - begun


def walked(stage: Stage) -> list[list[float]]:
    """Move the sensor step by step; return when each began, was read, and was drawn."""
    stage.do(WALK.format(steps=STEPS))
    stage.wait_until(f"len(kept['steps']) >= {STEPS}", DONE_S)
    steps: list[list[float]] = stage.do("pass")["steps"]
    return steps[2:]


def opened(stage: Stage, blend: Path) -> float:
    """Save the scene and open it again; return how long its first score takes [s]."""
    stage.do(f"bpy.ops.wm.save_as_mainfile(filepath={str(blend)!r}, copy=True)")
    stage.do(OPEN.format(blend=str(blend)), redraw=False)
    stage.wait_until("kept['opened'] and kept['scores']", DONE_S)
    kept = stage.do("pass")
    first: float = kept["scores"][0][0] - kept["opened"]
    return first


def longest(stage: Stage) -> str:
    """Return the longest time between two beats of the window's timer."""
    pulse = stage.do("pass")["pulse"]
    gaps = sorted(b - a for a, b in pairwise(pulse))
    return f"{1e3 * gaps[-1]:7.0f} ms, 90 % {1e3 * gaps[int(0.9 * len(gaps))]:.0f} ms"


def memory(stage: Stage) -> str:
    """Return the memory of Blender and of the processes that it has started."""
    blender = psutil.Process(stage.do("import os; kept['pid'] = os.getpid()")["pid"])
    family = [blender, *blender.children(recursive=True)]
    return ", ".join(f"{each.memory_info().rss / 2**20:.0f} MB" for each in family)


def told(values: Sequence[float]) -> str:
    """Minimum, median and 9th decile in a line."""
    if not values:
        return "none"
    least = min(values)
    middle = statistics.median(values)
    high = sorted(values)[-len(values) // 10]
    return f"least {1e3 * least:7.1f}  median {1e3 * middle:7.1f}  90 % {1e3 * high:7.1f} ms"


if __name__ == "__main__":
    raise SystemExit(main())
