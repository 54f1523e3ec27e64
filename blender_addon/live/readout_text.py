"""The live score as text for the read-out and the panel: plain data in, text out, no Blender."""

from collections.abc import Sequence
from typing import NamedTuple

from ..engine import advice, pe, scoring, search
from .shown import ShownScore

MIN_CHANGE = 0.0005
"""Entropies nearer to each other than this are the same in the text [nats]."""
MIN_ZONE_CHANGE = 0.005  # A zone is named from this change on [nats]
BETTER = -1
SAME = 0
WORSE = 1
SENSE_ICONS = {BETTER: "COLORSET_04_VEC", SAME: "NONE", WORSE: "COLORSET_02_VEC"}
"""Blender's own: blue is better, orange worse, told apart by colour-blind eyes, too."""
MAX_LABEL_LETTERS = 32  # Letters of a variant's name that the read-out has room for
MINUS = "\N{MINUS SIGN}"
NO_FIGURE = "\N{EN DASH}"


class TextPiece(NamedTuple):
    """A piece of a line, and whether it tells a gain or a loss."""

    text: str
    sense: int = SAME


ReadoutLine = tuple[TextPiece, ...]
"""Pieces that are drawn beside each other; empty for no line."""


class ReadoutText(NamedTuple):
    """The text of a score: headline, change, reference of the change, and further lines."""

    headline: str
    change: str
    sense: int
    against: str
    lines: tuple[ReadoutLine, ...]


def readout_of(shown: ShownScore) -> ReadoutText:
    """Return the text of what is shown. All changes are from the same baseline."""
    now = shown.now
    what = "Coverage" if now.voxels else "Objects visible:"
    coverage = TextPiece(f"{what} {advice.percent(now.coverage, 1)}")
    lines: tuple[ReadoutLine, ...] = (
        (
            coverage,
            *change_of(100.0 * _change(shown, "coverage"), 1, 100.0 * shown.error("coverage")),
        ),
    )
    if now.ap is not None:
        by = change_of(_change(shown, "ap"), 3, shown.error("ap"))
        lines += ((TextPiece(f"Expected AP {now.ap:.3f}"), *by),)
    change = against = ""
    sense = SAME
    before = shown.before("entropy")
    if shown.pair is not None and before is not None:
        lines += tuple(zone_lines(*shown.pair))
        change, sense = entropy_change(now.entropy, before, shown.error("entropy"))
        against = f"compared with {shortened(shown.label)}"
    headline = f"{shown.entropy:.3f} nats"
    return ReadoutText(headline, change, sense, against=against, lines=lines)


def _change(shown: ShownScore, measure: str) -> float:
    """Return by how much a measure of the rig changed from the baseline; 0 without one."""
    before = shown.before(measure)
    return 0.0 if before is None else getattr(shown.now, measure) - before


def state_of(shown: ShownScore, *, view_outdated: bool = False) -> str:
    """Return a score's error, and what it is of: the scene now, one that moves, a stored result.
    `view_outdated`: beams and maps are still those of before the last move."""
    state = shown.phase
    if shown.state:
        state += f", state {shown.state}"
    if view_outdated:
        state += ", beams and maps follow"
    now = shown.now
    if shown.stored and not now.stderr:
        return f"on all voxels, {state}"
    sample = f" on {now.voxels:,} voxels" if now.voxels else ""
    return f"± {advice.error_text(now.stderr)}{sample}, {state}"


def shortened(name: str) -> str:
    """Return a name that fits into a row: its end is left out where it is too long."""
    return (
        name if len(name) <= MAX_LABEL_LETTERS else f"{name[: MAX_LABEL_LETTERS - 3].rstrip()}..."
    )


def entropy_change(now: float, before: float, error: float = 0.0) -> tuple[str, int]:
    """Return how an entropy changed, and whether for the better; lower is better. `error` is the
    standard error of the change."""
    by = now - before
    if abs(by) < MIN_CHANGE or scoring.is_noise(by, error):
        return scoring.NO_DIFFERENCE, SAME
    return f"{abs(by):.3f} {'worse' if by > 0.0 else 'better'}", WORSE if by > 0.0 else BETTER


def zone_lines(before: pe.Score, now: pe.Score) -> list[ReadoutLine]:
    """Return the zone that improved most, and the one that worsened most: at most a line each."""
    common = [name for name in now.per_zone if name in before.per_zone]
    by = {name: now.per_zone[name].entropy - before.per_zone[name].entropy for name in common}
    lines: list[ReadoutLine] = []
    for word, sense in (("Better", BETTER), ("Worse", WORSE)):
        name = max(common, key=lambda zone: sense * by[zone], default=None)
        if name is None:
            continue
        error = advice.difference_error(before, now, ("zone", name, "entropy"))
        if sense * by[name] >= MIN_ZONE_CHANGE and not scoring.is_noise(by[name], error):
            where = advice.WHERE.get(name, name)
            lines.append((TextPiece(f"{word} {where} by {abs(by[name]):.2f} nats", sense),))
    return lines


def change_text(row: search.Figure, values: Sequence[float], error: float = 0.0) -> tuple[str, int]:
    """Return a figure of a rig, the last of `values`, and whether it is better than the first.
    `error` is the standard error of their difference."""
    texts = list(map(row.text, values)) or [NO_FIGURE]
    costs = [row.cost_of(value) for value in values]
    if texts[0] == texts[-1] or is_not_shown(row, values, error):
        return texts[-1], SAME
    return texts[-1], WORSE if costs[-1] > costs[0] else BETTER


def is_not_shown(row: search.Figure, values: Sequence[float], error: float) -> bool:
    """Whether the figures of a rig, the last of `values`, and of that before it differ in their
    texts, but within the standard error of their difference."""
    texts = [row.text(value) for value in values]
    return len(set(texts[:1] + texts[-1:])) > 1 and scoring.is_noise(values[-1] - values[0], error)


def change_of(by: float, digits: int, error: float = 0.0) -> ReadoutLine:
    """Return "(+1.2)" as a gain or a loss; nothing where the change is 0 in these digits.

    Within its standard error no difference is shown.
    """
    text = f"{by:+.{digits}f}"
    if not text.strip("+-0."):
        return ()
    if scoring.is_noise(by, error):
        return (TextPiece(f"({scoring.NO_DIFFERENCE})"),)
    sense = BETTER if by >= 0.0 else WORSE
    return (TextPiece(f"({text.replace('-', MINUS)})", sense),)
