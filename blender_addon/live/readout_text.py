"""The live score as text for the read-out and the panel: plain data in, text out, no Blender."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from ..engine import advice, pe, wording
from .state import LiveScore, ShownFigures, ShownScore

MIN_CHANGE = 0.0005
"""Entropies nearer to each other than this are the same in the text [nats]."""
MIN_ZONE_CHANGE = 0.005
"""A zone is named from this change on [nats]."""
BETTER, SAME, WORSE = -1, 0, 1
SENSE_ICONS = {BETTER: "COLORSET_04_VEC", SAME: "NONE", WORSE: "COLORSET_02_VEC"}
"""Blender's own: blue is better, orange worse, told apart by colour-blind eyes, too."""
MAX_LABEL_LETTERS = 32
"""Letters of a variant's name that the read-out has room for."""
MINUS = "\N{MINUS SIGN}"
BEFORE_SEARCH = "before the search"
PENDING = "AP in traffic, blind ground, reach: being computed"
NO_FIGURE, ARROW = "\N{EN DASH}", " \N{RIGHTWARDS ARROW} "


class TextPiece(NamedTuple):
    """A piece of a line, and whether it tells a gain or a loss."""

    text: str
    sense: int = SAME


ReadoutLine = tuple[TextPiece, ...]
"""Pieces that are drawn beside each other; empty for no line."""


def text_of(line: ReadoutLine) -> str:
    """Return a line as plain text."""
    return " ".join(piece.text for piece in line)


class ReadoutText(NamedTuple):
    """The text of a score: headline, error, change, reference of the change, and further lines."""

    headline: str
    error: str
    change: str
    sense: int
    against: str
    lines: tuple[ReadoutLine, ...]


def nats_text(entropy: float, change: float | None = None) -> str:
    """Return an entropy, and its change where there is one, as panel and read-out show them."""
    return f"{entropy:.3f}" if change is None else f"{entropy:.3f}  ({change:+.3f})"


def readout_of(score: LiveScore | None, shown: ShownScore) -> ReadoutText:
    """Return the text of the score that is shown: a preview, an exact or a stored one.

    Changes are those of the live score, from sample to sample; of a stored search, its own.
    """
    change, sense, against = "", SAME, ""
    lines: tuple[ReadoutLine, ...] = ((TextPiece(f"Coverage {shown.coverage:.1%}"),),)
    if score is not None:
        now, before = score.summary, score.before
        what = "Coverage" if now.voxels else "Objects visible:"
        by = None if before is None else 100.0 * (now.coverage - before.coverage)
        lines = ((TextPiece(f"{what} {shown.coverage:.1%}"), *change_of(by, 1)),)
        if now.ap is not None:
            by = None if before is None or before.ap is None else now.ap - before.ap
            lines += ((TextPiece(f"Expected AP {now.ap:.3f}"), *change_of(by, 3)),)
        lines += tuple(zone_lines(now, before))
        if before is not None and score.baseline is not None:
            change, sense = entropy_change(now.entropy, before.entropy)
            against = f"compared with {shortened(score.baseline.label)}"
    if shown.before is not None:
        change, sense = entropy_change(shown.entropy, shown.before)
        against = f"compared with {BEFORE_SEARCH}"
    headline = f"{nats_text(shown.entropy)} nats"
    return ReadoutText(headline, state_of(shown), change, sense, against, lines)


def state_of(shown: ShownScore) -> str:
    """Return a score's error, and what it is of: the idle scene, a preview, a stored result."""
    state = "as scored" if shown.stored else "exact" if shown.exact else "preview"
    if shown.state:
        state += f", state {shown.state}"
    if shown.view_outdated:
        state += ", beams and maps follow"
    whole = shown.stored and not shown.stderr
    return f"on all voxels, {state}" if whole else f"± {max(shown.stderr, 1e-3):.3f}  {state}"


def shortened(name: str) -> str:
    """Return a name that fits into a row: its end is left out where it is too long."""
    return (
        name if len(name) <= MAX_LABEL_LETTERS else f"{name[: MAX_LABEL_LETTERS - 3].rstrip()}..."
    )


def entropy_change(now: float, before: float) -> tuple[str, int]:
    """Return how an entropy changed, and whether for the better; lower is better."""
    by = now - before
    if abs(by) < MIN_CHANGE:
        return "no change", SAME
    return f"{abs(by):.3f} {'worse' if by > 0.0 else 'better'}", WORSE if by > 0.0 else BETTER


