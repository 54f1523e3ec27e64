"""A rig as figures look at it."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from ..base.values import rounded
from ..scene.rig import Rig
from ..scoring.sight.blind_ground import BLIND_TO_M, BlindSector
from .placement import Placement

if TYPE_CHECKING:
    from ..scoring.score import TrafficAp
    from ..scoring.sight import Sight


def blind_height(sight: Sight) -> float:
    """Return the height for which blind ground is computed [m]: the space may begin above it."""
    return max(BLIND_TO_M, sight.space.z[0])


class RigView:
    """A rig as figures look at it: what several figures share is computed once, when it is asked
    for. `sight` is that of the rig's study."""

    def __init__(self, sight: Sight, rig: Rig) -> None:
        self.sight = sight
        self.rig = rig

    @cached_property
    def traffic(self) -> TrafficAp | None:
        """Expected AP in traffic; None where the prior's objects have no room."""
        return self.sight.in_traffic(self.rig)

    @cached_property
    def sectors(self) -> tuple[BlindSector, ...]:
        """The widest blind sector for bodies of each height."""
        return self.sight.blind_sectors(self.rig)

    @cached_property
    def blind_m2(self) -> float:
        """Ground within 10 m of the body where a child is invisible [m2], never too small. It is
        the area of `Sight.blind` for a body of `BLIND_TO_M`, or of the lowest height of the space
        if that is greater."""
        return rounded(self.sight.blind_area(self.rig, blind_height(self.sight)))

    @cached_property
    def reach(self) -> dict[str, tuple[float, bool]]:
        """By class how far ahead it is found [m], and whether that ends with the space. Empty where
        objects are scored: that score has their reach."""
        if self.sight.targets.are_objects:
            return {}
        names = self.sight.prior.class_names
        return {name: self.sight.reach_ahead(self.rig, name) for name in names}

    @cached_property
    def placement(self) -> Placement:
        """The rig on its vehicle, with its housings."""
        return Placement.on(self.rig, self.sight.vehicle)
