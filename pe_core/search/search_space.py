"""The space of a search: free coordinates, their bounds, neighbourhoods of Algorithm 1, and rules.

A rule is what no placement may break, with its text for messages.
"""

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np

from ..base.arrays import ReadOnlyDict
from ..base.errors import InputError, require_name, shown
from ..base.notebook import ShortRepr
from ..base.setting import Panel, check_settings, setting
from ..base.values import Whole, listed, pair
from ..geometry.overlap import hull_box, overlaps
from ..geometry.poses import FARTHEST_M, METRES, ROTATION
from ..scene.rig import Housing, Rig, Sensor, cuts_body
from ..scene.vehicle import Vehicle, is_enclosed, is_open
from .build_figures import BUILD_FIGURES
from .domains import (
    AXES,
    POSITION_AXES,
    ROUNDING_M,
    ROUNDING_RAD,
    Domain,
    SurfaceDomain,
    pose_values,
    start_values,
)
from .limit import FigureLimits
from .mounts import Mounting, NoGo, SlotMount, SurfaceMount
from .placement import Placement

PAPER_FREE = ("x", "y", "z", "pitch")
"""What the paper searches; roll and yaw are fixed "for symmetry of the placement"."""
HEADROOM_M = 0.75  # How far above the vehicle's top a sensor may be mounted by default
MIN_HEIGHT_M = 0.2  # The least height of a sensor by default
REACH_M = 1.0
REACH_RAD = math.radians(30.0)
"""Half widths of the first neighbourhood of Algorithm 1 [m, rad]."""
FLOOR_M = 0.01
FLOOR_RAD = math.radians(0.3)
"""It ends when a neighbourhood is at or below both: mounts are not made more exactly."""
DECAY = 0.5  # Each neighbourhood of Algorithm 1 over the one before, k
Bounds = tuple[float, float]
STANDOFF_TOLERANCE_M = 1e-3
"""How much nearer to its surface than its stand-off a sensor may be [m]."""
SPAN = (-FARTHEST_M, FARTHEST_M)


@dataclass(frozen=True, slots=True)
class SearchSpace(ShortRepr):
    """The free coordinates of each sensor, and their bounds.

    Parameters
    ----------
    bounds : mapping of sensor name to mapping of axis to (low, high)
        Axes are "x", "y", "z" [m] and "roll", "pitch", "yaw" [rad]; an axis that is not named
        is fixed. On a surface, angles are relative to the mount's frame, and x, y, z bound the
        sensor's position on it.
    mounting : Mounting
        Mounts, pairs, groups and constraints.
    vehicle : Vehicle, optional
        The body that has the mounts, and that housings must be clear of.
    housings : mapping of sensor name to Housing
        The housings that are known.
    fixed : sequence of str
        Sensors that stay where they are, with those that follow them.
    figure_limits : Limits
        Those on what can be built hold for every placement.
    """

    bounds: Mapping[str, Mapping[str, Bounds]] = field(default_factory=dict)
    mounting: Mounting = field(default_factory=Mounting)
    vehicle: Vehicle | None = None
    housings: Mapping[str, Housing] = field(default_factory=dict)
    fixed: Sequence[str] = ()
    figure_limits: FigureLimits = field(default_factory=FigureLimits)

    def __post_init__(self) -> None:
        for name in ("bounds", "housings"):
            if not isinstance(table := getattr(self, name), Mapping):
                raise InputError("search space", name, "a mapping by sensor", shown(table))
            object.__setattr__(self, name, ReadOnlyDict(table))

    @classmethod
    def on_vehicle(
        cls,
        rig: Rig,
        vehicle: Vehicle | None,
        free: Mapping[str, tuple[str, ...]] | tuple[str, ...] = PAPER_FREE,
        limits: Mapping[str, Mapping[str, Bounds]] | None = None,
        mounting: Mounting | None = None,
        housings: Mapping[str, Housing] | None = None,
        fixed: Sequence[str] = (),
        figure_limits: FigureLimits | None = None,
    ) -> "SearchSpace":
        """Return a rig's free axes within the vehicle's outline and HEADROOM_M above it.

        Parameters
        ----------
        vehicle : Vehicle or None
            Without a vehicle, sensors may move `REACH_M` from their start.
        limits : mapping, optional
            Bounds that replace the default ones, by sensor and axis.
        mounting : Mounting, optional
            A sensor on a surface moves on it, whichever of x, y, z are free; a sensor in a slot, or
            one that follows another, has no bounds.
        """
        limits = limits or {}
        mounting = mounting or Mounting()
        bounds = {}
        for sensor in rig:
            axes = free if isinstance(free, tuple) else free.get(sensor.name, PAPER_FREE)
            given = limits.get(sensor.name, {})
            default = default_bounds(sensor, vehicle)
            if given and (reason := mounting.unbounded(sensor.name)):
                raise InputError(
                    f"sensor {sensor.name!r}", "bounds", f"no bounds for {reason}", "bounds"
                )
            if mounting.unbounded(sensor.name):
                axes = ()
            elif mounting.mount_of(sensor.name) is not None:  # positions only with given bounds
                turns = (axis for axis in axes if axis not in POSITION_AXES)
                axes = (*(axis for axis in POSITION_AXES if axis in given), *turns)
            bounds[sensor.name] = {a: given.get(a, default[a]) for a in axes}
        space = cls(
            bounds,
            mounting,
            vehicle,
            housings or {},
            fixed=fixed,
            figure_limits=figure_limits or FigureLimits(),
        )
        return space.checked(rig)

    def placement(self, rig: Rig) -> Placement:
        """Return a rig on the vehicle, as rules see it."""
        return Placement(rig, self.vehicle, self.housings)

    def checked(self, rig: Rig) -> "SearchSpace":
        """Return itself, or raise `InputError` when a name, an axis or a start is not possible."""
        sensors = {sensor.name: sensor for sensor in rig}
        for name, axes in self.bounds.items():
            require_name("search space", "sensor", name, sensors)
            if self.mounting.mount_of(name) is not None:
                continue  # its angles are relative to its mount, whose domain checks them
            start = start_values(pose_values(sensors[name].pose), axes)
            for axis, bounds in axes.items():
                low, high = checked_bounds(name, axis, bounds)
                rounding = ROUNDING_M if axis in POSITION_AXES else ROUNDING_RAD
                if not low - rounding <= start[axis] <= high + rounding:
                    expected = f"bounds around the start, {_shown(axis, start[axis])}"
                    found = f"{_shown(axis, low)} to {_shown(axis, high)}"
                    raise InputError(name, f"bounds of {axis}", expected, found)
        return self


