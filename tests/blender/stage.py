"""Blender in a real window on an X server of its own: a real mouse, keyboard, and Python inside.

Blender does not tell scripts where its buttons are. It does copy the Python call of the button
under the mouse, so buttons are found by asking at places from top to bottom; no pixel of the theme
and no order of the panels is assumed. Before it is clicked, a button found is asked once more, by a
real mouse and Ctrl+C.
"""

import json
import os
import subprocess
import textwrap
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tests.blender import process
from tests.blender.runner import Installed
from tests.limits import patience

TOOLS = ("Xvfb", "xdotool", "import")
WIDTH = 1120
HEIGHT = 900
"""Of a test's window: software draws it, pixel by pixel."""
STARTUP = Path(__file__).resolve().parent / "inside_window.py"

SCREEN_TIMEOUT_S = 20
READY_TIMEOUT_S = 120  # the first start on a machine without a graphics card compiles shaders
TOOL_TIMEOUT_S = 30
POLL_S = 0.05
REST_S = 1.5  # panels slide to their places, and buttons let go of the mouse
QUIET_S = 0.3  # nothing was drawn for so long: everything is in its place
SETTLE_TIMEOUT_S = 30
TURNS = 4  # of Blender's loop between moving and pressing: it finds the button by the move

SCROLLS = 30  # of the wheel: more than the sidebar is long
# of a button that acts at once; it was lost if nothing came of it
CLICKS = 3
CLICK_LOST_S = 60
SEARCHES = 4  # for a button: panels may move while one is looked for
ANSWER_TIMEOUT_S = 120
COPY_TIMEOUT_S = 5

DONE_TIMEOUT_S = 120
DRAWN_S = 1.5
"""Panels slide to their places, and shaders are compiled."""
LIBRARY = "Perception Entropy"
STEPS = 14
"""Moves of the mouse in a drag."""


