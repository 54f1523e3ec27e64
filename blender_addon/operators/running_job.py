"""The one job that has the window: its state, for the panel and the status bar.

It is kept here and not in a property: undo would restore an old value of a property. A job that was
stopped gives the window back at once, and its result comes when the engine has it.
"""

import time
from collections.abc import Iterator
from itertools import count
from typing import Any, cast

import bpy

from .. import signals
from ..engine import jobs
from ..panel_text import draw_label, typeset
from ..processes import engine_process
from ..view import best_so_far, viewport
from . import modes

TOPIC = "job "
"""How the topics of jobs begin; a number follows, as a stopped job may end beside the next one."""
TICK_S = 0.05
"""How often the window looks how far the job is."""
STATUS_BAR_WIDTH = 14.0
"""Room for the text in the status bar, in Blender's units of a button's height."""
SHOW_EVERY_S = 0.2  # How often the progress is drawn: drawing takes time from the work
BEST_EVERY_S = 0.5
"""How often the 3D view is redrawn at most, after a better placement was found."""
EVENTS_S = 0.3  # How long windows get events after a job was ended from outside


_numbers = count()


class RunningJob(jobs.WatchedJob):
    """A job that the engine's process runs, with the progress that it made."""

    def __init__(self, context: bpy.types.Context, job: jobs.Job, outcome: str) -> None:
        super().__init__(job)
        self.outcome = outcome
        self.scene_name = context.scene.name
        self.stopped = False
        self.ended = False
        self.found: Any = None
        self._topic = f"{TOPIC}{next(_numbers)}"
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
            self._topic, jobs.JobRun, given, self._take, fail=self._fail, step=self.note, lane=lane
        )

    def _take(self, found: Any) -> None:
        self.ended = True
        self.found = found

    def _fail(self, error: Exception) -> None:
        self.ended = True
        self.error = error

    def stop(self) -> None:
        """Have the engine end the part of the job that runs, and do not wait for it. A job without
        such a part has ended with nothing to keep."""
        self.stopped = True
        if not self.seen.stop():
            self.seen.drop()
            self._take(None)
        engine_process.cancel(self._topic)

    def skip_analysis(self) -> None:
        """Have the result of a stopped job at once, without what would follow."""
        if self.seen.parts_left > 0:
            self.stop()

    @property
    def text(self) -> str:
        """The stage, the progress, and the best value so far: approximate, if on a sample. By how
        much it is better is told with the standard error of that, once the search has ended."""
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

    def release_window(self, context: bpy.types.Context) -> None:
        """Remove everything that shows the job."""
        best_so_far.searches.pop(self.scene_name, None)
        signals.view_changed.emit()
        context.window_manager.progress_end()
        # Any workspace will do: the text is drawn by one function for all of them.
        for workspace in bpy.data.workspaces[:1]:
            workspace.status_text_set(None)
        for region in _regions(context.window_manager):
            region.tag_redraw()

    def end(self, context: bpy.types.Context) -> None:
        """Drop the job if it still runs, however it ended."""
        engine_process.drop(self._topic)
        context.window_manager.event_timer_remove(self._timer)


current: RunningJob | None = None


stopped: list[RunningJob] = []
"""Jobs that gave the window back, and whose results are awaited."""


def begin(context: bpy.types.Context, job: jobs.Job, outcome: str) -> RunningJob:
    """Have the engine run the job from now on; `outcome` is its attribute of the result. It does
    not wait for analyses of jobs that were stopped."""
    global current
    modes.end()  # Esc is the job's
    for each in stopped:
        each.skip_analysis()
    current = RunningJob(context, job, outcome)
    current.start()
    return current


def release(context: bpy.types.Context) -> None:
    """Give the window back before the result of the job is there; do nothing without a job."""
    global current
    if current is not None:
        released = current
        current = None
        stopped.append(released)
        released.release_window(context)


def end(context: bpy.types.Context, job: RunningJob | None = None) -> None:
    """End a job that has, or had, the window; without one, all of them."""
    if job in (None, current):
        release(context)
    for each in [each for each in stopped if job in (None, each)]:
        stopped.remove(each)
        each.end(context)


def unregister() -> None:
    """End a running job and remove what shows it: its operator is about to be removed."""
    if current is not None or stopped:
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
        draw_label(row, "Stop")
        bar = row.row()
        bar.ui_units_x = STATUS_BAR_WIDTH
        bar.progress(text=typeset(current.text), factor=current.progress.fraction, translate=False)
        row.separator_spacer()


def _regions(manager: bpy.types.WindowManager) -> Iterator[bpy.types.Region]:
    for window in manager.windows:
        for area in window.screen.areas:
            yield from area.regions
