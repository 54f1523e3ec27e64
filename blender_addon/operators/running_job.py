"""The one job that may be running: its state, for the panel and the status bar.

It is kept here and not in a property: undo would restore an old value of a property.
"""

import time
from collections.abc import Iterator
from typing import Any, cast

import bpy

from .. import signals
from ..engine import jobs
from ..panel_text import draw_label, typeset
from ..processes import engine_process
from ..view import best_so_far, viewport
from . import modes

TOPIC = "job"
TICK_S = 0.05
"""How often the window looks how far the job is."""
STATUS_BAR_WIDTH = 14.0
"""Room for the text in the status bar, in Blender's units of a button's height."""
SHOW_EVERY_S = 0.2  # How often the progress is drawn: drawing takes time from the work
BEST_EVERY_S = 0.5
"""How often the 3D view is redrawn at most, after a better placement was found."""
EVENTS_S = 0.3  # How long windows get events after a job was ended from outside


class RunningJob(jobs.WatchedJob):
    """A job that the engine's process runs, with the progress that it made."""

    def __init__(self, context: bpy.types.Context, job: jobs.Job, outcome: str) -> None:
        super().__init__(job)
        self.outcome = outcome
        self.scene_name = context.scene.name
        self.ended = False
        self.found: Any = None
        self.error: Exception | None = None
        self._shown = self._looked = 0.0
        self._best: tuple[tuple[int, float], ...] = ()
        manager = context.window_manager
        self._timer = manager.event_timer_add(TICK_S, window=context.window)
        manager.progress_begin(0.0, 1.0)

    def start(self) -> None:
        """Have the job run; `ended` says that it has, `found` its result, `error` its failure."""
        given = (self.job, self.outcome)
        lane = engine_process.JOB
        engine_process.ask(
            TOPIC, jobs.JobRun, given, self._take, fail=self._fail, step=self.note, lane=lane
        )

    def _take(self, found: Any) -> None:
        self.ended = True
        self.found = found

    def _fail(self, error: Exception) -> None:
        self.ended = True
        self.error = error

    def stop(self) -> None:
        """End the part of the job that runs; called once more than it has parts, keep nothing."""
        if not self.seen.stop():
            self.seen.drop()
            self._take(None)  # the window waits for nothing
        engine_process.cancel(TOPIC)

    @property
    def text(self) -> str:
        """The stage, the progress, and the best value so far: approximate, if on a sample. By how
        much it is better is told with the standard error of that, once the search has ended."""
        if self.seen.dropped:
            return "Stopping"
        stage = f"{self.progress.stage.capitalize()} {self.progress.fraction:.0%}"
        value = self.progress.value
        figure = self.progress.figure
        if value is None or self.progress.stage != "optimizing":
            return stage
        curve = getattr(self.seen, "curve", ())  # as the 3D view shows it, from all starts
        value = curve[-1][1] if curve else value
        if not value.is_feasible:
            return f"{stage}, limits not met yet"
        sampled = "≈ " if self.job.study.search.samples else ""
        what = "AP" if figure.higher_is_better else "best"
        return f"{stage}, {what} {sampled}{figure.to_figure(value):.3f}"

    @property
    def on_escape(self) -> str:
        """What Esc does now."""
        if self.seen.parts_left < 1:
            return "Discard All Changes"
        return "Skip Analysis" if self.seen.parts_left < self.seen.parts else "Stop"

    def show_soon(self, context: bpy.types.Context) -> None:
        """Draw the progress again, if some time has passed since the last time."""
        if time.monotonic() - self._shown >= SHOW_EVERY_S:
            self.show(context)

    def show(self, context: bpy.types.Context) -> None:
        """Draw the progress again, but not the scene: that would take longer than the work."""
        self._shown = time.monotonic()
        self._show_search()
        context.window_manager.progress_update(self.progress.fraction)
        context.workspace.status_text_set(draw_status)
        for region in _regions(context.window_manager):
            if region.type == "UI":
                region.tag_redraw()

    def _show_search(self) -> None:
        """Show the best placement of a search in the 3D view, not too often."""
        best = getattr(self.seen, "curve", ())[1:][-1:]
        if best == self._best or time.monotonic() - self._looked < BEST_EVERY_S:
            return
        self._looked = time.monotonic()
        self._best = best
        best_so_far.searches[self.scene_name] = tuple(cast(Any, self.seen).best.rig)
        signals.view_changed.emit()  # it is drawn as ghosts
        viewport.redraw_editors()

    def end(self, context: bpy.types.Context) -> None:
        """Remove everything that shows the job, however it ended; drop one that still runs."""
        engine_process.drop(TOPIC)
        best_so_far.searches.pop(self.scene_name, None)
        signals.view_changed.emit()
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        # Any workspace will do: the text is drawn by one function for all of them.
        for workspace in bpy.data.workspaces[:1]:
            workspace.status_text_set(None)
        for region in _regions(context.window_manager):
            region.tag_redraw()


current: RunningJob | None = None


def begin(context: bpy.types.Context, job: jobs.Job, outcome: str) -> RunningJob:
    """Have the engine run the job from now on; `outcome` is its attribute of the result."""
    global current
    modes.end()  # Esc is the job's
    current = RunningJob(context, job, outcome)
    current.start()
    return current


def end(context: bpy.types.Context) -> None:
    """Drop the job; do nothing if there is none."""
    global current
    if current is not None:
        ended = current
        current = None
        ended.end(context)


def unregister() -> None:
    """End a running job and remove what shows it: its operator is about to be removed."""
    if current is not None:
        _send_events(bpy.context.window_manager)
    end(bpy.context)


def _send_events(manager: bpy.types.WindowManager) -> None:
    """Have each window get some events soon. Blender keeps the handler of a modal operator whose
    class is removed, without an operator, until the window's next event. A modal operator that a
    script starts before it ends Blender: 4.3 looks into the operators of all handlers."""
    timers = {
        window.as_pointer(): manager.event_timer_add(TICK_S, window=window)
        for window in manager.windows
    }

    def stop() -> None:
        for window in bpy.context.window_manager.windows:
            if (timer := timers.pop(window.as_pointer(), None)) is not None:
                bpy.context.window_manager.event_timer_remove(timer)

    bpy.app.timers.register(stop, first_interval=EVENTS_S, persistent=True)


def draw_status(header: bpy.types.Header, _context: bpy.types.Context) -> None:
    """Draw the progress in the status bar, in place of Blender's own hints."""
    if current is not None:
        row = header.layout.row()
        row.label(text="", icon="EVENT_ESC")  # it may be wider than the room for an icon
        draw_label(row, current.on_escape)
        bar = row.row()
        bar.ui_units_x = STATUS_BAR_WIDTH
        bar.progress(text=typeset(current.text), factor=current.progress.fraction, translate=False)
        row.separator_spacer()


def _regions(manager: bpy.types.WindowManager) -> Iterator[bpy.types.Region]:
    for window in manager.windows:
        for area in window.screen.areas:
            yield from area.regions
