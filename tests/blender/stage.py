"""A real window that does what it is told in Python as well: for layouts that no click can make."""

from __future__ import annotations

import json
import textwrap
import time
from pathlib import Path

from tests.blender import window as windowed

INSIDE = Path(__file__).resolve().parent / "inside_stage.py"
DONE_TIMEOUT_S = 120
DRAWN_S = 1.5
"""Panels slide to their places, and shaders are compiled."""
LIBRARY = "Perception Entropy"
STEPS = 14
"""Moves of the mouse in a drag."""


class Stage(windowed.Window):
    """A window that does what Python says, beside what its mouse and keyboard do."""

    startup = INSIDE

    def load(self, blend: Path) -> None:
        """Show a file as it was saved, laid out as at the start; nothing of before is left."""
        self.point_at_view()
        for path in self.folder.glob("*"):  # Blender is about to rename what is partial
            if path.suffix not in (".log", ".partial"):
                path.unlink(missing_ok=True)
        self.do(f"kept.clear(); start_again({str(blend)!r})")
        self.wait_for(lambda: (self.folder / "ready.json").exists(), DONE_TIMEOUT_S, "the file")

    def do(self, code: str, redraw: bool = True) -> dict:
        """Run Python inside Blender; return what it keeps in `kept`.

        Blender draws what Python has changed only when it is told to.
        """
        done, asked = self.folder / "done.json", self.folder / "do.py"
        done.unlink(missing_ok=True)
        partial = asked.with_suffix(".partial")
        partial.write_text(f"redraw = {redraw}\n{textwrap.dedent(code)}")
        partial.replace(asked)
        self.wait_for(done.exists, DONE_TIMEOUT_S, f"an answer to {code[:60]!r}")
        answer = json.loads(done.read_text())
        if answer["problem"]:
            raise AssertionError(answer["problem"])
        return answer["kept"]

    def wait_until(self, expression: str, timeout_s: float = DONE_TIMEOUT_S) -> None:
        """Wait until an expression holds inside Blender."""
        self.wait_for(
            lambda: self.do(f"kept['holds'] = bool({expression})", redraw=False)["holds"],
            timeout_s,
            expression,
        )

    def rest(self, seconds: float = DRAWN_S) -> None:
        """Let Blender draw."""
        time.sleep(seconds)

    def photograph(self, path: Path) -> None:
        """Keep a picture of the screen as it is, the mouse where it is."""
        self._tool("import", "-window", "root", str(path))

    def mouse(self, *arguments: object) -> None:
        """Work the mouse and the keyboard with xdotool."""
        self._xdotool(*map(str, arguments))

    def point_at(self, x: float, y: float) -> None:
        """Move the mouse to a place on the screen."""
        self._move(round(x), round(y))

    def drag(self, start: tuple[int, int], end: tuple[int, int], held_s: float = 0.6) -> None:
        """Drag with the left button from one place to another."""
        (x, y), (u, v) = start, end
        self._move(x, y)
        self.mouse("mousedown", 1)
        self.rest(0.3)
        for step in range(1, STEPS + 1):
            share = step / STEPS
            self.mouse("mousemove", round(x + (u - x) * share), round(y + (v - y) * share))
            self.rest(0.1)
        self.rest(held_s)
        self.mouse("mouseup", 1)

    def show_assets(self, catalog_id: str) -> None:
        """A 3D view above an asset browser that shows one catalogue of our library."""
        self.do("""
            workspace = bpy.data.workspaces["Shading"]
            for each in workspace.screens[0].areas:
                if each.type == "VIEW_3D":  # else the materials' shaders are compiled
                    each.spaces.active.shading.type = "SOLID"
            window.workspace = workspace
        """)
        self.settle()
        self.do("""
            below = next(a for a in window.screen.areas if a.type == "NODE_EDITOR")
            below.ui_type = "ASSETS"
        """)
        self.settle()
        self.do(f"""
            below = next(a for a in window.screen.areas if a.ui_type == "ASSETS")
            below.spaces.active.params.asset_library_reference = {LIBRARY!r}
            below.spaces.active.params.catalog_id = {catalog_id!r}
        """)
        self.settle()

    def place_of(self, point: tuple[float, float, float]) -> tuple[int, int]:
        """Where a point of the scene is on the screen, from its top left."""
        kept = self.do(f"""
            from bpy_extras.view3d_utils import location_3d_to_region_2d
            from mathutils import Vector
            x, y = location_3d_to_region_2d(region, area.spaces.active.region_3d, Vector({point}))
            kept["place"] = [round(region.x + x), round(window.height - region.y - y)]
        """)
        return tuple(kept["place"])