class Stage:
    """One screen with one Blender on it; call `close` whatever happened."""

    def __init__(self, folder: Path, width: int = 1600):
        self.folder = folder
        self.width = width
        self.log = folder / "window.log"
        self._processes: list[subprocess.Popen] = []
        self._env: dict[str, str] = {}
        self._found: dict[tuple[str, str], tuple[int, int]] = {}

    def open(self, installed: Installed, blend: Path) -> None:
        """Start the screen and Blender, and wait until its sidebar shows our tab."""
        self._env = {"DISPLAY": self._start_screen(), "LIBGL_ALWAYS_SOFTWARE": "1"}
        blender = installed.blender
        command = [blender.command, *installed.START, "--window-geometry", "0", "0"]
        command += [str(self.width), str(HEIGHT), str(blend)]
        command += ["--python-exit-code", "3", "--python", str(STARTUP), "--", str(self.folder)]
        self._processes.append(process.start(command, self.log, {**blender.env, **self._env}))
        self.wait_for(lambda: (self.folder / "ready.json").exists(), READY_TIMEOUT_S, "its window")

    def close(self) -> None:
        """End Blender, then the screen."""
        for started in reversed(self._processes):
            process.stop(started)
        self._processes.clear()

    @property
    def state(self) -> dict:
        """What the scene holds, as Blender wrote it a moment ago."""
        return json.loads((self.folder / "state.json").read_text())

    def wait_for(self, condition: Callable[[], object], timeout_s: float, what: str) -> None:
        """Wait until the condition holds; fail after the time, or at once when Blender ended."""
        begun = time.monotonic()
        while not condition():
            ended = [each.args[0] for each in self._processes if each.poll() is not None]
            if ended or time.monotonic() > begun + patience(timeout_s):
                problem = f"{ended[0]} ended" if ended else f"{timeout_s:g} s passed"
                raise AssertionError(f"{problem}, waiting for {what}\n{self._what_there_is()}")
            time.sleep(POLL_S)

    def click(self, x: int, y: int) -> None:
        """Press and release the left button at a place, counted from the top left."""
        self._move(x, y)
        self.press_button()

    @contextmanager
    def holding(self, key: str) -> Iterator[None]:
        """Hold a key down: until its effect is seen, as a slow Blender asks for it late."""
        self._xdotool("keydown", key)
        try:
            yield
        finally:
            self._xdotool("keyup", key)

    def press_button(self, number: int = 1) -> None:
        """Press and release a button of the mouse where it is: 1 left, 2 middle, 3 right."""
        self._xdotool("click", str(number))

    def hover(self, x: int, y: int) -> None:
        """Move the mouse to a place, counted from the top left."""
        self._move(x, y)

    def point_at_view(self) -> None:
        """Move the mouse into the 3D view, where keys are the scene's."""
        self._move(self.width // 3, HEIGHT - HEIGHT // 5)

    def key(self, *names: str) -> None:
        """Press keys by their X names: ``Return``, ``ctrl+z``."""
        self._xdotool("key", *names)

    def press(self, operator: str, words: str = "") -> None:
        """Click the sidebar's button of an operator, by its name: ``pe.score``.

        Of several, the first whose call holds the `words`.
        """
        self.click(*self.find_button(operator, words))

    def press_until(
        self, operator: str, condition: Callable[[], object], what: str, words: str = ""
    ) -> None:
        """Click the button of an operator that acts at once, again where the click was lost.

        A click without any effect was seen three times on busy machines, never again on the same
        commit.
        """
        for _ in range(CLICKS - 1):
            self.press(operator, words)
            with suppress(AssertionError):
                return self.wait_for(condition, CLICK_LOST_S, what)
        self.press(operator, words)
        self.wait_for(condition, CLICK_LOST_S, what)

    def scroll_sidebar(self) -> None:
        """Scroll the sidebar to its end, where sections are that have no room in the window."""
        self._scroll("5")

    def _scroll(self, wheel: str) -> None:
        """Turn the wheel over the sidebar: 4 to its beginning, 5 to its end."""
        sidebar = json.loads((self.folder / "ready.json").read_text())["sidebar"]
        self._move(sidebar["left"] + sidebar["width"] // 2, sidebar["bottom"] - 12)
        self._xdotool("click", "--repeat", str(SCROLLS), "--delay", "20", wheel)
        self.settle()

    def find_button(self, operator: str, words: str = "") -> tuple[int, int]:
        """Return a place inside the sidebar's button of an operator."""
        call = f"bpy.ops.{operator}("
        for search in range(SEARCHES):
            place = self._look_for(operator, words)
            if place is not None:
                said = self._call_at(*place)
                if call in said and words in said:
                    self._found[operator, words] = place
                    return place
            self._found.pop((operator, words), None)
            self._scroll("54"[(search + 1) % 2])  # its beginning, then its end, by turns
            self.point_at_view()
            self.settle()
        self.screenshot(self.folder / "no_button.png")
        raise AssertionError(
            f"no button for {operator} in the sidebar; see {self.folder}/no_button.png\n"
            f"{self._end_of_log()}"
        )

    def _look_for(self, operator: str, words: str) -> tuple[int, int] | None:
        """Have Blender look for a button, first where it was the last time."""
        last = self._found.get((operator, words))
        request = {"operator": operator, "words": words, "first": [last] if last else []}
        place = self._ask("button", request)["place"]
        return None if place is None else tuple(place)

    def _ask(self, what: str, request: dict) -> dict:
        """Ask Blender something through a file, and wait for its answer."""
        asked = self.folder / f"{what}.json"
        answer = self.folder / f"{what}_answer.json"
        answer.unlink(missing_ok=True)
        partial = asked.with_suffix(".partial")
        partial.write_text(json.dumps(request))
        partial.replace(asked)
        self.wait_for(answer.exists, ANSWER_TIMEOUT_S, f"an answer about {what}")
        return json.loads(answer.read_text())

    def settle(self) -> None:
        """Wait until Blender draws nothing more."""
        begun = time.monotonic()
        drawn = self.folder / "drawn.json"

        def quiet() -> bool:
            if not drawn.exists():
                return False
            told = json.loads(drawn.read_text())
            return told["now"] - max(told["drawn"], begun) > QUIET_S

        self.wait_for(quiet, SETTLE_TIMEOUT_S, "a picture at rest")

    def screenshot(self, path: Path, aside: bool = True) -> None:
        """Keep a picture of the whole screen, the mouse out of the way and all panels at rest."""
        if aside:
            self.point_at_view()
        if self.state["running"]:  # the search goes on drawing
            time.sleep(REST_S)
        else:
            self.settle()
        self._tool("import", "-window", "root", str(path))

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
        done = self.folder / "done.json"
        asked = self.folder / "do.py"
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
        x, y = start
        u, v = end
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

    def _start_screen(self) -> str:
        """Start an X server on a display that is free, by its own choice."""
        reader, writer = os.pipe()
        command = ["Xvfb", "-displayfd", str(writer), "-screen", "0", f"{self.width}x{HEIGHT}x24"]
        command += ["-nolisten", "tcp"]
        server = process.start(command, self.folder / "screen.log", pass_fds=[writer])
        self._processes.append(server)
        os.close(writer)
        os.set_blocking(reader, False)
        number = bytearray()

        def answered() -> bool:
            with suppress(BlockingIOError):
                number.extend(os.read(reader, 16))
            return number.endswith(b"\n")

        self.wait_for(answered, SCREEN_TIMEOUT_S, "an X server")
        os.close(reader)
        return f":{int(number)}"

    def _call_at(self, x: int, y: int) -> str:
        """Return the Python call of the button at a place, "" where there is none."""
        copied = self.folder / "copied.txt"
        copied.unlink(missing_ok=True)
        self._move(x, y)
        self.key("ctrl+c")
        deadline = time.monotonic() + COPY_TIMEOUT_S
        while not copied.exists() and time.monotonic() < deadline:
            time.sleep(POLL_S)
        return copied.read_text() if copied.exists() else ""

    def _move(self, x: int, y: int) -> None:
        # Coming from one pixel aside: a move that changes nothing is no event.
        self._xdotool("mousemove", str(x - 1), str(y), "mousemove", str(x), str(y))
        self._ask("turns", {"count": TURNS})

    def _xdotool(self, *arguments: str) -> None:
        self._tool("xdotool", *arguments)

    def _tool(self, *command: str) -> None:
        answer = process.run(command, TOOL_TIMEOUT_S, self._env)
        assert answer.returncode == 0, f"{command}: {answer.stderr}"

    def _what_there_is(self) -> str:
        """What Blender wrote last of its state, and its log: for whoever has to find out why."""
        state = self.folder / "state.json"
        return f"{state.read_text() if state.exists() else ''}\n{self._end_of_log()}"

    def _end_of_log(self) -> str:
        return self.log.read_text()[-2000:] if self.log.exists() else ""
