"""Output of the command line: safe printing, messages, exit statuses, an outcome in a few lines."""

from __future__ import annotations

import os
import sys
import unicodedata
from contextlib import suppress
from typing import TextIO

from pe_core.sensors import kind_of
from pe_core.study import Robustness

from ..advice import hidden_sensors, hidden_words, object_words, objects_looked_at, off_by
from ..jobs import Outcome, condition_lines, searched_on, sureness_lines
from ..wording import margin_text

DONE, BAD_INPUT, USAGE, INTERRUPTED = 0, 1, 2, 130
Answer = tuple[str, int]
"""What a verb prints on stdout, and its exit status."""


ESCAPED = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode categories that control a terminal or the direction of text, or are no characters."""
MAX_LINE_LENGTH = 2000
"""Maximum number of characters of a message; the rest is cut."""


def printable(text: str, encoding: str | None = "utf-8") -> str:
    r"""Return text with control characters escaped as ``\u001b``; newlines stay.

    Characters that the stream's encoding cannot represent are escaped, too. JSON text keeps its
    meaning.
    """
    if not text.isascii() or not text.replace("\n", "").isprintable():
        text = "".join(c if c == "\n" or _is_harmless(c, encoding) else _escape(c) for c in text)
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
        _silence(stream)
        return error
    return None


def is_terminal(stream: TextIO | None) -> bool:
    """Whether the stream is an interactive terminal."""
    try:
        return stream is not None and stream.isatty()
    except (OSError, ValueError):
        return False


def open_missing_streams() -> None:
    """Open the null device for each of stdin, stdout and stderr that is closed.

    Otherwise the next opened file would get its descriptor, and the output meant for the stream.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free descriptor: this one


def _silence(stream: TextIO) -> None:
    """Redirect a stream to the null device, so that flushing its buffer at exit does not fail."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        try:
            os.dup2(nowhere, stream.fileno())
        finally:
            os.close(nowhere)


def _is_harmless(character: str, encoding: str | None) -> bool:
    if unicodedata.category(character) in ESCAPED:
        return False
    try:
        character.encode(encoding or "utf-8")
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def _escape(character: str) -> str:
    """Return a character as JSON writes it: beyond 16 bits as two."""
    units = character.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[i]:02x}{units[i + 1]:02x}" for i in range(0, len(units), 2))


MIN_SHOWN_ERROR = 1e-4
"""Smallest standard error that is printed [nats]: one unit of the last digit."""


def summary(outcome: Outcome) -> str:
    """Return an outcome in a few lines for readers."""
    if outcome.kind == "score":
        lines = [f"entropy   {with_error(outcome.after.entropy, outcome.after.stderr)}"]
        lines.append(f"coverage  {outcome.after.coverage:.1%}")
    else:
        before, after = outcome.before, outcome.after
        lines = [
            *_in_traffic(outcome),
            f"entropy   {before.entropy:.4f} -> {after.entropy:.4f} nats",
            f"coverage  {before.coverage:.1%} -> {after.coverage:.1%}",
            f"{outcome.cost}",
            *_moves(outcome.robustness),
        ]
    if outcome.after.objects is not None:
        found = outcome.after.objects
        lines += [*object_words(found), f"on {objects_looked_at(found)}"]
    lines += _requirements(outcome)
    if outcome.conditions is not None:
        lines += condition_lines(outcome.conditions)
    scores = outcome.after.per_sensor
    rig = outcome.study.rig
    hidden = hidden_sensors(rig, outcome.after, outcome.warnings)
    lines += [f"ATTENTION: {line}" for line in hidden_words(hidden)]
    for sensor in rig:
        x, y, z = sensor.pose.position
        roll, pitch, yaw = sensor.pose.rotation_deg
        own = scores[sensor.name]
        what = kind_of(sensor).occlusion_text
        stopped = f", {own.occluded / own.beams:.1%} of its {what}" if own.occluded else ""
        lines.append(
            f"{sensor.name}: {sensor.model.name} at ({x:g}, {y:g}, {z:g}) m, roll {roll:g}, "
            f"pitch {pitch:g}, yaw {yaw:g} deg; alone {own.entropy:.4f}{stopped}"
        )
    if outcome.kind == "optimize":
        lines += sureness_lines(outcome)
        lines.append(searched(outcome))
    if outcome.stopped:
        lines.append("stopped early: this is the best placement found so far")
    return "\n".join([*lines, *warned(outcome)])


def _in_traffic(outcome: Outcome) -> list[str]:
    """Return the expected AP that a search by it began and ended with; empty for other searches."""
    if outcome.in_traffic is None:
        return []
    before, after = outcome.in_traffic
    error = f"standard error {max(after.ap_stderr, MIN_SHOWN_ERROR):.4f}"
    scenes = f"on {after.scenes:,} scenes"
    return [f"expected AP in traffic  {before.ap:.4f} -> {after.ap:.4f} ({error}, {scenes})"]


def _requirements(outcome: Outcome) -> list[str]:
    """Return how many requirements are met, and which are not."""
    broken = [each for each in outcome.verdicts if not each.met]
    if not outcome.verdicts:
        return []
    count = len(outcome.verdicts)
    lines = [f"requirements  {count - len(broken)} of {count} met"]
    return lines + [f"not met: {each.name}, {margin_text(each.summary)}" for each in broken]


def _moves(found: Robustness | None) -> list[str]:
    """Describe the entropy of start and result under mounting errors and sensor failures."""
    if found is None:
        return []
    before, after = found.before, found.after
    off = off_by(found.errors.position, found.errors.angle)
    lines = [f"{off} (1 sigma)  {before.rise:+.4f} -> {after.rise:+.4f} nats on average"]
    if before.loss is not None and after.loss is not None:
        lines.append(f"one sensor lost  {before.loss:+.4f} -> {after.loss:+.4f} nats on average")
    return lines


def searched(outcome: Outcome) -> str:
    """Describe a search: method, seed, and the number of voxels that evaluate a candidate."""
    study, search = outcome.start, outcome.start.search
    levels, what = searched_on(study)
    count = f"{outcome.evaluations:,} placements"
    return f"searched by {search.method}, seed {search.seed}: {count} evaluated on {levels} {what}"


def warned(outcome: Outcome) -> list[str]:
    """Return the warnings of an outcome, one line each."""
    return [f"warning: {each.line}" for each in outcome.warnings]


def with_error(entropy: float, stderr: float) -> str:
    """Return an entropy with its standard error: none for a grid, never 0 for a sample."""
    error = f" +- {max(stderr, MIN_SHOWN_ERROR):.4f}" if stderr else ""
    return f"{entropy:.4f}{error} nats"
