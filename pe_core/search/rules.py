"""The rules that no placement may break, each with its text for messages."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from ..geometry.overlap import Hull, hull_box, overlaps
from ..geometry.poses import FARTHEST_M, dot
from ..scene.housing import cuts_body, hull_of
from ..scene.inside_test import is_enclosed, is_open
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from .design_variable import POSITION_AXES, ROUNDING_M
from .domains import Domain, SurfaceDomain
from .mounts import NoGo, SlotMount, SurfaceMount
from .search_space import SearchSpace

STANDOFF_TOLERANCE_M = 1e-3
"""How much nearer to its surface than its stand-off a sensor may be [m]."""
SPAN = (-FARTHEST_M, FARTHEST_M)


@dataclass(frozen=True)
class Trial:
    """A placement that is checked; the hull of each sensor is computed once."""

    rig: Rig
    space: SearchSpace
    _hulls: dict[str, Hull] = field(default_factory=dict)

    def hull(self, name: str) -> Hull:
        """Return the convex hull of a sensor's housing."""
        if name not in self._hulls:
            self._hulls[name] = hull_of(self.rig[name].pose, self.space.housings.get(name))
        return self._hulls[name]


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule that a placement keeps or breaks."""

    text: str
    broken: Callable[[Trial], bool]


def rules_of(
    rig: Rig,
    space: SearchSpace,
    moving: Collection[str],
    clear: Collection[str],
    domains: dict[str, Domain],
) -> tuple[Rule, ...]:
    """Return the rules for a rig, the cheap ones first.

    A sensor that does not move has no rules of its own, only those between it and moving sensors.
    Housings of the sensors named by `clear` must be clear of the body and of other housings.
    """
    names = [sensor.name for sensor in rig if sensor.name in moving]
    rules = [rule for name in names for rule in _of_one(name, space)]
    limits, mounts = space.mounting.constraints, space.mounting.mounts.values()
    has_slots = any(isinstance(mount, SlotMount) for mount in mounts)
    if limits.min_distance or has_slots or (space.housings and clear):  # else millions for nothing
        pairs = combinations([sensor.name for sensor in rig], 2)
        moved = ((a, b) for a, b in pairs if a in moving or b in moving)
        rules += [rule for a, b in moved for rule in _of_two(a, b, space, clear)]
    for name in names:
        domain = domains.get(name)
        if isinstance(domain, SurfaceDomain) and domain.mount.standoff > STANDOFF_TOLERANCE_M:
            rules.append(_stand_off(name, domain))
        if space.vehicle is not None and name in clear:
            rules.append(_body(name, space.vehicle))
    return tuple(rules)


def _of_one(name: str, space: SearchSpace) -> Iterator[Rule]:
    limits = space.mounting.constraints
    if (height := limits.max_height) is not None:
        top = height + ROUNDING_M
        yield Rule(f"max_height of {name!r}", lambda t: t.hull(name).corners[:, 2].max() > top)
    if (width := limits.max_width) is not None:
        side = width / 2.0 + ROUNDING_M
        yield Rule(
            f"max_width of {name!r}", lambda t: np.abs(t.hull(name).corners[:, 1]).max() > side
        )
    if isinstance(space.mounting.mount_of(name), SurfaceMount):
        yield from _bounds(name, space)
    for area in limits.no_go:
        yield _no_go(name, area)


def _bounds(name: str, space: SearchSpace) -> Iterator[Rule]:
    """Yield the bounds of a sensor's coordinates on a surface, which may lead out of them."""
    for number, axis in enumerate(POSITION_AXES):
        if axis in space.bounds.get(name, {}):
            low, high = space.bounds[name][axis]

            def outside(trial: Trial, k: int = number, lo: float = low, hi: float = high) -> bool:
                return not lo - ROUNDING_M <= trial.rig[name].pose.position[k] <= hi + ROUNDING_M

            yield Rule(f"bounds of {axis} of {name!r}", outside)


def _no_go(name: str, area: NoGo) -> Rule:
    sides = np.clip([getattr(area, axis) or SPAN for axis in "xyz"], *SPAN)
    box = hull_box(*sides.T)
    return Rule(f"no_go {area.name!r} for {name!r}", lambda trial: overlaps(trial.hull(name), box))


def _of_two(a: str, b: str, space: SearchSpace, clear: Collection[str]) -> Iterator[Rule]:
    mounting = space.mounting
    if min_distance := mounting.constraints.min_distance:

        def near(trial: Trial) -> bool:
            one, other = (np.array(trial.rig[name].pose.position) for name in (a, b))
            return float(np.sqrt(dot(one - other, one - other))) < min_distance - ROUNDING_M

        yield Rule(f"min_distance of {a!r} and {b!r}", near)
    same_mount = mounting.on.get(a) == mounting.on.get(b)
    if same_mount and isinstance(mounting.mount_of(a), SlotMount):
        yield Rule(f"one slot for {a!r} and {b!r}", lambda t: t.rig[a].pose == t.rig[b].pose)
    has_housing = a in space.housings or b in space.housings
    if has_housing and (a in clear or b in clear):
        text = f"clear housings of {a!r} and {b!r}"
        yield Rule(text, lambda trial: overlaps(trial.hull(a), trial.hull(b)))


def _stand_off(name: str, domain: SurfaceDomain) -> Rule:
    """Return the rule of the stand-off: in a hollow, the surface may be nearer elsewhere."""

    def near(trial: Trial) -> bool:
        base = domain.base(trial.rig[name].pose)
        return domain.surface.is_nearer(base, domain.mount.standoff - STANDOFF_TOLERANCE_M)

    return Rule(f"standoff of {name!r}", near)


def _body(name: str, vehicle: Vehicle) -> Rule:
    """Return the rule that a housing does not cut the body, and that a sensor is not inside it."""

    def inside(trial: Trial) -> bool:
        sensor = trial.rig[name]
        housing, position = trial.space.housings.get(name), np.array(sensor.pose.position)
        if housing is not None and cuts_body(sensor.pose, housing, vehicle):
            return True
        through_glass = sensor.model.sees_through_glass
        return not is_open(vehicle, position) and is_enclosed(vehicle, position, through_glass)

    return Rule(f"the body for {name!r}", inside)
