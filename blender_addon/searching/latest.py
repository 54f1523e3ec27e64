"""What is known of the search that runs in a scene: plain data, kept for who draws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..engine import pe


@dataclass(frozen=True, slots=True)
class SearchView:
    """Where a search is.

    `points` are the placements that became the best, (evaluation, entropy) each, the start first;
    `tried` placements were judged so far. `sensors` are the best placement; none while that is the
    start. Figures of a sample are about so good: `sampled`.
    """

    points: tuple[tuple[int, float], ...]
    tried: int
    sensors: tuple[pe.Sensor, ...] = ()
    sampled: bool = True


view: dict[str, SearchView] = {}
"""By the scene's name."""


def best(scene: str) -> tuple[pe.Sensor, ...]:
    """Return the sensors of the best placement so far, where that is no longer the start."""
    found = view.get(scene)
    return () if found is None else found.sensors


def drop(scene: str) -> None:
    """Show nothing of a search any more."""
    view.pop(scene, None)
