"""The best-so-far curve as plain numbers: steps in a unit square, and what its axes say."""

from __future__ import annotations

from dataclasses import dataclass

from .latest import SearchView

LEAST_SPAN = 0.01
"""The entropy's axis covers no less than this [nats]: noise is not to look like progress."""
CurvePoints = tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class SearchCurve:
    """A staircase from the start to now.

    `points` go from (0, 1), the start, to the right; 1 is the axis' upper end. `low`, `high` and
    `last` are its ends' words, `title` and `aside` those above it.
    """

    points: CurvePoints
    low: str
    high: str
    last: str
    title: str
    aside: str


def curve_of(seen: SearchView) -> SearchCurve:
    """Return the curve of a search; every point is a placement that became the best."""
    entropies = [entropy for _, entropy in seen.points]
    high, best = max(entropies), entropies[-1]
    low = min(min(entropies), high - LEAST_SPAN)
    last = max(seen.tried, seen.points[-1][0], 2)
    shown: list[tuple[float, float]] = []
    for tried, entropy in seen.points:
        across, up = (tried - 1) / (last - 1), (entropy - low) / (high - low)
        shown += [(across, shown[-1][1])] if shown else []
        shown.append((across, up))
    shown.append((1.0, shown[-1][1]))
    about = "\N{ALMOST EQUAL TO} " if seen.sampled else ""
    title, aside = f"Best so far {about}{best:.3f} nats", f"from {entropies[0]:.3f}"
    return SearchCurve(
        tuple(shown), f"{low:.2f}", f"{high:.2f}", f"{last:,} placements", title, aside
    )
