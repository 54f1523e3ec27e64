"""A rig as figures look at it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from ..base.values import rounded
from ..scene.rig import Rig
from ..scoring.sight.blind_ground import BLIND_TO_M, BlindSector
from .placement import Placement

if TYPE_CHECKING:
    from ..scoring import RigEvaluator
    from ..scoring.requirements import Verdict
    from ..scoring.score import TrafficAp
    from ..scoring.sight import Sight


def blind_height(sight: Sight) -> float:
    """Return the height for which blind ground is computed [m]: the space may begin above it."""
    return max(BLIND_TO_M, sight.space.z[0])


@dataclass(frozen=True, slots=True)
class Scorers:
    """What scores rigs of a study, and holds them to its requirements.

    `entropy`: What its search minimises without constraints.
    `voxels, objects`: Evaluators of losses of entropy, and of expected AP.
    """

    entropy: Callable[[Rig], float]
    voxels: RigEvaluator
    objects: RigEvaluator
    verdicts: Callable[[Rig], Sequence[Verdict]]


class RigView:
    """A rig as figures look at it: what several figures share is computed once, when it is asked
    for. `sight` is that of the rig's study; without `scorers` no figure of a score is known."""

    def __init__(self, sight: Sight, rig: Rig, scorers: Scorers | None = None) -> None:
        self.sight = sight
        self.rig = rig
        self._scorers = scorers

    @property
    def entropy(self) -> Sequence[float]:
        """What the search of the study minimises [nats]."""
        return [] if self._scorers is None else [self._scorers.entropy(self.rig)]

    @property
    def ap(self) -> Sequence[float]:
        """Expected AP of the scored objects; none for voxels."""
        found = None if self._scorers is None else self._scorers.objects.summary(self.rig).ap
        return [] if found is None else [found]

    @property
    def losses(self) -> Sequence[float]:
        """Rise of entropy without each sensor [nats]; none for a single one."""
        if self._scorers is None or len(self.rig) < 2:
            return []
        whole, *lost = self._scorers.voxels.entropies([self.rig, *self.rig.without_each()])
        return [each - whole for each in lost]

    @cached_property
    def verdicts(self) -> Sequence[Verdict]:
        """On the requirements of the study."""
        return () if self._scorers is None else self._scorers.verdicts(self.rig)

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
