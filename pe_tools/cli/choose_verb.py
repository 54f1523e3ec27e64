"""`pe optimize` of a study with a choice of sensors: print and write the Pareto front."""

from __future__ import annotations

import argparse
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from pe_core.base import dump_json
from pe_core.base.errors import InputError
from pe_core.search.goals import AP, ENTROPY, OBJECTIVES, PRICE
from pe_core.study import mounts_table

from .. import jobs
from .executors import evaluated_by
from .interrupts import Interrupted, stop_at_first
from .progress_line import Reporter
from .run_job import tell_boxes, written
from .terminal import BAD_INPUT, DONE, Answer, tell


def front_summary(chosen: jobs.TradeOff) -> str:
    """Return the front as a table: the objectives of each design, and the pose of each sensor."""
    named = [name for name in chosen.objectives if all(name in d.figures for d in chosen.front)]
    named += [name for d in chosen.front[:1] for name in d.figures if name not in named]
    units = {name: OBJECTIVES[name][1] for name in named}
    units[PRICE] = chosen.study.selection.currency
    heads = [f"{OBJECTIVES[n][0]} [{units[n]}]" if units[n] else OBJECTIVES[n][0] for n in named]
    rows = [[_figure(design, name) for name in named] for design in chosen.front]
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]

    def line(cells: Sequence[str], name: str) -> str:
        figures = (cell.rjust(width) for cell, width in zip(cells, widths, strict=True))
        return "  ".join([*figures, name])

    lines = [line(heads, "design")]
    for row, design in zip(rows, chosen.front, strict=True):
        met = f" ({design.met_text})" if design.met_text else ""
        lines += [line(row, f"{design.name}{met}"), *_placed(design, " " * (sum(widths) + 2))]
    return "\n".join([*lines, "", *search_notes(chosen)])


def search_notes(chosen: jobs.TradeOff) -> Iterator[str]:
    """Yield sentences about the search: numbers of designs, requirements, infeasible designs."""
    yield chosen.told
    if not chosen.searched:
        yield "none was searched in full: figures are those of a first look"
    if chosen.requirements_note:
        yield chosen.requirements_note
    yield from chosen.notes
    if chosen.stopped:
        yield "stopped early: this is the front of what was found so far"
    for name, why in chosen.refused.items():
        yield f"no place for {name}: {why}"


def _figure(design: jobs.Design, name: str) -> str:
    value = design.figures[name]
    if name == PRICE:
        return f"{value:,.10g}"
    if design.is_led_in:
        return "infeasible"
    return f"{value:.4f}" if name in (AP, ENTROPY) else f"{value:,.4g}"


def _placed(design: jobs.Design, margin: str) -> Iterator[str]:
    """Yield a line for each sensor: its slot, or its position and the nonzero angles."""
    mounts = mounts_table(design.study.rig, design.study.search.mounting)
    for sensor in design.study.rig:
        mount = mounts.get(sensor.name, {})
        slot, pose = mount.get("slot"), sensor.pose
        where = f"{mount['mount']}, {slot}" if slot else _where(pose.position, pose.rotation_deg)
        yield f"{margin}{sensor.name}: {sensor.model.name}; {where}"


def _where(position: Sequence[float], rotation: Sequence[float]) -> str:
    x, y, z = (round(value, 3) + 0.0 for value in position)
    angles = zip(("roll", "pitch", "yaw"), rotation, strict=True)
    turns = [f"{axis} {round(angle, 2):g} deg" for axis, angle in angles if round(angle, 2)]
    return ", ".join([f"({x:g}, {y:g}, {z:g}) m", *turns])


WritePlot = Callable[[Mapping[str, Any], Path], None]
"""Draws a front from its data into its folder."""
plots: list[WritePlot] = []
"""What draws the front beside its files: packages built on the engine add to it, with their verbs.
"""


def resumed(job: jobs.FrontJob, args: argparse.Namespace) -> str | None:
    """Let a job go on where that of ``--resume`` ended; return the folder of its results.

    Raises `InputError` where the folder has no checkpoint of this study's front.
    """
    folder: str | None = getattr(args, "resume", None)
    if folder is None:
        return args.output  # type: ignore[no-any-return]
    job.journals = jobs.read_front_search(job.study, Path(folder))
    tell(f"going on after {job.journals.count:,} placements")
    return folder


def choose(
    job: jobs.FrontJob,
    output: Path | None,
    *,
    as_json: bool,
    host: Mapping[str, str] | None = None,
    more: Callable[[jobs.TradeOff, Path], None] | None = None,
    executor: str | None = None,
) -> Answer:
    """Compute the front of a study, write it, and return the text to print.

    The first Ctrl-C, SIGTERM or SIGHUP stops the job: the front so far is written. The second one
    ends at once; the front that was last saved stays. It is saved every few seconds. `more` writes
    further files to the folder (Blender's). `executor` names the executor (`--executor`) whose
    workers evaluate placements; by default processes do.
    """
    if output is not None:
        jobs.prepare_folder(output, jobs.FRONT_NAMES)

    def write(folder: Path) -> None:
        data = jobs.write_front(chosen, folder, host)
        if more is not None:
            more(chosen, folder)
        for draw in plots:
            draw(data, folder)

    tell_boxes(job.study)
    with evaluated_by(job, executor), stop_at_first(job.stop) as received:
        _drive(job, output, host)
        found = job.trade_off
        if found is None:
            note = "no design was complete, so nothing was written"
            raise Interrupted(received.signum or signal.SIGINT, note)
        chosen, status, data = found, DONE, jobs.front_dict(found, host)
        if output is not None:
            status = DONE if written(write, output) else BAD_INPUT
        text = dump_json(data) if as_json else front_summary(chosen)
        return text, status or received.status(DONE)


def _drive(job: jobs.FrontJob, output: Path | None, host: Mapping[str, str] | None) -> None:
    """Run a job to its end with progress; save the front so far every few seconds."""
    reporter, saved, kept = Reporter(sys.stderr), time.monotonic(), 0
    checkpoint = jobs.FrontCheckpoint(job.study)

    def attempt(save: Callable[[], object]) -> None:
        try:
            save()
        except InputError as error:
            tell(f"{error}; the search goes on")

    try:
        for progress in job:
            reporter.report(progress)
            if output is None or time.monotonic() - saved < jobs.SAVE_EVERY_S:
                continue
            attempt(partial(checkpoint.save, job.journals, output))
            saved, chosen = time.monotonic(), job.trade_off
            if chosen is not None and chosen.searched > kept:
                kept = chosen.searched
                attempt(partial(jobs.write_front, chosen, output, host))
    finally:
        reporter.clear()
        if output is not None and job.journals.count:
            attempt(partial(checkpoint.save, job.journals, output))
