"""How long it takes from a move of the mouse to the live score, in a real window.

    python -m tests.blender.measure_live [--suite sid]

One Pandar64 of four sensors on the sedan is dragged by a real mouse. Times are taken inside
Blender: from its handler, which tells of a move, to the score being there, to the read-out that
shows it being drawn. No test: a busy machine only makes it slower.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from tests.blender.runner import Blender, Installed
from tests.blender.stage import Stage

ROOT = Path(__file__).resolve().parents[2]
MOVES, PAUSE_S = 60, 0.1
SET_UP = """
from bl_ext.user_default.perception_entropy import signals
settings = window.scene.perception_entropy
for model, name, place, turn in (
    ("Camera 60 deg", "cam_front", (0.5, 0.0, 1.45), 0.0),
    ("Pandar40", "lidar_bumper", (2.35, 0.0, 0.6), 0.0),
    ("Camera 120 deg", "cam_left", (0.3, 1.0, 1.0), 1.5708),
):
    bpy.ops.pe.add_sensor(model=model)
    made = bpy.context.object
    made.name, made.location, made.rotation_euler.z = name, place, turn
roof = window.scene.objects["roof_lidar"]
for each in window.scene.objects:
    each.select_set(each == roof, view_layer=window.view_layer)
window.view_layer.objects.active = roof
settings.live.on = True
"""
STAMPS = """
import time
from bl_ext.user_default.perception_entropy.live import readout, session, state
STAMPS = kept["stamps"] = []
ask, work, lines = session.request_score, session.score_in_thread, readout.draw_rows

def asked(*given, **options):
    STAMPS.append(("asked", time.perf_counter()))
    ask(*given, **options)
    STAMPS.append(("read", time.perf_counter()))

def worked(*given):
    cpu = time.thread_time()
    found = work(*given)
    STAMPS.append(("there", time.perf_counter()))
    STAMPS.append(("cpu", time.thread_time() - cpu))
    return found

def drawn(*given):
    STAMPS.append(("drawn", time.perf_counter()))
    begun = time.perf_counter()
    lines(*given)
    STAMPS.append(("lines", time.perf_counter() - begun))

session.request_score, session.score_in_thread, readout.draw_rows = asked, worked, drawn
"""
RESTED = "(r := __import__('bl_ext.user_default.perception_entropy.live', fromlist=['state'])"
RESTED += ".state.live_state(window.scene.name).score) and r.exact"


def main() -> int:
    """Measure, and print a line a figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--suite", default="trixie")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        installed = install(chosen.suite, Path(folder))
        for overlay in (False, True):
            stamps = measured(installed, Path(tempfile.mkdtemp(dir=folder)), overlay)
            print(f"overlay {'on' if overlay else 'off'}")
            for name, values in figures(stamps).items():
                print(f"  {name:38s} {told(values)}")
    return 0


def install(suite: str, folder: Path) -> Installed:
    """Build the extension and install it into a user folder of its own."""
    finder = [sys.executable, ROOT / "tools" / "real_blender.py", "--suite", suite]
    blender = Blender(said_by(finder)).with_resources(folder)
    built = said_by([sys.executable, ROOT / "tools" / "build_extension.py"])
    command = ("--command", "extension", "install-file", "-r", "user_default", "--enable", built)
    blender.run(*command)
    return Installed(blender)


def said_by(command: Sequence[object]) -> str:
    """Return what a command prints."""
    answer = subprocess.run([*map(str, command)], capture_output=True, text=True, check=True)
    return answer.stdout.strip()


def measured(installed: Installed, folder: Path, overlay: bool) -> list[tuple[str, float]]:
    """Drag the roof's LiDAR; return what was stamped meanwhile."""
    stage = Stage(folder)
    try:
        stage.open(installed, ROOT / "blend_assets" / "sedan.blend")
        stage.do(SET_UP)
        stage.do(f"window.scene.perception_entropy.show_overlay = {overlay}")
        stage.wait_until(RESTED)
        stage.do(STAMPS)
        stage.point_at_view()
        stage.key("g")
        for number in range(MOVES):
            stage.mouse("mousemove_relative", "--", 3 if number % 20 < 10 else -3, 0)
            time.sleep(PAUSE_S)
        stage.mouse("click", 1)
        stage.rest(3.0)
        return [tuple(each) for each in stage.do("pass")["stamps"]]
    finally:
        stage.close()


def figures(stamps: list[tuple[str, float]]) -> dict[str, list[float]]:
    """Milliseconds of each kind."""
    at = {name: [t for what, t in stamps if what == name] for name in ("asked", "read", "there")}
    drawn = [t for what, t in stamps if what == "drawn"]
    ends = [*at["asked"][1:], float("inf")]
    there = [
        (t, min((u for u in at["there"] if t < u < end), default=None))
        for t, end in zip(at["asked"], ends, strict=True)
    ]
    shown = [
        min((u for u in drawn if u > found), default=None) - t
        for t, found in there
        if found is not None and drawn and drawn[-1] > found
    ]
    return {
        "read in Blender's own turn": spans(at["asked"], at["read"]),
        "handler to score": [1e3 * (u - t) for t, u in there if u is not None],
        "handler to read-out drawn with it": [1e3 * each for each in shown],
        "work of the thread alone": [1e3 * t for what, t in stamps if what == "cpu"],
        "drawing the read-out": [1e3 * t for what, t in stamps if what == "lines"],
    }


def spans(begun: list[float], ended: list[float]) -> list[float]:
    return [1e3 * (end - start) for start, end in zip(begun, ended, strict=True)]


def told(values: list[float]) -> str:
    """Minimum, median and 9th decile in a line."""
    if not values:
        return "none"
    high = sorted(values)[int(0.9 * len(values))]
    least, middle = min(values), statistics.median(values)
    return f"min {least:7.1f}  median {middle:7.1f}  90 % {high:7.1f} ms  ({len(values)})"


if __name__ == "__main__":
    raise SystemExit(main())