def checked_axes(source: str, field: str, axes: Any) -> tuple[str, ...]:
    """Return names of axes, or raise `InputError`."""
    names = listed(axes)
    if names is None:
        raise InputError(source, field, f"some of {', '.join(AXES)}", shown(axes))
    for name in names:
        if name not in AXES:
            raise InputError(source, field, f"some of {', '.join(AXES)}", shown(name))
    return tuple(names)


def checked_bounds(source: str, axis: str, bounds: Any) -> Bounds:
    """Return the bounds of an axis, (low, high) [m or rad], or raise `InputError`."""
    checked_axes(source, "bounds", (axis,))
    rule = METRES if axis in POSITION_AXES else ROTATION
    return pair(source, f"bounds of {axis}", bounds, rule, same=True)


def default_bounds(sensor: Sensor, vehicle: Vehicle | None) -> dict[str, Bounds]:
    """Return the bounds of each axis without given ones; they always contain the start."""
    start = pose_values(sensor.pose)
    if vehicle is None:
        around = {a: (start[a] - REACH_M, start[a] + REACH_M) for a in POSITION_AXES}
        bounds = {a: (max(lo, -FARTHEST_M), min(hi, FARTHEST_M)) for a, (lo, hi) in around.items()}
    else:
        low, high = vehicle.bounds
        bounds = {a: (float(low[k]), float(high[k])) for k, a in enumerate("xy")}
        bounds["z"] = (MIN_HEIGHT_M, min(float(high[2]) + HEADROOM_M, FARTHEST_M))
    bounds |= {"roll": (-math.pi, math.pi), "yaw": (-math.pi, math.pi)}
    bounds["pitch"] = (-math.pi / 2, math.pi / 2)
    return {a: (min(lo, start[a]), max(hi, start[a])) for a, (lo, hi) in bounds.items()}


def _shown(axis: str, value: float) -> str:
    return f"{value:g} m" if axis in POSITION_AXES else f"{math.degrees(value):g} deg"


