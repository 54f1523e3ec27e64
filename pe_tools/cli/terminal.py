"""Output of the command line: safe printing, messages, exit statuses, an outcome in a few lines."""

from __future__ import annotations

import argparse
import os
import sys
import unicodedata
from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Any, TextIO

from pe_core.base import dump_json, record
from pe_core.base.table_reader import finite
from pe_core.base.values import error_text
from pe_core.search.figures import AP, ENTROPY, REQUIREMENTS
from pe_core.sensors import kind_of

from ..advice import (
    built_lines,
    hidden_sensors,
    hidden_words,
    object_words,
    objects_looked_at,
    off_by,
)
from ..jobs import Outcome, condition_lines, sureness_lines
from ..wording import margin_text, percent

DONE = 0
BAD_INPUT = 1
USAGE = 2
NOT_MET = 3
INTERRUPTED = 130
EXIT_STATUSES = {
    DONE: "done",
    BAD_INPUT: "bad input, or a result that could not be written",
    USAGE: "wrong usage",
    NOT_MET: "a requirement or a scenario is not met, or a case of verify is wrong",
    INTERRUPTED: "interrupted: 128 plus the signal's number",
}
"""What each exit status means."""
Answer = tuple[str, int]  # What a verb prints on stdout, and its exit status
ESCAPED = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode categories that control a terminal or the direction of text, or are no characters."""
MAX_LINE_LENGTH = 2000  # Maximum number of characters of a message; the rest is cut


def printable(text: str, encoding: str | None = "utf-8") -> str:
    r"""Return text with control characters escaped as ``\u001b``; newlines stay.

    Characters that the stream's encoding cannot represent are escaped, too. JSON text keeps its
    meaning.
    """
    if not text.isascii() or not text.replace("\n", "").isprintable():
        return "".join(c if c == "\n" else _shown(c, encoding or "utf-8") for c in text)
    return text


def one_line(text: str) -> str:
    """Return a message of one line, printable and not too long."""
    line = printable(" ".join(text.splitlines()))
    return line if len(line) <= MAX_LINE_LENGTH else f"{line[:MAX_LINE_LENGTH]}..."


def tell(text: str) -> None:
    """Print a message on stderr, in one line that begins with ``pe:``."""
    show(f"pe: {one_line(text)}\n", sys.stderr)


def show(text: str, stream: TextIO | None) -> OSError | ValueError | None:
    """Write text to a stream unchanged; return the error if that fails, else None."""
    if stream is None:  # closed before the program started
        return None
    try:
        stream.write(text)
        stream.flush()
    except (OSError, ValueError) as error:
        # To the null device, so that flushing the stream's buffer at exit does not fail.
        with suppress(OSError, ValueError), open(os.devnull, "w") as nowhere:
            os.dup2(nowhere.fileno(), stream.fileno())
        return error
    return None


def is_terminal(stream: TextIO | None) -> bool:
    """Whether the stream is an interactive terminal."""
    try:
        return stream is not None and stream.isatty()
    except (OSError, ValueError):
        return False


def open_missing_streams() -> None:
    """Open the null device for each of stdin, stdout and stderr that is closed. Otherwise the next
    opened file would get its descriptor, and the output meant for the stream."""
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free descriptor: this one


def _shown(character: str, encoding: str) -> str:
    """Return a character; one that a terminal or a stream cannot show as JSON writes it."""
    with suppress(UnicodeEncodeError, LookupError):
        if unicodedata.category(character) not in ESCAPED and character.encode(encoding):
            return character
    # Beyond 16 bits these are two.
    units = character.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[i]:02x}{units[i + 1]:02x}" for i in range(0, len(units), 2))


def answered(args: argparse.Namespace, data: Any, lines: Iterable[str]) -> str:
    """Return what a verb prints: lines; with ``--json`` its data (`answers`)."""
    return dump_json(finite(record(data))) if args.json else "\n".join(lines)


def summary(outcome: Outcome) -> str:
    """Return an outcome in a few lines for readers."""
    score = outcome.after
    if outcome.kind == "score":
        first = with_error(score.entropy, score.stderr)
        seen = percent(score.coverage, 1)
        lines = [f"entropy   {first}", *figure_lines(outcome), f"coverage  {seen}"]
        lines += built_lines(outcome.figures[:1]) if outcome.figures else []
    else:
        lines = list(_before_and_after(outcome))
    if score.objects is not None:
        lines += [*object_words(score.objects), f"on {objects_looked_at(score.objects)}"]
    broken = [each for each in outcome.verdicts if not each.met]
    if count := len(outcome.verdicts):
        lines.append(f"requirements  {count - len(broken)} of {count} met")
    lines += [f"not met: {each.name}, {margin_text(each.summary)}" for each in broken]
    if outcome.conditions is not None:
        lines += condition_lines(outcome.conditions)
    rig = outcome.study.rig
    lines += map("ATTENTION: {}".format, hidden_words(hidden_sensors(rig, score, outcome.warnings)))
    for sensor in rig:
        x, y, z = sensor.pose.position
        roll, pitch, yaw = sensor.pose.rotation_deg
        own = score.per_sensor[sensor.name]
        what = kind_of(sensor).occlusion_text
        stopped = f", {own.occluded / own.beams:.1%} of its {what}" if own.occluded else ""
        told = ", ".join(outcome.study.distances(sensor))
        at = f"({x:g}, {y:g}, {z:g}) m{f' ({told})' * bool(told)}"
        lines.append(
            f"{sensor.name}: {sensor.model.name} at {at}, roll {roll:g}, pitch {pitch:g}, "
            f"yaw {yaw:g} deg; alone {own.entropy:.3f}{stopped}"
        )
    if outcome.kind == "optimize":
        search = outcome.start.search
        how = f"{outcome.evaluations:,} placements evaluated{outcome.evaluated_on}"
        lines += sureness_lines(outcome)
        lines.append(f"searched by {search.method}, seed {search.seed}: {how}")
    if outcome.stopped:
        lines.append("stopped early: this is the best placement found so far")
    return "\n".join([*lines, *warned(outcome)])


def _before_and_after(outcome: Outcome) -> Iterator[str]:
    """Yield what a search began and ended with, also under mounting errors and failures."""
    before = outcome.before
    after = outcome.after
    ends = f"{before.entropy:.3f} -> {after.entropy:.3f} nats"
    entropy = f"entropy   {ends} ({outcome.change_text})"
    beside = figure_lines(outcome)
    if (own := outcome.own) is not None:
        yield f"{own.figure.label}  {own.before:.3f} -> {own.after:.3f}"
    yield from [*beside, entropy] if outcome.in_traffic is not None else [entropy, *beside]
    yield f"coverage  {percent(before.coverage, 1)} -> {percent(after.coverage, 1)}"
    yield from built_lines(outcome.figures) if outcome.figures else ()
    yield from filter(None, (outcome.gain, outcome.cost))
    if (found := outcome.robustness) is not None:
        one = found.before
        other = found.after
        off = off_by(found.errors.position, found.errors.angle)
        rises = " -> ".join(each.rise_text() for each in (one, other))
        yield f"{off} (1 sigma)  {rises} nats on average"
        if one.loss is not None and other.loss is not None:
            yield f"one sensor lost  {one.loss:+.3f} -> {other.loss:+.3f} nats on average"


def figure_lines(outcome: Outcome) -> list[str]:
    """Return the dashboard of a rig, or of start and result: what is beside its entropy."""
    first = outcome.kind == "score"
    told = (outcome.figures or ())[first:]
    ends = (outcome.before, outcome.after)[first:]
    over = [f"{w:.3f}" for each in told if (w := each.over_frames) is not None]
    lines = [f"entropy over frames  {' -> '.join(over)} nats"] if over else []
    plain: list[str] = []
    for row in outcome.dashboard:
        if row.figure.is_seen or (row.figure.key != REQUIREMENTS and row.wanted is not None):
            figure = row.figure
            values = [row.figure.value(each) for each in told]
            if figure.key == ENTROPY:
                values = [each.entropy for each in ends]
            elif figure.key == AP:
                values = [row.value]
            cut = map(figure.is_cut, told) if told else (False, False)
            before = map(figure.text, values[:-1], cut)
            text = f"{figure.name} {' -> '.join([*before, row.text])}"
            if row.wanted is not None or any(each is not None for each in values):
                (plain if row.wanted is None else lines).append(text)
    return [f"key figures  {', '.join(plain)}", *lines] if plain and told else lines


def warned(outcome: Outcome) -> list[str]:
    """Return the warnings of an outcome, one line each."""
    return [f"warning: {each.line}" for each in outcome.warnings]


def with_error(entropy: float, stderr: float) -> str:
    """Return an entropy with its standard error: none for a grid, never 0 for a sample."""
    error = f" +- {error_text(stderr)}" if stderr else ""
    return f"{entropy:.3f}{error} nats"
