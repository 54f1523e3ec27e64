"""What every command line shares: options, the blocking driver of a job, exit status.

Used by `pe`, by `blender --command pe` and by bpy as a module, so that they behave alike.
"""

from __future__ import annotations

import argparse
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, TextIO

from .. import catalog
from ..errors import InputError
from ..study.jobs import Job, OptimizeJob, Outcome, Progress
from ..study.results import STUDY, export_study
from ..study.study import Study
from ..text import dump_json
from .sensor_text import describe

DONE, BAD_INPUT, USAGE, INTERRUPTED = 0, 1, 2, 130
Answer = tuple[str, int]
"""What a verb prints on stdout, and its exit status."""
REPORT_EVERY_S = {True: 0.2, False: 5.0}
"""How often progress is shown: on a terminal, where it overwrites itself, and in a log."""
SAVE_EVERY_S = 10.0


def add_run_options(parser: argparse.ArgumentParser, *, search: bool) -> None:
    """Add the options of ``score`` and ``optimize`` to a parser."""
    parser.add_argument("-o", "--output", metavar="DIR", help="folder for the results")
    parser.add_argument("--json", action="store_true", help="print result.json on stdout")
    parser.add_argument(
        "--grid-samples",
        type=_count,
        metavar="N",
        help="score on N sampled voxels instead of the whole grid (0: the grid)",
    )
    parser.add_argument("--workers", type=_count, metavar="N", help="threads (default: all)")
    if search:
        parser.add_argument("--seed", type=_count, metavar="N", help="seed of the search")
        parser.add_argument(
            "--candidates", type=_count, metavar="N", help="placements tried in a round"
        )
        parser.add_argument(
            "--samples", type=_count, metavar="N", help="voxels a candidate is judged on"
        )


def _count(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"expected a whole number >= 0, found {text!r}")
    return int(text)


def with_options(study: Study, args: argparse.Namespace) -> Study:
    """Return the study as the command line's options change it."""
    if args.grid_samples is not None:
        study = replace(study, samples=args.grid_samples)
    search = study.search
    if getattr(args, "seed", None) is not None:
        search = replace(search, seed=args.seed)
    if getattr(args, "samples", None) is not None:
        search = replace(search, samples=args.samples)
    if getattr(args, "candidates", None) is not None:
        schedule = replace(search.schedule, candidates=args.candidates)
        search = replace(search, schedule=schedule)
    return replace(study, search=search)


def add_sensors_verb(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``sensors``: the catalogue, or one of its entries with a plot of its channels."""
    parser = verbs.add_parser("sensors", help="list the catalogue, or show one sensor")
    parser.add_argument("name", nargs="?", help="a sensor's name")
    parser.set_defaults(function=_show_sensors)


def _show_sensors(args: argparse.Namespace) -> Answer:
    if args.name:
        catalog.load(args.name)  # complains about a name that is not there
        return describe(catalog.entries()[args.name]), DONE
    return "\n".join(f"{e.kind:7} {e.name}" for e in catalog.entries().values()), DONE


def answer(outcome: Outcome, data: dict[str, Any], *, as_json: bool) -> Answer:
    """Return what is printed of an outcome, and the exit status that goes with it."""
    text = dump_json(data) if as_json else summary(outcome)
    return text, INTERRUPTED if outcome.stopped else DONE


def drive(job: Job, output: Path | None = None, stream: TextIO | None = None) -> Outcome:
    """Run a job to its end, with progress on `stream` (stderr).

    The first Ctrl-C asks the job to stop: the best so far is judged and kept. The second one
    raises KeyboardInterrupt. During a search the best so far is also kept in `output`.
    """
    stream = stream or sys.stderr
    reported, stage, saved = 0.0, "", time.monotonic()
    pause_s = REPORT_EVERY_S[stream.isatty()]
    with _first_interrupt(job.stop):
        for progress in job:
            now = time.monotonic()
            if now - reported >= pause_s or progress.stage != stage:
                _report(progress, stream)
                reported, stage = now, progress.stage
            if output and isinstance(job, OptimizeJob) and now - saved >= SAVE_EVERY_S:
                export_study(job.best, output / STUDY)
                saved = now
    _clear(stream)
    assert job.outcome is not None
    return job.outcome


@contextmanager
def _first_interrupt(stop: Callable[[], None]) -> Iterator[None]:
    """Call `stop` at the first Ctrl-C; let the second one interrupt for good."""

    def handler(signum: int, frame: object) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        stop()

    try:
        before = signal.signal(signal.SIGINT, handler)
    except ValueError:  # not the main thread: someone else handles Ctrl-C
        yield
        return
    try:
        yield
    finally:  # None: the handler before was not Python's own (inside Blender) and can't be named
        signal.signal(signal.SIGINT, signal.default_int_handler if before is None else before)


def _report(progress: Progress, stream: TextIO) -> None:
    entropy = "" if progress.entropy is None else f"  entropy {progress.entropy:.4f}"
    line = f"{progress.stage} {progress.fraction:4.0%}{entropy}"
    if stream.isatty():
        stream.write(f"\r\x1b[K{line}")
    else:
        stream.write(f"{line}\n")
    stream.flush()


def _clear(stream: TextIO) -> None:
    if stream.isatty():
        stream.write("\r\x1b[K")
        stream.flush()


def summary(outcome: Outcome) -> str:
    """Return an outcome in a few lines, for people."""
    if outcome.kind == "score":
        lines = [f"entropy   {_with_error(outcome.after.entropy, outcome.after.stderr)}"]
        lines.append(f"coverage  {outcome.after.coverage:.1%}")
    else:
        before, after = outcome.before, outcome.after
        lines = [
            f"entropy   {before.entropy:.4f} -> {after.entropy:.4f} nats",
            f"coverage  {before.coverage:.1%} -> {after.coverage:.1%}",
        ]
    scores = outcome.after.per_sensor
    for sensor in outcome.study.rig:
        x, y, z = sensor.pose.position
        roll, pitch, yaw = sensor.pose.rotation_deg
        own = scores[sensor.name]
        stopped = f", {own.stopped / own.beams:.1%} of its beams stopped" if own.stopped else ""
        lines.append(
            f"{sensor.name}: {sensor.model.name} at ({x:g}, {y:g}, {z:g}) m, roll {roll:g}, "
            f"pitch {pitch:g}, yaw {yaw:g} deg; alone {own.entropy:.4f}{stopped}"
        )
    if outcome.stopped:
        lines.append("stopped early: this is the best placement found so far")
    return "\n".join(lines)


def _with_error(entropy: float, stderr: float) -> str:
    return f"{entropy:.4f} nats" if stderr == 0.0 else f"{entropy:.4f} +- {stderr:.4f} nats"


def run(main: Callable[[], Answer], out: TextIO | None = None) -> int:
    """Run a command, print its text on `out` (stdout), and return its exit status.

    Bad input is one line on stderr and status 1, an interrupt is status 130.
    """
    try:
        text, status = main()
        if text:
            print(text.removesuffix("\n"), file=out or sys.stdout, flush=True)
        return status
    except InputError as error:
        print(f"pe: {error}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("pe: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # the reader of our output has gone, as `| head` does
        sys.stderr.close()
        return DONE
