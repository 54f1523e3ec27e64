"""Figures that a design is defended by, beside entropy and coverage: in metres, m2 and AP."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from ..scene.sensors import Rig
from ..sight import Reach, Sight, ends_with_space
from .outlook import BLIND_TO_M, class_of


@dataclass(frozen=True, slots=True)
class KeyFigures:
    """Blind ground, reach ahead and expected AP of a rig.

    Attributes
    ----------
    blind_m2 : float
        Ground round the vehicle where nothing is seen of what is `height` tall [m2].
    height, within : float
        How tall that is, and how far from the body's rectangle it was looked [m].
    class_name : str or None
        Whose reach and AP these are. None where objects are judged in place of voxels: their score
        has both.
    reach_m : float or None
        Straight ahead of the origin, how far that class is found with an AP of 0.5 or more [m]; 0
        where it is not.
    at_least : bool
        Whether the space ends there, so that the reach is that far or farther.
    expected_ap : float or None
        Of that class, 0 to 1; None where the prior has none of it in the space.
    """

    blind_m2: float
    height: float
    within: float
    class_name: str | None = None
    reach_m: float | None = None
    at_least: bool = False
    expected_ap: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return them as plain JSON data."""
        return asdict(self)


def key_figures(
    sight: Sight,
    rig: Rig,
    height: float = BLIND_TO_M,
    class_name: str | None = None,
    *,
    of_voxels: bool = True,
) -> KeyFigures:
    """Return the key figures of a rig.

    Parameters
    ----------
    sight : Sight
    rig : Rig
    height : float
        For what is so tall blind ground is told [m]; at least the space's lowest height.
    class_name : str, optional
        Whose reach and AP are told; pedestrians' by default, the first class's where there are
        none.
    of_voxels : bool
        False where objects are judged: reach and AP are then those of the score.

    Raises
    ------
    InputError
        When the prior has no such class, or the height is not in the space.
    """
    name = class_of(sight.prior, class_name)
    blind = sight.blind(rig, max(height, sight.space.z[0]))
    of_ground = blind.area, blind.height, blind.within
    if not of_voxels:
        return KeyFigures(*of_ground)
    reach_m, at_least = ahead(sight.reach(rig, name))
    return KeyFigures(*of_ground, name, reach_m, at_least, sight.expected_ap(rig).get(name))


def ahead(reach: Reach) -> tuple[float, bool]:
    """Return the reach straight ahead [m], and whether the space ends there."""
    distance = float(reach.distance[0])  # bearings begin ahead
    return distance, distance > 0.0 and bool(ends_with_space(reach, reach.distance)[0])
