"""Exports as jobs: worked out beside the window, written at once at the end, never half.

An operator gives an `ExportJob` its steps. From a file dialog the job is stepped by a timer, with
progress and Esc as a search has them; scripts and Blender without a window run it to its end. What
was written last is kept here for the panel to show: it is no part of the file.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
from bpy_extras.io_utils import ExportHelper

from .. import redraw
from ..engine import pe
from . import running
from .job import JobOperator, SceneJob
from .reports import REFUSALS, refuse, tell


@dataclass(frozen=True, slots=True)
class WrittenFiles:
    """Files that an export wrote, and lines on what to know of them."""

    paths: tuple[Path, ...]
    lines: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Say what was written."""
        return f"Wrote {', '.join(path.name for path in self.paths)}"

    @property
    def folder(self) -> Path:
        """The folder that the first file is in."""
        return self.paths[0].parent


ExportSteps = Generator[pe.Progress, None, WrittenFiles | None]


class ExportStopped(Exception):
    """The user has stopped an export: what still is worked out for it is of no use."""


class ExportJob(pe.Job):
    """Steps that end with files written. Stopped before, it writes nothing.

    Parameters
    ----------
    study : Study
        What is exported.
    steps : callable
        Given the job, a generator of `Progress` that returns what it wrote; None where the job was
        stopped.
    """

    def __init__(self, study: pe.Study, steps: Callable[[ExportJob], ExportSteps]) -> None:
        super().__init__(study)
        self._steps = steps
        self._share = 0.0
        self.written: WrittenFiles | None = None

    def __iter__(self) -> Iterator[pe.Progress]:
        found = yield from self._steps(self)
        self.written = None if self.stopped else found

    def stop(self) -> None:
        """End at once: half an export is of no use to anybody."""
        self.drop()

    def scored(self, until: float) -> Generator[pe.Progress, None, pe.Outcome | None]:
        """Score the study, as the first steps up to a share of the whole."""
        job = pe.ScoreJob(self.study)
        for step in job:
            if self.stopped:
                job.drop()
            yield pe.Progress("scoring", until * step.fraction)
        return None if self.stopped else job.outcome

    def made(
        self, stage: str, begin: float, work: Callable[[], Any]
    ) -> Generator[pe.Progress, None, Any]:
        """Work in a thread from a share of the whole on; return what it made, None if stopped."""
        self._share = begin
        return (yield from self._beside(work, lambda: pe.Progress(stage, self._share)))

    def watch(self, begin: float) -> Callable[[float], None]:
        """Return what a work in a thread calls with its share of the way: it ends when stopped."""

        def note(share: float) -> None:
            if self.stopped:
                raise ExportStopped
            self._share = begin + (1.0 - begin) * share

        return note


class ExportOperator(ExportHelper):
    """What exports share; a subclass makes the job."""

    asked_in_window = False

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        if running.current is not None:
            cls.poll_message_set("Another score, search or export is running; Esc stops it")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Ask for the file; what is exported then is worked out beside the window."""
        self.asked_in_window = not bpy.app.background
        return super().invoke(context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Export to the file that is given: at once, unless a dialog has asked for it."""
        try:
            job = self.job(context)
            if self.asked_in_window:
                return start(job)
            for _ in job:
                pass
            return finished(self, job)
        except REFUSALS as error:
            return refuse(self, error)


class PE_OT_run_export(JobOperator, bpy.types.Operator):
    """Step the export that a file dialog has asked for"""

    bl_idname = "pe.run_export"
    bl_label = "Export"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return _waiting is not None and running.current is None

    def _task(self, _context: bpy.types.Context) -> SceneJob:
        return SceneJob(_taken(), None)

    def _apply(self, _scene: bpy.types.Scene | None, task: SceneJob) -> set[str]:
        return finished(self, task.job)


class PE_OT_open_folder(bpy.types.Operator):
    """Open the folder that the last export wrote to"""

    bl_idname = "pe.open_folder"
    bl_label = "Open Folder"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return last is not None

    def execute(self, _context: bpy.types.Context) -> set[str]:
        if not last.folder.is_dir():
            tell(self, "WARNING", f"There is no {last.folder} any more")
            return {"CANCELLED"}
        return bpy.ops.wm.path_open(filepath=str(last.folder))


class PE_OT_dismiss_written(bpy.types.Operator):
    """Say no more of what was written last"""

    bl_idname = "pe.dismiss_written"
    bl_label = "Dismiss"
    bl_options = {"INTERNAL"}

    def execute(self, _context: bpy.types.Context) -> set[str]:
        note(None)
        return {"FINISHED"}


last: WrittenFiles | None = None
"""What was written last in this session."""
_waiting: ExportJob | None = None


def start(job: ExportJob) -> set[str]:
    """Have the window step a job: by an operator of its own, as a dialog's ends with the dialog."""
    global _waiting
    _waiting = job
    bpy.ops.pe.run_export("INVOKE_DEFAULT")
    return {"FINISHED"}


def finished(operator: bpy.types.Operator, job: ExportJob) -> set[str]:
    """Tell what a job wrote, and keep that for the panel."""
    if job.written is None:
        tell(operator, "INFO", "Stopped: nothing was written")
        return {"CANCELLED"}
    note(job.written)
    tell_written(operator, job.written)
    return {"FINISHED"}


def tell_written(operator: bpy.types.Operator, written: WrittenFiles) -> None:
    """Report what was written, warnings first: the last report is the one that is seen."""
    for line in written.lines:
        tell(operator, "WARNING", line)
    paths = [str(path) for path in written.paths]
    tell(operator, "INFO", f"Wrote {paths[0]}" if len(paths) == 1 else written.text)


def wrote(operator: bpy.types.Operator, *paths: Path, lines: tuple[str, ...] = ()) -> set[str]:
    """Tell and keep what an export without a job wrote."""
    note(WrittenFiles(tuple(paths), tuple(lines)))
    tell_written(operator, last)
    return {"FINISHED"}


def note(written: WrittenFiles | None) -> None:
    """Keep what was written last, and have panels say it."""
    global last
    last = written
    redraw.editors()


def _taken() -> ExportJob:
    """Return the job that waits, which no other may take then."""
    global _waiting
    job, _waiting = _waiting, None
    return job


def unregister() -> None:
    """Forget what was written, and what waits."""
    global last, _waiting
    last = _waiting = None


CLASSES = (PE_OT_run_export, PE_OT_open_folder, PE_OT_dismiss_written)
