"""`pe optimize` of a study that has choices: the front, kept whatever happens."""

from __future__ import annotations

import argparse
import signal
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..study import (
    FRONT_NAMES,
    SAVE_EVERY_S,
    ChoiceJob,
    TradeOff,
    front_dict,
    prepare_folder,
    write_front,
)
from ..text import dump_json
from .fallback_folder import folder_or_fallback
from .front_table import front_summary
from .interrupts import Interrupted, stop_at_first
from .reporting import Reporter
from .status import BAD_INPUT, DONE, Answer
from .terminal import tell

Draw = Callable[[Mapping[str, Any], Path], None]
"""Draws a front from its data into its folder."""
plots: list[Draw] = []
"""What draws the front beside its files: packages built on the engine add to it, with their verbs.
"""


def check_not_resumed(args: argparse.Namespace) -> None:
    """Complain of `--resume`: a search among designs is not gone on with."""
    if getattr(args, "resume", None) is not None:
        expected = "none for a study with choices, which begins anew"
        raise InputError("command line", "--resume", expected, args.resume)


def choose(
    job: ChoiceJob,
    output: Path | None,
    *,
    as_json: bool,
    host: Mapping[str, str] | None = None,
    more: Callable[[TradeOff, Path], None] | None = None,
) -> Answer:
    """Look for the front of a study's designs, keep it, and return what is printed.

    The first Ctrl-C, SIGTERM or SIGHUP asks the job to stop: the front so far is kept. The second
    ends at once; what was kept by then, every few seconds, stays.

    Parameters
    ----------
    more : callable, optional
        Writes further files to the folder (Blender's).
    """
    if output is not None:
        prepare_folder(output, FRONT_NAMES)
    with stop_at_first(job.stop) as received:
        _drive(job, output, host)
        chosen = job.trade_off
        if chosen is None:
            note = "no design was complete, so nothing was written"
            raise Interrupted(received.signum or signal.SIGINT, note)
        status, data = DONE, front_dict(chosen, host)
        if output is not None:
            status = _keep(chosen, output, host, more)
        text = dump_json(data) if as_json else front_summary(chosen)
        return text, status or received.status(DONE)


def _drive(job: ChoiceJob, output: Path | None, host: Mapping[str, str] | None) -> None:
    """Run a job to its end with progress; keep the front so far every few seconds."""
    reporter, saved, kept = Reporter(sys.stderr), time.monotonic(), 0
    try:
        for progress in job:
            reporter.report(progress)
            if output is None or time.monotonic() - saved < SAVE_EVERY_S:
                continue
            saved, chosen = time.monotonic(), job.trade_off
            if chosen is not None and chosen.searched > kept:
                kept = chosen.searched
                _try_to_write(chosen, output, host)
    finally:
        reporter.clear()


def _try_to_write(chosen: TradeOff, output: Path, host: Mapping[str, str] | None) -> None:
    try:
        write_front(chosen, output, host)
    except InputError as error:
        tell(f"{error}; the search goes on")


def _keep(
    chosen: TradeOff,
    output: Path,
    host: Mapping[str, str] | None,
    more: Callable[[TradeOff, Path], None] | None,
) -> int:
    """Write the front to a folder; where that fails, to another one that is told."""
    for place in (output, None):
        try:
            with folder_or_fallback(place) as folder:
                data = write_front(chosen, folder, host)
                if more is not None:
                    more(chosen, folder)
                for draw in plots:
                    draw(data, folder)
        except InputError as error:
            tell(str(error))
            continue
        if folder != output:
            tell(f"the results are in {folder}")
        return DONE if folder == output else BAD_INPUT
    tell("the results are not in any file")
    return BAD_INPUT
