"""Triangle meshes with named parts: the options of a file, and the shape of a body.

Options are for the axes and the unit. Of the shape are size, positions of parts and asymmetry; a
vehicle's size is checked.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.errors import MAX_FOUND_LENGTH, InputError
from ..base.notebook import ShortRepr
from ..base.setting import Part
from ..base.values import Number, choice, vector
from ..geometry.poses import ROTATION_DEG

AXIS_NAMES = ("+x", "-x", "+y", "-y", "+z", "-z")
SCALE = Number(1e-6, cap=1e6)
PartBounds = tuple[Floats, Floats, NDArray[np.bool_]]
"""Lowest and highest corners (P, 3) of the parts, and which parts have any triangles."""
ROOM_M = 4.0
"""A part counts as a room if two of its sides are at least this long [m]..."""
FAR_LARGER = 1.5
"""...and this many times as long as those of all smaller parts together."""
BINS = 256
ENOUGH = 100_000
"""Bins along an axis for the surface of a mesh, and about how many triangles are sampled."""
FEW_RUNS = 1000  # Below this number of runs, a loop over them is faster
SMALLEST_M = 0.1
LARGEST_M = 60.0
WIDEST_M = 25.0
"""Minimum and maximum length of a vehicle's longest side; maximum of its second longest."""
CAR_M = 4.5  # Length of a typical car, for comparison
ACROSS_M = 2.1
"""Usual root of width times height: 1.4 m of a sports car, 3.1 m of a lorry."""
MAX_UNITS = 2  # Maximum number of possible units in a message
USUAL_M = (0.4, 30.0)
USUAL_SECOND_M = 10.0
"""Range of the longest side of most vehicles, and maximum of the second longest."""
SMALLER_UNITS = {"inches": 0.0254, "centimetres": 0.01, "millimetres": 0.001, "feet": 0.3048}
LARGER_UNITS = {"units of 100 m": 100.0, "kilometres": 1000.0}


@dataclass(frozen=True, slots=True)
class Mesh(ShortRepr):
    """Triangles of one object; each triangle belongs to a named part.

    Attributes
    ----------
    triangles : (F, 3, 3) float64
        Corner coordinates in metres, ground frame (x forward, y left, z up);
        axis 1 is the corner, axis 2 the coordinate.
    parts : (F,) int32
        Index of each triangle's part in `part_names`.
    part_names : tuple of str
        Names of the parts; each part has a triangle, and names are unique.
    axes : str
        Text on how the file's axes were interpreted; empty if it is in the ground frame.
    notes : tuple of str
        What of the file is left out, and which of its polygons cross themselves.
    """

    triangles: NDArray[np.float64]
    parts: NDArray[np.int32]
    part_names: tuple[str, ...]
    axes: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class MeshAxes:
    """Axes and scale of a mesh file, by a study; other values are from the file, or guessed.

    `InputError` when an axis is unknown, both axes are parallel, the scale is below 1e-6, or the
    rotation is not three angles.

    Parameters
    ----------
    up, forward : str, optional
        The file's axes that point up and forward, from `AXIS_NAMES`.
    scale : float
        Factor for lengths, applied after the file's own unit.
    rotation_deg : (3,) float, optional
        Roll, pitch, yaw [deg]: a rotation of the body, applied last. Then nothing is guessed.
    """

    up: str | None = None
    forward: str | None = None
    scale: float = 1.0
    rotation_deg: Annotated[tuple[float, float, float] | None, Part(key="rotation")] = None

    def __post_init__(self) -> None:
        for name in ("up", "forward"):
            if (value := getattr(self, name)) is not None:
                choice("vehicle", name, value, AXIS_NAMES)
        if self.up and self.forward and self.up[1] == self.forward[1]:
            expected = f"an axis across up = {self.up}"
            raise InputError("vehicle", "forward", expected, self.forward)
        object.__setattr__(self, "scale", SCALE.checked("vehicle", "scale", self.scale))
        if self.rotation_deg is not None:
            angles = vector("vehicle", "rotation", self.rotation_deg, count=3, rule=ROTATION_DEG)
            object.__setattr__(self, "rotation_deg", angles)


AS_SAID = MeshAxes(rotation_deg=(0.0, 0.0, 0.0))
"""The axes that the file states, or the default axes of its format; nothing is guessed."""


