"""The schedule of Algorithm 1: how far candidates lie, and how many there are."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import InputError
from ..scene.geometry import FARTHEST_M
from ..text.values import Angle, Number, Whole

MOST_ROUNDS = 1000
"""A schedule of more rounds (the paper's has seven) is taken for a slip of the pen."""
RULES: dict[str, Number | Whole] = {
    "candidates": Whole(1, 10_000_000),
    "reach_m": Number(0.0, cap=FARTHEST_M, unit="m", noun="length"),
    "reach_rad": Angle(0.0, cap=360.0),
    "floor_m": Number(0.0, above=True, cap=FARTHEST_M, unit="m", noun="length"),
    "floor_rad": Angle(0.0, above=True, cap=360.0),
    "decay": Number(0.0, 1.0, above=True, below=True),
}


@dataclass(frozen=True, slots=True)
class Schedule:
    """Neighbourhoods and candidates of Algorithm 1; the paper's by default.

    Parameters
    ----------
    candidates : int
        Placements tried in each round.
    reach_m, reach_rad : float
        Half width of the first neighbourhood.
    floor_m, floor_rad : float
        The search ends when a neighbourhood is at or below this.
    decay : float
        k: each neighbourhood is this times the one before.

    Raises
    ------
    InputError
        When a number is out of its range, or the rounds are more than 1000.
    """

    candidates: int = 1000
    reach_m: float = 1.0
    reach_rad: float = math.radians(30.0)
    floor_m: float = 0.01
    floor_rad: float = math.radians(0.3)
    decay: float = 0.5

    def __post_init__(self) -> None:
        for name, rule in RULES.items():
            object.__setattr__(self, name, rule.checked("optimize", name, getattr(self, name)))
        if self._rounds_m > MOST_ROUNDS or self._rounds_rad > MOST_ROUNDS:
            rounds = max(self._rounds_m, self._rounds_rad)
            expected = f"at most {MOST_ROUNDS} rounds from reach to floor"
            raise InputError("optimize", "decay", expected, f"{rounds:.4g}")

    @property
    def scales(self) -> list[float]:
        """Factor on the first neighbourhood in each round: 1, k, k^2, ... (seven in the paper)."""
        scales, scale = [], 1.0
        while scale * self.reach_m > self.floor_m or scale * self.reach_rad > self.floor_rad:
            scales.append(scale)
            scale *= self.decay
        return scales

    @property
    def _rounds_m(self) -> float:
        return _rounds(self.reach_m, self.floor_m, self.decay)

    @property
    def _rounds_rad(self) -> float:
        return _rounds(self.reach_rad, self.floor_rad, self.decay)


def _rounds(reach: float, floor: float, decay: float) -> float:
    """About how many rounds it takes from reach to floor."""
    if reach <= floor:
        return 0.0
    return (math.log(reach) - math.log(floor)) / -math.log(decay)