def zone_lines(now: pe.Score, before: pe.Score | None) -> list[ReadoutLine]:
    """Return the zone that improved most, and the one that worsened most: at most a line each."""
    if before is None:
        return []
    common = [name for name in now.per_zone if name in before.per_zone]
    by = {name: now.per_zone[name].entropy - before.per_zone[name].entropy for name in common}
    lines: list[ReadoutLine] = []
    for word, sense in (("Better", BETTER), ("Worse", WORSE)):
        name = max(common, key=lambda zone: sense * by[zone], default=None)
        if name is not None and sense * by[name] >= MIN_ZONE_CHANGE:
            where = advice.WHERE.get(name, name)
            lines.append((TextPiece(f"{word} {where} by {abs(by[name]):.2f} nats", sense),))
    return lines


def figure_lines(figures: ShownFigures) -> tuple[ReadoutLine, ...]:
    """Return lines of the figures to show, with those that they are compared with."""
    if figures.now is None:
        return ((TextPiece(PENDING),),)
    found = [each for each in (figures.before, figures.now) if each is not None]
    return tuple(
        (TextPiece(n), TextPiece(text, sense)) for n, text, sense in rows_of_figures(found)
    )


class FigureRow(NamedTuple):
    """A row of the panel: name, text, and whether it tells a gain or a loss."""

    name: str
    text: str
    sense: int = SAME


def rows_of_figures(found: Sequence[advice.KeyFigures]) -> list[FigureRow]:
    """Return rows for the key figures of a rig, or of two rigs: before and now.

    The blind sector is the widest for any of the heights.
    """
    traffic = [figures.traffic for figures in found if figures.traffic is not None]
    aps = [f"{each.ap:.3f}" for each in traffic]
    error = f" ± {max(traffic[-1].stderr, 1e-3):.3f}" if len(traffic) == 1 else ""
    rings = traffic[-1].rings if traffic else {}
    by_ring = "   ".join(f"{ap:.2f}" for ap, _ in rings.values())
    widest = [max(figures.sectors, key=lambda sector: sector.width) for figures in found]
    widths = [wording.degrees(sector.width) for sector in widest]
    tall = f" ({widest[0].height:g} m tall)" if len(found) == 1 and widest[0].width else ""
    areas = [f"{math.ceil(10.0 * figures.blind_m2) / 10.0:.1f}" for figures in found]
    blind = [figures.blind_m2 for figures in found]
    reached = [figures for figures in found if figures.reach_m is not None]
    reaches = [f.reach_m for f in reached if f.reach_m is not None]
    metres = [f"{'≥ ' if f.at_least else ''}{f.reach_m:.0f} m" for f in reached]
    whose = f" ({reached[-1].class_name})" if reached else ""
    return [
        FigureRow("AP in Traffic", _from_to(aps, error), _sense([-t.ap for t in traffic], 5e-4)),
        FigureRow(", ".join(rings or ("near", "mid", "far")).title(), by_ring or NO_FIGURE),
        FigureRow("Blind Sector", _from_to(widths, tall), _sense([s.width for s in widest], 1.0)),
        FigureRow("Blind Ground", _from_to(areas, " m²"), _sense(blind, 0.05)),
        FigureRow("Reach Ahead", _from_to(metres, whose), _sense([-m for m in reaches], 0.5)),
    ]


def _from_to(texts: Sequence[str], after: str) -> str:
    return f"{ARROW.join(texts)}{after}" if texts else NO_FIGURE


def _sense(values: Sequence[float], least: float) -> int:
    """Return whether a low figure became lower or higher, by more than `least`."""
    by = values[-1] - values[0] if values else 0.0
    return SAME if abs(by) < least else WORSE if by > 0.0 else BETTER


def change_of(by: float | None, digits: int, *, lower_is_better: bool = False) -> ReadoutLine:
    """Return "(+1.2)" as a gain or a loss; nothing where the change is 0 in these digits."""
    text = "" if by is None else f"{by:+.{digits}f}"
    if by is None or not text.strip("+-0."):
        return ()
    sense = BETTER if (by < 0.0) == lower_is_better else WORSE
    return (TextPiece(f"({text.replace('-', MINUS)})", sense),)
