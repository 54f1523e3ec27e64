"""Exports as jobs: prepared on a thread, written as one set of files at the end.

An operator gives an `ExportJob` its steps. From a file dialog the job is stepped by a timer, with
progress and Esc as for a search; scripts and Blender without a window run it to its end. The names
of the files written last are kept here for the panel: they are not part of the .blend file.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
from bpy_extras.io_utils import ExportHelper

from .. import viewport
from ..engine import pe
from ..language import shown
from . import running_job
from .reports import (
    USER_ERRORS,
    OperatorMixin,
    OperatorResult,
    begin_in_results_folder,
    report,
    report_error,
)
from .score_jobs import JobOperator, SceneJob


@dataclass(frozen=True, slots=True)
class WrittenFiles:
    """Files that an export wrote, and warnings about them."""

    paths: tuple[Path, ...]
    lines: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """One line that names the written files."""
        return f"Wrote {', '.join(path.name for path in self.paths)}"

    @property
    def folder(self) -> Path:
        """The folder of the first file."""
        return self.paths[0].parent


ExportSteps = Generator[pe.Progress, None, WrittenFiles | None]


class ExportStopped(Exception):
    """The user stopped the export; raised on the thread to end its work."""


class ExportJob(pe.Job):
    """Steps that end with writing files; a stopped job writes nothing.

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
        """End at once, and write nothing."""
        self.drop()

    def scored(self, until: float) -> Generator[pe.Progress, None, pe.Outcome | None]:
        """Yield the steps of a score; progress runs from 0 to the share `until`."""
        job = pe.ScoreJob(self.study)
        for step in job:
            if self.stopped:
                job.drop()
            yield pe.Progress("scoring", until * step.fraction)
        return None if self.stopped else job.outcome

    def made(
        self, stage: str, begin: float, work: Callable[[], Any]
    ) -> Generator[pe.Progress, None, Any]:
        """Run work on a thread, with progress from `begin` to 1; return its result or None."""
        self._share = begin
        return (yield from self._beside(work, lambda: pe.Progress(stage, self._share)))

    def watch(self, begin: float) -> Callable[[float], None]:
        """Return the progress callback for work on a thread; it raises if the job is stopped."""

        def note(share: float) -> None:
            if self.stopped:
                raise ExportStopped
            self._share = begin + (1.0 - begin) * share

        return note


class ExportOperator(ExportHelper, OperatorMixin):
    """Base class of export operators; a subclass makes the job."""

    asked_in_window = False

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        if running_job.current is not None:
            cls.poll_message_set(shown("Another score, search or export is running; Esc stops it"))
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        """Open the file dialog; the export then runs as a job."""
        self.asked_in_window = not bpy.app.background
        begin_in_results_folder(self)
        return super().invoke(context, event)

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        """Export to the given file: at once, or as a job after a file dialog."""
        try:
            job = self.job(context)
            if self.asked_in_window:
                return start(job)
            for _ in job:
                pass
            return finished(self, job)
        except USER_ERRORS as error:
            return report_error(self, error)


class PE_OT_run_export(JobOperator, bpy.types.Operator):
    """Run the export of a file dialog"""

    bl_idname = "pe.run_export"
    bl_label = "Export"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return _waiting is not None and running_job.current is None

    def _task(self, _context: bpy.types.Context) -> SceneJob:
        return SceneJob(_take_waiting(), None)

    def _apply(self, _scene: bpy.types.Scene | None, task: SceneJob) -> OperatorResult:
        return finished(self, task.job)


class PE_OT_open_folder(bpy.types.Operator):
    """Open the folder of the last export"""

    bl_idname = "pe.open_folder"
    bl_label = "Open Folder"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return last is not None

    def execute(self, _context: bpy.types.Context) -> OperatorResult:
        if last is None or not last.folder.is_dir():
            report(self, "WARNING", f"The folder {last.folder if last else ''} was removed")
            return {"CANCELLED"}
        return bpy.ops.wm.path_open(filepath=str(last.folder))


class PE_OT_dismiss_written(bpy.types.Operator):
    """Hide the list of files written last"""

    bl_idname = "pe.dismiss_written"
    bl_label = "Dismiss"
    bl_options = {"INTERNAL"}

    def execute(self, _context: bpy.types.Context) -> OperatorResult:
        set_last(None)
        return {"FINISHED"}


last: WrittenFiles | None = None
"""The files written last in this session."""
_waiting: ExportJob | None = None


def start(job: ExportJob) -> OperatorResult:
    """Run a job in a separate operator, because a file dialog's operator ends with it."""
    global _waiting
    _waiting = job
    bpy.ops.pe.run_export("INVOKE_DEFAULT")
    return {"FINISHED"}


def finished(operator: bpy.types.Operator, job: ExportJob) -> OperatorResult:
    """Report the files that a job wrote, and store their names for the panel."""
    if job.written is None:
        report(operator, "INFO", "Stopped: nothing was written")
        return {"CANCELLED"}
    set_last(job.written)
    report_written(operator, job.written)
    return {"FINISHED"}


def report_written(operator: bpy.types.Operator, written: WrittenFiles) -> None:
    """Report warnings, then the written files: Blender shows only the last report."""
    for line in written.lines:
        report(operator, "WARNING", line)
    paths = [str(path) for path in written.paths]
    report(operator, "INFO", f"Wrote {paths[0]}" if len(paths) == 1 else written.text)


def report_files(
    operator: bpy.types.Operator, *paths: Path, lines: tuple[str, ...] = ()
) -> OperatorResult:
    """Report the files of an export without a job, and store their names for the panel."""
    written = WrittenFiles(tuple(paths), tuple(lines))
    set_last(written)
    report_written(operator, written)
    return {"FINISHED"}


def set_last(written: WrittenFiles | None) -> None:
    """Store the names of the files written last, and redraw the panels."""
    global last
    last = written
    viewport.redraw_editors()


def _take_waiting() -> ExportJob | None:
    """Return the waiting job, and remove it so that no other operator runs it."""
    global _waiting
    job, _waiting = _waiting, None
    return job


def unregister() -> None:
    """Drop the list of written files, and the waiting job."""
    global last, _waiting
    last = _waiting = None


CLASSES = (
    PE_OT_run_export,
    PE_OT_open_folder,
    PE_OT_dismiss_written,
)
