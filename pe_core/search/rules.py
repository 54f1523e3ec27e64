"""What a placement must not break, each rule with the words that tell of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from ..scene.geometry import FARTHEST_M, dot
from ..scene.housing import cuts_body
from ..scene.hulls import Hull, hull_box, hull_of, meet
from ..scene.outside import is_enclosed, is_open
from ..scene.sensors import Rig
from ..scene.vehicle import Vehicle
from .axes import HELD_M, POSITION_AXES
from .domains import Domain, OnSurface
from .mounts import NoGo, SlotMount, SurfaceMount
from .search_space import SearchSpace

SETTLED_M = 1e-3
"""What is nearer to a surface than its stand-off by less than this is no nearer [m]."""
SPAN = (-FARTHEST_M, FARTHEST_M)


@dataclass(frozen=True)
class Trial:
    """A placement that is looked at; the room of each sensor is worked out once."""

    rig: Rig
    space: SearchSpace
    _hulls: dict[str, Hull] = field(default_factory=dict)

    def hull(self, name: str) -> Hull:
        """Return the room that a sensor takes."""
        if name not in self._hulls:
            self._hulls[name] = hull_of(self.rig[name].pose, self.space.housings.get(name))
        return self._hulls[name]


@dataclass(frozen=True, slots=True)
class Rule:
    """Something that holds for a placement, or is broken."""

    words: str
    broken: Callable[[Trial], bool]


def rules_of(
    rig: Rig,
    space: SearchSpace,
    moving: Collection[str],
    clear: Collection[str],
    domains: dict[str, Domain],
) -> tuple[Rule, ...]:
    """Return the rules for a rig, those that are cheap to ask first.

    Sensors that do not move are as they are: of them only what is between them and others counts.
    Of those that are named `clear`, housings are kept clear.
    """
    names = [sensor.name for sensor in rig if sensor.name in moving]
    pairs = [
        (a.name, b.name) for a, b in combinations(rig, 2) if a.name in moving or b.name in moving
    ]
    rules = [rule for name in names for rule in _of_one(name, space)]
    rules += [rule for a, b in pairs for rule in _of_two(a, b, space, clear)]
    for name in names:
        domain = domains.get(name)
        if isinstance(domain, OnSurface) and domain.mount.standoff > SETTLED_M:
            rules.append(_stand_off(name, domain))
        if space.vehicle is not None and name in clear:
            rules.append(_body(name, space.vehicle))
    return tuple(rules)


def _of_one(name: str, space: SearchSpace) -> Iterator[Rule]:
    limits = space.mounting.constraints
    if (height := limits.max_height) is not None:
        top = height + HELD_M
        yield Rule(f"max_height of {name!r}", lambda t: t.hull(name).corners[:, 2].max() > top)
    if (width := limits.max_width) is not None:
        side = width / 2.0 + HELD_M
        yield Rule(
            f"max_width of {name!r}", lambda t: np.abs(t.hull(name).corners[:, 1]).max() > side
        )
    if isinstance(space.mounting.mount_of(name), SurfaceMount):
        yield from _bounds(name, space)
    for area in limits.no_go:
        yield _no_go(name, area)


def _bounds(name: str, space: SearchSpace) -> Iterator[Rule]:
    """Bounds of a sensor's coordinates that it is moved out of by its surface."""
    for number, axis in enumerate(POSITION_AXES):
        if axis in space.bounds.get(name, {}):
            low, high = space.bounds[name][axis]

            def outside(trial: Trial, k: int = number, lo: float = low, hi: float = high) -> bool:
                return not lo - HELD_M <= trial.rig[name].pose.position[k] <= hi + HELD_M

            yield Rule(f"bounds of {axis} of {name!r}", outside)


def _no_go(name: str, area: NoGo) -> Rule:
    sides = np.clip([getattr(area, axis) or SPAN for axis in "xyz"], *SPAN)
    box = hull_box(*sides.T)
    return Rule(f"no_go {area.name!r} for {name!r}", lambda trial: meet(trial.hull(name), box))


def _of_two(a: str, b: str, space: SearchSpace, clear: Collection[str]) -> Iterator[Rule]:
    mounting = space.mounting
    if least := mounting.constraints.min_distance:

        def near(trial: Trial) -> bool:
            one, other = (np.array(trial.rig[name].pose.position) for name in (a, b))
            return float(np.sqrt(dot(one - other, one - other))) < least - HELD_M

        yield Rule(f"min_distance of {a!r} and {b!r}", near)
    shared = mounting.on.get(a) == mounting.on.get(b)
    if shared and isinstance(mounting.mount_of(a), SlotMount):
        yield Rule(f"one slot for {a!r} and {b!r}", lambda t: t.rig[a].pose == t.rig[b].pose)
    known = a in space.housings or b in space.housings
    if known and (a in clear or b in clear):
        words = f"clear housings of {a!r} and {b!r}"
        yield Rule(words, lambda trial: meet(trial.hull(a), trial.hull(b)))


def _stand_off(name: str, domain: OnSurface) -> Rule:
    """In a hollow, the surface may be nearer than where the sensor was put on it."""

    def near(trial: Trial) -> bool:
        base = domain.base(trial.rig[name].pose)
        return domain.skin.is_nearer(base, domain.mount.standoff - SETTLED_M)

    return Rule(f"standoff of {name!r}", near)


def _body(name: str, vehicle: Vehicle) -> Rule:
    """A housing that cuts into the body, or a sensor that is inside it."""

    def inside(trial: Trial) -> bool:
        sensor = trial.rig[name]
        housing, position = trial.space.housings.get(name), np.array(sensor.pose.position)
        if housing is not None and cuts_body(sensor.pose, housing, vehicle):
            return True
        through_glass = sensor.model.sees_through_glass
        return not is_open(vehicle, position) and is_enclosed(vehicle, position, through_glass)

    return Rule(f"the body for {name!r}", inside)