@dataclass(frozen=True, eq=False)
class BodyShape:
    """Shape of a mesh with named parts, without the floor or room that its file may contain.
    `triangles` (F, 3, 3) [m] have any axes; `parts` (F,) are indices into `part_names`."""

    triangles: Floats
    parts: NDArray[np.int32]
    part_names: Sequence[str]

    @cached_property
    def rooms(self) -> tuple[str, ...]:
        """Names of the parts that are as large as a room."""
        return tuple(self.part_names[k] for k in _rooms(*self._part_bounds))

    @cached_property
    def is_ours(self) -> NDArray[np.bool_] | None:
        """(F,) whether a triangle belongs to the body, not to a room; None: all of them do."""
        if not self.rooms:
            return None
        names = list(self.part_names)
        return ~np.isin(self.parts, [names.index(name) for name in self.rooms])

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner (3,) without rooms [m]."""
        low, high, present = self._part_bounds
        body = present & ~np.isin(np.arange(len(low)), _rooms(low, high, present))
        return low[body].min(axis=0), high[body].max(axis=0)

    @property
    def size(self) -> tuple[float, float, float]:
        """Extent along x, y, z without rooms [m]."""
        low, high = self.bounds
        x, y, z = (high - low).tolist()
        return x, y, z

    @cached_property
    def middle(self) -> tuple[float, float]:
        """Point x, y that belongs on the origin [m]: the middle in x, the axis in y. The axis is
        the middle of the bounds, or the centroid of the surface if that is nearer to y = 0: a
        single mirror moves the bounds, and a single seat the centroid."""
        low, high = self.bounds
        x, y = ((low + high)[:2] / 2.0).tolist()
        triangles = self.triangles if self.is_ours is None else self.triangles[self.is_ours]
        area = _areas(triangles)
        total = float(area.sum())
        if total > 0.0:
            centroid = float((triangles[:, :, 1].mean(axis=1) * area).sum()) / total
            y = 0.0 if centroid * y < 0.0 else min(y, centroid, key=abs)
        return x, y

    @cached_property
    def lopsided(self) -> tuple[float, float, float]:
        """Asymmetry of the surface along x, y, z: 0 if it equals its mirror image, at most 2. The
        earth mover's distance, along the axis, between the surface and its mirror image; the unit
        is half the length of the body's side."""
        body = self.triangles if self.is_ours is None else self.triangles[self.is_ours]
        stride = -(-len(body) // ENOUGH)
        triangles = body[::stride]
        area = _areas(triangles)
        x, y, z = (_lopsided(triangles[:, :, k].mean(axis=1), area) for k in range(3))
        return x, y, z

    def part_centers(self) -> dict[str, Floats]:
        """Centre of the bounds (3,) [m] of each part that is not a room, by name."""
        low, high, present = self._part_bounds
        named = ((self.part_names[k], k) for k in np.flatnonzero(present).tolist())
        return {name: (low[k] + high[k]) / 2.0 for name, k in named if name not in self.rooms}

    @cached_property
    def _part_bounds(self) -> PartBounds:
        return _part_bounds(self.triangles, np.asarray(self.parts), len(self.part_names))


def corner_bounds(triangles: Floats) -> tuple[Floats, Floats]:
    """Lowest and highest corner (3,) of triangles (F, 3, 3), F at least 1."""
    axes = [triangles[..., k] for k in range(3)]  # axis by axis: many times as fast
    return np.array([axis.min() for axis in axes]), np.array([axis.max() for axis in axes])


def _areas(triangles: Floats) -> Floats:
    """Twice the areas (F,) of triangles [m2]."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.sqrt((normal * normal).sum(axis=1))


def _lopsided(positions: Floats, area: Floats) -> float:
    low = float(positions.min())
    high = float(positions.max())
    total = float(area.sum())
    if not (high > low and total > 0.0):
        return 0.0
    bins = np.minimum((positions - low) * (BINS / (high - low)), BINS - 1).astype(np.int64)
    share = np.bincount(bins, area, BINS) / total
    return float(np.abs(np.cumsum(share) - np.cumsum(share[::-1])).sum()) * 2.0 / BINS


def _part_bounds(triangles: Floats, parts: NDArray[np.int32], count: int) -> PartBounds:
    starts = np.concatenate([[0], np.flatnonzero(np.diff(parts)) + 1])  # runs of one part
    low = np.full((count, 3), np.inf)
    high = np.full((count, 3), -np.inf)
    run_low, run_high = _bounds_of_runs(triangles, starts)
    np.minimum.at(low, parts[starts], run_low)
    np.maximum.at(high, parts[starts], run_high)
    return low, high, np.isfinite(low[:, 0])


def _bounds_of_runs(triangles: Floats, starts: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Lowest and highest corner (R, 3) of each run of triangles."""
    stops = np.append(starts[1:], len(triangles))
    if len(starts) < FEW_RUNS:
        pairs = [corner_bounds(triangles[a:b]) for a, b in zip(starts, stops, strict=True)]
        return np.array([low for low, _ in pairs]), np.array([high for _, high in pairs])
    a, b, c = (triangles[:, k] for k in range(3))
    lowest = np.minimum(np.minimum(a, b), c)
    highest = np.maximum(np.maximum(a, b), c)
    low = np.minimum.reduceat(lowest, starts, axis=0)
    return low, np.maximum.reduceat(highest, starts, axis=0)


def _rooms(low: Floats, high: Floats, present: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Indices of the parts whose two longest sides far exceed those of all smaller parts."""
    size = np.where(present[:, None], high - low, 0.0)
    longest = np.sort(size, axis=1)[:, ::-1]
    large = present & (longest[:, 1] >= ROOM_M)
    rest = present & ~large
    if not (large.any() and rest.any()):
        return np.zeros(0, np.int64)
    rest_sides = np.sort(high[rest].max(axis=0) - low[rest].min(axis=0))[::-1]
    larger = (longest[:, :2] >= FAR_LARGER * rest_sides[:2]).all(axis=1)
    return np.flatnonzero(large & larger)


def require_vehicle_size(source: str, body: Any) -> None:
    """Raise `InputError` if a body is too large or too small for a vehicle; a floor does not count.
    The body is a `Mesh` or a `Vehicle`. The message has its size, and scale factors that give it
    the size of a vehicle."""
    low, high = corner_bounds(body.triangles)
    if _is_possible((high - low).tolist()):
        return
    size = BodyShape(body.triangles, body.parts, body.part_names).size
    if not _is_possible(size):
        expected = f"a vehicle, {SMALLEST_M:g} to {LARGEST_M:g} m long"
        width_text = f" and up to {WIDEST_M:g} m wide" if max(size) <= LARGEST_M else ""
        texts = (f"{size_words(size)}; {_hint(size, units)}" for units in range(MAX_UNITS, 0, -1))
        found = next((text for text in texts if len(text) <= MAX_FOUND_LENGTH), "")
        raise InputError(source, "size", f"{expected}{width_text}", found or size_words(size))


def fitting_units(longest: float, second: float, third: float) -> list[tuple[str, float]]:
    """Return the units in which a body with these sides, the longest first, has a vehicle's usual
    size. Pairs of name and length in metres; first the unit that makes it most similar to a
    vehicle. Cars, vans and lorries differ in length by more than the units do; their cross-sections
    differ by less. A body without height is compared by its length."""
    units = SMALLER_UNITS if longest > USUAL_M[0] else LARGER_UNITS
    fitting = [(n, f) for n, f in units.items() if is_usual(f * longest, f * second)]
    across = math.sqrt(second * third)
    length, usual = (across, ACROSS_M) if across > 0.0 else (longest, CAR_M)
    return sorted(fitting, key=lambda unit: abs(math.log(unit[1] * length / usual)))


def is_usual(longest: float, second: float) -> bool:
    """Whether two longest sides [m] are usual for a vehicle."""
    return USUAL_M[0] <= longest <= USUAL_M[1] and second <= USUAL_SECOND_M


def car_factor(longest: float) -> float:
    """Return the scale that makes a body as long as a car, rounded to two digits."""
    return float(f"{CAR_M / longest:.2g}")


def size_words(size: tuple[float, ...]) -> str:
    """Return a size as text, "4.70 x 1.85 x 1.45 m"; the number of decimals depends on the size."""
    longest = max(size)
    digits = 2 if 0.995 <= longest < 99.5 else 0 if longest >= 99.5 else 3
    return f"{' x '.join(f'{side:.{digits}f}' for side in size)} m"


def _is_possible(size: tuple[float, ...]) -> bool:
    _, second, longest = sorted(size)
    return SMALLEST_M <= longest <= LARGEST_M and second <= WIDEST_M


def _hint(size: tuple[float, ...], max_units: int) -> str:
    third, second, longest = sorted(size)
    if longest == 0.0:
        return "all of it is one point"
    units = fitting_units(longest, second, third)[:max_units]
    if not units:
        return f"scale = {car_factor(longest):g} makes it as long as a car"
    hints = (f"{factor:g} if {name} ({factor * longest:.2f} m)" for name, factor in units)
    return f"scale = {', '.join(hints)}"
