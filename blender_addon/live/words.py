"""A live reading in words: what a designer reads at a glance. Plain text, no Blender."""

from __future__ import annotations

from typing import NamedTuple

from ..engine import advice, pe
from .latest import Reading
from .shown import ShownScore

LEAST_CHANGE = 0.0005
"""Entropies nearer than this read the same in four places [nats]."""
LEAST_ZONE_CHANGE = 0.005
"""A zone is worth a word from here on [nats]."""
BETTER, SAME, WORSE = -1, 0, 1
LONGEST_LABEL = 32
"""Letters of a variant's name that the read-out has room for."""


class ReadoutText(NamedTuple):
    """What the read-out says: a headline, how it changed, against what, and lines below."""

    headline: str
    error: str
    change: str
    sense: int
    against: str
    lines: tuple[str, ...]


def words_of(reading: Reading, shown: ShownScore) -> ReadoutText:
    """Put a reading into words, and the score that is shown of it: a preview, exact, or stored.

    What changed is told of the live score, from sample to sample.
    """
    now, before = reading.glance, reading.before
    change, sense = change_of(now.entropy, before.entropy) if before else ("", SAME)
    what = "of where objects are is seen" if now.voxels else "of the objects are seen"
    seen = f"{shown.coverage:.1%} {what}{points(now, before)}"
    return ReadoutText(
        f"{shown.entropy:.3f} nats",
        state_of(shown, reading.moved_m),
        change,
        sense,
        f"compared with {short(reading.reference.label)}" if before else "",
        (seen, *zone_lines(now, before)),
    )


def state_of(shown: ShownScore, moved_m: float) -> str:
    """Say a score's error, and what it is of: the scene at rest, a preview, or a stored result."""
    state = "as scored" if shown.stored else "at rest" if shown.exact else "preview"
    if moved_m and not shown.stored:
        state += f", body simplified to {1000.0 * moved_m:.0f} mm"
    if shown.picture_follows:
        state += ", beams and maps follow"
    whole = shown.stored and not shown.stderr
    return f"on all voxels, {state}" if whole else f"± {max(shown.stderr, 1e-3):.3f}  {state}"


def short(name: str) -> str:
    """Return a name that fits into a row: its end is left out where it is too long."""
    return name if len(name) <= LONGEST_LABEL else f"{name[: LONGEST_LABEL - 3].rstrip()}..."


def change_of(now: float, before: float) -> tuple[str, int]:
    """How an entropy changed, and which way; lower is better."""
    by = now - before
    if abs(by) < LEAST_CHANGE:
        return "no change", SAME
    return f"{abs(by):.3f} {'worse' if by > 0.0 else 'better'}", WORSE if by > 0.0 else BETTER


def points(now: pe.Glance, before: pe.Glance | None) -> str:
    """How a share changed, in points of a hundred; nothing where that is none."""
    by = 0.0 if before is None else round(100.0 * (now.coverage - before.coverage), 1)
    return f" ({by:+.1f})".replace("-", "\N{MINUS SIGN}") if by else ""


def zone_lines(now: pe.Glance, before: pe.Glance | None) -> list[str]:
    """Where it got better most, and where worse: at most a line each."""
    if before is None:
        return []
    common = [name for name in now.per_zone if name in before.per_zone]
    by = {name: now.per_zone[name].entropy - before.per_zone[name].entropy for name in common}
    found = []
    for word, sign in (("Better", -1.0), ("Worse", 1.0)):
        name = max(common, key=lambda each: sign * by[each], default=None)
        if name is not None and sign * by[name] >= LEAST_ZONE_CHANGE:
            found.append(f"{word} {advice.WHERE.get(name, name)} by {abs(by[name]):.2f} nats")
    return found