@dataclass(frozen=True, slots=True)
class Schedule:
    """Candidates in each round of Algorithm 1; its neighbourhoods are the paper's. `InputError`
    when the number is out of its range."""

    candidates: int = setting(
        1000,
        Whole(1, 10_000_000),
        "Placements in each round of a search; the paper has 1000",
        Panel("candidates", "Candidates", default=150, soft_max=1000),
    )

    def __post_init__(self) -> None:
        check_settings(self, "optimize")

    @property
    def scales(self) -> list[float]:
        """Factor on the first neighbourhood in each round: 1, k, k^2, ...: seven."""
        scales = []
        scale = 1.0
        while scale * REACH_M > FLOOR_M or scale * REACH_RAD > FLOOR_RAD:
            scales.append(scale)
            scale *= DECAY
        return scales


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule that a placement keeps or breaks."""

    text: str
    broken: Callable[[Placement], bool]


def rules_of(
    rig: Rig,
    space: SearchSpace,
    moving: Set[str],
    clear: Collection[str],
    domains: dict[str, Domain],
) -> tuple[Rule, ...]:
    """Return the rules for a rig, the cheap ones first. A sensor that does not move has no rules of
    its own, only those between it and moving sensors. Housings of the sensors named by `clear` must
    be clear of the body and of other housings."""
    names = [sensor.name for sensor in rig if sensor.name in moving]
    start = space.placement(rig)
    rules = [
        Rule(text, broken)
        for figure in BUILD_FIGURES.values()
        if (limit := space.figure_limits.kept(figure.key)) is not None
        for text, broken in figure.rules(limit.value, start, moving)
    ]
    rules += [rule for name in names for rule in _of_one(name, space)]
    has_slots = any(isinstance(mount, SlotMount) for mount in space.mounting.mounts.values())
    if has_slots or (space.housings and clear):  # else millions for nothing
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
    if isinstance(space.mounting.mount_of(name), SurfaceMount):
        yield from _bounds(name, space)
    for area in space.mounting.constraints.no_go:
        yield _no_go(name, area)


def _bounds(name: str, space: SearchSpace) -> Iterator[Rule]:
    """Yield the bounds of a sensor's coordinates on a surface, which may lead out of them."""
    for number, axis in enumerate(POSITION_AXES):
        if axis in space.bounds.get(name, {}):
            low, high = space.bounds[name][axis]

            def outside(at: Placement, k: int = number, lo: float = low, hi: float = high) -> bool:
                return not lo - ROUNDING_M <= at.rig[name].pose.position[k] <= hi + ROUNDING_M

            yield Rule(f"bounds of {axis} of {name!r}", outside)


def _no_go(name: str, area: NoGo) -> Rule:
    sides = np.clip([getattr(area, axis) or SPAN for axis in "xyz"], *SPAN)
    box = hull_box(*sides.T)
    return Rule(f"no_go {area.name!r} for {name!r}", lambda trial: overlaps(trial.hull(name), box))


def _of_two(a: str, b: str, space: SearchSpace, clear: Collection[str]) -> Iterator[Rule]:
    mounting = space.mounting
    same_mount = mounting.on.get(a) == mounting.on.get(b)
    if same_mount and isinstance(mounting.mount_of(a), SlotMount):
        yield Rule(f"one slot for {a!r} and {b!r}", lambda t: t.rig[a].pose == t.rig[b].pose)
    has_housing = a in space.housings or b in space.housings
    if has_housing and (a in clear or b in clear):
        text = f"clear housings of {a!r} and {b!r}"
        yield Rule(text, lambda trial: overlaps(trial.hull(a), trial.hull(b)))


def _stand_off(name: str, domain: SurfaceDomain) -> Rule:
    """Return the rule of the stand-off: in a hollow, the surface may be nearer elsewhere."""

    def near(trial: Placement) -> bool:
        base = domain.base(trial.rig[name].pose)
        return domain.surface.is_nearer(base, domain.mount.standoff - STANDOFF_TOLERANCE_M)

    return Rule(f"standoff of {name!r}", near)


def _body(name: str, vehicle: Vehicle) -> Rule:
    """Return the rule that a housing does not cut the body, and that a sensor is not inside it."""

    def inside(trial: Placement) -> bool:
        sensor = trial.rig[name]
        housing = trial.housings.get(name)
        position = np.array(sensor.pose.position)
        if housing is not None and cuts_body(sensor.pose, housing, vehicle):
            return True
        through_glass = sensor.model.sees_through_glass
        return not is_open(vehicle, position) and is_enclosed(vehicle, position, through_glass)

    return Rule(f"the body for {name!r}", inside)
