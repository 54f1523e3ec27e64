"""Blind ground as a constraint of a search: `[optimize] blind_ground = "keep"`.

A placement with more blind ground than the study's own is infeasible, like one that breaks a
requirement that is to be kept (`requirement_search`).
"""

from __future__ import annotations

from ..base.values import rounded
from ..geometry.grids import PerceptionSpace
from ..prior.prior import Prior
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from ..scoring.sight import BLIND_TO_M, Sight
from .study import Study


def blind_area(sight: Sight, rig: Rig) -> float:
    """Return the ground within 10 m of the body where a child is invisible to a rig [m2].

    It is the area of `Sight.blind` for a body of `BLIND_TO_M`, or of the lowest height of the space
    if that is greater. It is never too small.
    """
    return rounded(sight.blind_area(rig, max(BLIND_TO_M, sight.space.z[0])))


class BlindGroundLimit:
    """The constraint that a rig has no more blind ground than a limit.

    Parameters
    ----------
    space : PerceptionSpace
    prior : Prior
    vehicle : Vehicle or None
        As drawn, in no other state.
    limit_m2 : float
    """

    def __init__(
        self, space: PerceptionSpace, prior: Prior, vehicle: Vehicle | None, limit_m2: float
    ) -> None:
        self._problem = space, prior, vehicle
        self.limit_m2 = limit_m2
        self._sight = Sight(*self._problem)

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arguments: a worker has a `Sight` of its own."""
        return BlindGroundLimit, (*self._problem, self.limit_m2)

    @classmethod
    def of(cls, study: Study) -> BlindGroundLimit:
        """Return the constraint of a study's search: no more blind ground than its own rig has."""
        problem = study.space, study.prior, study.vehicle
        return cls(*problem, blind_area(study.sight(), study.rig))

    def violation(self, rig: Rig) -> float:
        """Return the share of a rig's blind ground above the limit: above 0 to 1; 0 if none is."""
        area = blind_area(self._sight, rig)
        return rounded(1.0 - self.limit_m2 / area) if area > self.limit_m2 else 0.0
