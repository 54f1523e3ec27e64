"""What a search may change: the free coordinates of each sensor, and their bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..errors import InputError, shown
from ..scene.geometry import FARTHEST_M, METRES, ROTATION
from ..scene.housing import Housing
from ..scene.sensors import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..text.fixed import FixedDict
from ..text.values import listed, pair
from .axes import AXES, HELD_M, HELD_RAD, POSITION_AXES, pose_values
from .mounts import Mounting
from .schedule import Schedule

PAPER_FREE = ("x", "y", "z", "pitch")
"""What the paper searches; roll and yaw are fixed "for symmetry of the placement"."""
HEADROOM_M = 0.75
"""How far above the vehicle's top a sensor may be put unless a study says otherwise."""
LOWEST_M = 0.2
"""No sensor is put lower than this unless a study says otherwise."""

Bounds = tuple[float, float]


@dataclass(frozen=True, slots=True)
class SearchSpace:
    """Which coordinates of which sensor are free, and how far they may go.

    Parameters
    ----------
    bounds : mapping of sensor name to mapping of axis to (low, high)
        Axes are "x", "y", "z" [m] and "roll", "pitch", "yaw" [rad]; what is not named is fixed.
        On a surface, angles are to the mount's frame, and x, y, z bound where it leads.
    mounting : Mounting
        Mounts, pairs, groups and constraints.
    vehicle : Vehicle, optional
        The body that mounts are parts of, and that housings are kept clear of.
    housings : mapping of sensor name to Housing
        Those that are known.
    """

    bounds: Mapping[str, Mapping[str, Bounds]] = field(default_factory=dict)
    mounting: Mounting = field(default_factory=Mounting)
    vehicle: Vehicle | None = None
    housings: Mapping[str, Housing] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "bounds", FixedDict(self.bounds))
        object.__setattr__(self, "housings", FixedDict(self.housings))

    @classmethod
    def on_vehicle(
        cls,
        rig: Rig,
        vehicle: Vehicle | None,
        free: Mapping[str, tuple[str, ...]] | tuple[str, ...] = PAPER_FREE,
        limits: Mapping[str, Mapping[str, Bounds]] | None = None,
        mounting: Mounting | None = None,
        housings: Mapping[str, Housing] | None = None,
    ) -> SearchSpace:
        """Free axes of each sensor within the vehicle's outline and HEADROOM_M above it.

        Parameters
        ----------
        rig : Rig
        vehicle : Vehicle or None
            Without one, sensors may go `Schedule.reach_m` from where they start.
        free : tuple of str, or mapping of sensor name to it
        limits : mapping, optional
            Bounds that replace the default ones, by sensor and axis.
        mounting : Mounting, optional
            A sensor on a surface moves in it, whatever is free of x, y, z; one in a slot, or that
            follows another, has no bounds of its own.
        housings : mapping of sensor name to Housing, optional
        """
        limits, mounting, bounds = limits or {}, mounting or Mounting(), {}
        for sensor in rig:
            axes = free if isinstance(free, tuple) else free.get(sensor.name, PAPER_FREE)
            own = limits.get(sensor.name, {})
            default = default_bounds(sensor, vehicle)
            if own and (words := mounting.unbounded(sensor.name)):
                raise InputError(f"sensor {sensor.name!r}", "bounds", f"none of {words}", "some")
            bounded = _bounded(sensor.name, axes, own, mounting)
            bounds[sensor.name] = {a: own.get(a, default[a]) for a in bounded}
        return cls(bounds, mounting, vehicle, housings or {}).checked(rig)

    def checked(self, rig: Rig) -> SearchSpace:
        """Return itself, or raise `InputError` when a name, an axis or a start is not possible."""
        for name, axes in self.bounds.items():
            if name not in [s.name for s in rig]:
                raise InputError("search space", "sensor", "a sensor of the rig", shown(name))
            if self.mounting.mount_of(name) is not None:
                continue  # its angles are to its mount, which looks at them itself
            start = pose_values(rig[name].pose)
            for axis, bounds in axes.items():
                low, high = checked_bounds(name, axis, bounds)
                held = HELD_M if axis in POSITION_AXES else HELD_RAD
                if not low - held <= start[axis] <= high + held:
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
    """How far a sensor may go when nobody says: always far enough to hold where it starts."""
    start = pose_values(sensor.pose)
    if vehicle is None:
        reach = Schedule().reach_m
        around = {a: (start[a] - reach, start[a] + reach) for a in POSITION_AXES}
        bounds = {a: (max(lo, -FARTHEST_M), min(hi, FARTHEST_M)) for a, (lo, hi) in around.items()}
    else:
        low, high = vehicle.bounds
        bounds = {a: (float(low[k]), float(high[k])) for k, a in enumerate("xy")}
        bounds["z"] = (LOWEST_M, min(float(high[2]) + HEADROOM_M, FARTHEST_M))
    bounds |= {"roll": (-math.pi, math.pi), "yaw": (-math.pi, math.pi)}
    bounds["pitch"] = (-math.pi / 2, math.pi / 2)
    return {a: (min(lo, start[a]), max(hi, start[a])) for a, (lo, hi) in bounds.items()}


def _bounded(
    sensor: str, free: tuple[str, ...], own: Mapping[str, Bounds], mounting: Mounting
) -> tuple[str, ...]:
    """Return the coordinates of a sensor that have bounds: on a surface, places that are said."""
    if mounting.unbounded(sensor):
        return ()
    if mounting.mount_of(sensor) is None:
        return free
    said = (axis for axis in POSITION_AXES if axis in own)
    return (*said, *(axis for axis in free if axis not in POSITION_AXES))


def _shown(axis: str, value: float) -> str:
    return f"{value:g} m" if axis in POSITION_AXES else f"{math.degrees(value):g} deg"
