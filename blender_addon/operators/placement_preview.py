"""Preview of a sensor before it is placed: its picture in the view, and its approximate score.

The picture is given as arrays and lines of text; drawing reads no scene and casts no ray. The
interactive worker computes the score on a small sample.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from .. import viewport
from ..engine import graphics, pe
from ..worker import interactive_worker

LINE_PX = 1.5
TEXT_PX, TEXT_GAP, PAD_PX = 12, 1.5, 6
TEXT_AT = (26, -12)
"""Where text begins beside the mouse [px]."""
PLATE = (0.08, 0.08, 0.08, 0.78)


class HeldPreview:
    """A held sensor: lines and faces in all 3D views, text in the view under the mouse."""

    def __init__(self) -> None:
        self._handlers = viewport.DrawHandlers()
        self._lines = self._faces = graphics.Primitives.empty()
        self._text: tuple[str, ...] = ()
        self._mouse, self._region = (0, 0), 0

    def begin(self) -> None:
        """Start drawing."""
        self._handlers.show((self._draw, "POST_VIEW"), (self._draw_text, "POST_PIXEL"))

    def end(self) -> None:
        """Stop drawing; do nothing if it has ended."""
        self._handlers.hide()

    def at(self, region: bpy.types.Region, mouse: tuple[int, int]) -> None:
        """Set the view and the mouse position beside which the text is written."""
        self._mouse, self._region = mouse, region.as_pointer()

    def show(self, lines: graphics.Primitives, faces: graphics.Primitives) -> None:
        """Set the lines and faces to draw."""
        self._lines, self._faces = lines, faces

    def write(self, *text: str) -> None:
        """Set the lines of text to write."""
        self._text = text

    def redraw(self) -> None:
        """Tag every 3D view for a redraw."""
        viewport.redraw_editors()

    def _draw(self) -> None:
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("LESS_EQUAL")
        gpu.state.depth_mask_set(False)
        try:
            _draw_batch("SMOOTH_COLOR", "TRIS", self._faces)
            _draw_batch("POLYLINE_SMOOTH_COLOR", "LINES", self._lines)
        finally:
            gpu.state.depth_mask_set(True)
            gpu.state.depth_test_set("NONE")
            gpu.state.blend_set("NONE")

    def _draw_text(self) -> None:
        region = bpy.context.region
        if region is None or region.as_pointer() != self._region:
            return
        scale = viewport.ui_scale()
        size, pad = TEXT_PX * scale, PAD_PX * scale
        row = size * TEXT_GAP
        left, top = (at + off * scale for at, off in zip(self._mouse, TEXT_AT, strict=True))
        width = max((viewport.text_size(line, size)[0] for line in self._text), default=0.0)
        low = top - row * (len(self._text) - 1) - pad
        viewport.fill_box((left - pad, low, left + width + pad, top + row), PLATE)
        for number, line in enumerate(self._text):
            viewport.draw_text(line, left, top - number * row, size, viewport.INK)


def _draw_batch(name: str, kind: str, primitives: graphics.Primitives) -> None:
    if not len(primitives.points):
        return
    shader = viewport.shader(name)
    if name.startswith("POLYLINE"):
        region = bpy.context.region
        shader.bind()
        shader.uniform_float("viewportSize", (region.width, region.height))
        width = LINE_PX * bpy.context.preferences.system.pixel_size
        shader.uniform_float("lineWidth", width)
    arrays = {"pos": primitives.points, "color": primitives.colors}
    batch_for_shader(shader, kind, arrays).draw(shader)


TOPIC = "place"
SAMPLES = 16_384


@dataclass(frozen=True, slots=True)
class Gain:
    """Entropy [nats] and coverage without (None if it is the only one) and with a sensor."""

    before: float | None
    after: float
    coverage: float

    def __str__(self) -> str:
        """Return the gain as one line of text."""
        seen = f"coverage {self.coverage:.1%}"
        if self.before is None:
            return f"{self.after:.3f} nats, {seen}"
        change = self.after - self.before
        return f"{self.before:.3f} to {self.after:.3f} nats ({change:+.3f}), {seen}"


class GainPreview:
    """Scores one sensor at several poses, together with the other sensors of a study.

    Parameters
    ----------
    study : pe.Study
        Its rig holds the sensor that is placed, under `name`.
    on_result : callable
        Called with a line of text on the main thread when a score is complete.
    """

    def __init__(self, study: pe.Study, name: str, on_result: Callable[[str], None]) -> None:
        self._study, self._name, self._on_result = study, name, on_result
        self._others = [each for each in study.rig if each.name != name]
        self._evaluator: pe.RigEvaluator | None = None
        self._before: float | None = None

    def ask(self, pose: pe.Pose) -> None:
        """Request a score at a pose; only the latest request is computed."""
        interactive_worker.ask(TOPIC, lambda: self.gain(pose), self._show, self._fail)

    def gain(self, pose: pe.Pose) -> Gain:
        """Return the gain at a pose; the other sensors are measured only the first time."""
        if self._evaluator is None:
            self._evaluator = self._study.evaluator(samples=SAMPLES)
            if self._others:
                self._before = self._evaluator.entropy(pe.Rig(self._others))
        own = self._study.rig[self._name]
        moved = own.moved(pose)
        score = self._evaluator.score(pe.Rig([*self._others, moved]), preview=True)
        return Gain(self._before, score.entropy, score.coverage)

    def end(self) -> None:
        """Cancel the pending request."""
        interactive_worker.drop(TOPIC)

    def _show(self, gain: Gain) -> None:
        self._on_result(str(gain))

    def _fail(self, error: Exception) -> None:
        if not isinstance(error, pe.InputError | MemoryError):
            raise error
        self._on_result(f"no score: {error}")
