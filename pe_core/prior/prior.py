"""The prior p_S(s): how likely a voxel belongs to an object, with focus weights w(s, c).

Each class is a density over the ground times a profile over height, so that no weight is stored for
each of 64 million voxels. Traffic density is the number of objects of a class in the space at once.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats, read_only
from ..base.errors import InputError, require_kind, require_name, shown
from ..base.notebook import ShortRepr
from ..base.recent_cache import RecentCache
from ..base.setting import NAMES, Pair, Panel, check_settings, required_setting, setting
from ..base.values import WEIGHT, Number, choice, listed
from ..geometry.grids import PerceptionSpace
from .boxes import Boxes, BoxReport, voxelised
from .classes import (
    HIGHWAY_CLASSES,
    ROAD_CLASSES,
    SHIPPED,
    ObjectClass,
    Shape,
    class_shape,
    mass_in,
    uniform_shape,
)
from .grid import Grid

Densities = tuple[tuple[str, float], ...]
"""Traffic density: objects of a class at once, by its name; the default is in `DOCUMENTED`."""

COUNT = Number(0.0, cap=1e6, unit="objects")
PAPER_SPACE = PerceptionSpace()
"""Space of the documented numbers: 80 m ahead and behind, 40 m to the sides."""
DOCUMENTED = {"car": 8.2, "pedestrian": 5.1, "cyclist": 1.0, "truck": 2.4, "cone": 2.4}
"""Boxes with a score of 0.4 and more that CenterPoint finds per frame of nuScenes val, in that
space (6019 frames of 150 scenes; boxes from the public AB3DMOT repository). The detector ends at
about 54 m. Argoverse 2's labels have more (five logs: 22 cars, 7 pedestrians, 3 cyclists, 2 trucks
and 1 cone), KITTI tracking's fewer, of the front camera's view alone (4, 2, 0.2, 0.2)."""
FROM_BOXES = "boxes"
FROM_GRID = "grid"
UNIFORM = "uniform"
MODELS = (*SHIPPED, UNIFORM, FROM_BOXES, FROM_GRID)
EVERYWHERE = (-math.inf, math.inf)
ALONG = Number(infinite=True, unit="m")


def checked_densities(values: Any, names: Sequence[str]) -> Densities:
    """Return traffic densities in the order of the classes. `InputError` when there is no class of
    a name, or a number is wrong."""
    pairs = dict(values) if isinstance(values, Mapping | tuple) else None
    if pairs is None:
        raise InputError("prior", "density", "numbers of objects by class", shown(values))
    for name in pairs:
        require_name("prior", "density", name, names)
    counts = {n: COUNT.checked("prior", f"density.{n}", pairs[n]) for n in names if n in pairs}
    return tuple(counts.items())


def density_of(name: str, given: Densities) -> float:
    """Return how many objects of a class are in the paper's space at once. `InputError` when
    neither the study nor `DOCUMENTED` has a number for the class."""
    densities = DOCUMENTED | dict(given)
    if name not in densities:
        raise InputError("prior", "density", f"a number of {name!r} in the space at once", "none")
    return densities[name]


@dataclass(frozen=True, slots=True)
class Focus:
    """A factor of the focus weight w(s, c): a region [m], or some classes, count more or less.

    By default a region is infinite.
    """

    factor: float = required_setting(
        WEIGHT,
        "Factor of the weight; 0 leaves the objects out. Where regions overlap, factors multiply",
        Panel("factor", "Factor", default=2.0, soft_max=10.0),
        scored=True,
    )
    x: tuple[float, float] = setting(
        EVERYWHERE,
        Pair(ALONG),
        "Begin and end ahead of the origin; negative is behind it",
        Panel("x_range", "X", default=PerceptionSpace().x, precision=3),
        scored=True,
    )
    y: tuple[float, float] = setting(
        EVERYWHERE,
        Pair(ALONG),
        "Begin and end to the left of the origin; negative is to the right",
        Panel("y_range", "Y", default=PerceptionSpace().y, precision=3),
        scored=True,
    )
    classes: tuple[str, ...] | None = setting(None, NAMES, "Classes of objects; by default all")

    def __post_init__(self) -> None:
        check_settings(self, "focus")


@dataclass(frozen=True, slots=True)
class ClassDensity:
    """One class on one space: p(i, j, k) = ground[i, j] * profile[k], focus weights included.
    `ground` (nx, ny) holds the class's share of the whole prior; `profile` (nz,) sums to 1."""

    name: str
    ground: Floats
    profile: Floats


_densities: RecentCache[list[ClassDensity]] = RecentCache()
"""Those that were made last: what scores a rig and what looks at the ground have the same."""


@dataclass(frozen=True, slots=True)
class Prior(ShortRepr):
    """A prior: the name of a model, its classes or boxes, the focus, and the traffic density.

    Use `road`, `highway`, `uniform`, `from_boxes`, `from_grid` or `from_function`. With other
    classes: ``Prior("road", classes=(...))``. `density` is the number of objects of a class in the
    paper's space at once, by the name of the class: a mapping, or pairs.
    """

    model: str
    classes: tuple[ObjectClass, ...] = ()
    focus: tuple[Focus, ...] = ()
    boxes: Boxes | None = None
    density: Densities = ()
    grid: Grid | None = None

    def __post_init__(self) -> None:
        choice("prior", "model", self.model, MODELS)
        for name, kind in (("classes", ObjectClass), ("focus", Focus)):
            items = listed(getattr(self, name))
            if items is None:
                raise InputError("prior", name, "a list", shown(getattr(self, name)))
            for item in items:
                require_kind("prior", name, item, kind)
            object.__setattr__(self, name, tuple(items))
        if self.boxes is not None:
            require_kind("prior", "boxes", self.boxes, Boxes)
        if bool(self.classes) != (self.model in SHIPPED):
            shipped = f"at least one, or Prior.{self.model}() for those that are shipped"
            expected = shipped if self.model in SHIPPED else f"none with {self.model!r}"
            raise InputError("prior", "classes", expected, len(self.classes))
        if bool(self.boxes) != (self.model == FROM_BOXES):
            expected = "at least one" if self.model == FROM_BOXES else f"none with {self.model!r}"
            raise InputError("prior", "boxes", expected, len(self.boxes or ()))
        if isinstance(self.grid, Grid) != (self.model == FROM_GRID):
            raise InputError("prior", "grid", f"a Grid if, and only if, {FROM_GRID!r}", self.model)
        names = self.class_names
        for i, name in enumerate(names):
            if name in names[:i]:
                raise InputError("prior", "classes", "each name once", f"{name!r} twice")
        object.__setattr__(self, "density", checked_densities(self.density, names))
        for focus in self.focus:
            for name in focus.classes or ():
                require_name("focus", "classes", name, names)

    @classmethod
    def road(cls, focus: Sequence[Focus] = ()) -> "Prior":
        """Public roads: cars, pedestrians, cyclists, trucks and cones, with equal shares."""
        return cls("road", ROAD_CLASSES, tuple(focus))

    @classmethod
    def highway(cls, focus: Sequence[Focus] = ()) -> "Prior":
        """A highway: cars, trucks, motorcyclists and cones on and near three lanes."""
        return cls("highway", HIGHWAY_CLASSES, tuple(focus))

    @classmethod
    def uniform(cls, focus: Sequence[Focus] = ()) -> "Prior":
        """The same density at every voxel."""
        return cls(UNIFORM, (), tuple(focus))

    @classmethod
    def from_boxes(cls, table: Any, focus: Sequence[Focus] = ()) -> "Prior":
        """Labelled boxes, voxelized; their classes have equal shares.

        `InputError` when a box is wrong, or there is no box.

        Parameters
        ----------
        table : Boxes, or table
            The result of `read_boxes`, or a table that `Boxes.of` takes.
        """
        boxes = table if isinstance(table, Boxes) else Boxes.of(table)
        return cls(FROM_BOXES, (), tuple(focus), boxes)

    @classmethod
    def from_grid(
        cls, weights: ArrayLike, space: PerceptionSpace, focus: Sequence[Focus] = ()
    ) -> "Prior":
        """Weights of the voxels of a space, in any unit: the prior is their share of the sum.

        `InputError` when the shape is another, or a weight is negative or not finite.

        Parameters
        ----------
        weights : (nx, ny) or (nx, ny, nz) float
            Of each column, the same at all heights, or of each voxel; at least 0.
        space : PerceptionSpace
            The space of the weights, whose `shape` is (nx, ny, nz).
        """
        return cls(FROM_GRID, (), tuple(focus), grid=Grid(weights, space))  # type: ignore[arg-type]

    @classmethod
    def from_function(
        cls, weight: Callable[..., ArrayLike], space: PerceptionSpace, focus: Sequence[Focus] = ()
    ) -> "Prior":
        """Weights by a function of the voxels' centres: ``from_grid`` of what it returns.

        `InputError` when what is returned does not broadcast to the space; else as of `from_grid`.

        Parameters
        ----------
        weight : callable
            Takes x (nx, 1, 1), y (1, ny, 1) and z (1, 1, nz) [m], ground frame, and returns weights
            that broadcast with them. Without z in it, weights are the same at all heights.
        """
        x, y, z = (space.centers(axis) for axis in range(3))
        values = np.asarray(weight(x[:, None, None], y[:, None], z))
        by_height = values.ndim == 3 and values.shape[2] > 1
        shape = space.shape if by_height or values.ndim == 1 else (*space.shape[:2], 1)
        try:
            weights = np.broadcast_to(values, shape)
        except ValueError:
            found = f"shape {values.shape}"
            raise InputError("prior", "weights", f"shape {space.shape}", found) from None
        return cls.from_grid(weights if shape[2] > 1 else weights[:, :, 0], space, focus)

    @property
    def class_names(self) -> tuple[str, ...]:
        """Names of the classes; ``("any",)`` for a prior that has none."""
        if self.grid is not None:
            return self.grid.layers
        if self.boxes is not None:
            return self.boxes.classes
        return tuple(c.name for c in self.classes) or ("any",)

    def objects_at_once(self, space: PerceptionSpace) -> dict[str, float]:
        """Return how many objects of each class are in a space at once, on average.

        `InputError` when there is no number for a class, or the prior has no classes.
        """
        if self.model in (UNIFORM, FROM_GRID):
            expected = "a prior with classes, because objects need them"
            raise InputError("prior", "model", expected, self.model)
        counts = {name: density_of(name, self.density) for name in self.class_names}
        # for each object of a class in the paper's space, the number in this space
        shares = {c.name: mass_in(c, space) / mass_in(c, PAPER_SPACE) for c in self.classes}
        return {name: count * shares.get(name, 1.0) for name, count in counts.items()}

    def focus_at(self, name: str, x: Floats, y: Floats) -> Floats:
        """Return w(s, c) of a class at positions (N,) [m]: the product of the factors there."""
        weights = np.ones(len(x))
        for focus in self.focus:
            if focus.classes is None or name in focus.classes:
                inside = (x > focus.x[0]) & (x < focus.x[1])
                inside &= (y > focus.y[0]) & (y < focus.y[1])
                with np.errstate(over="ignore"):
                    weights[inside] *= focus.factor
        return weights

    def report(self, space: PerceptionSpace) -> BoxReport | None:
        """Return how many boxes the prior uses in a space; None for a prior without boxes."""
        return None if self.boxes is None else voxelised(self.boxes, space).report

    def densities(self, space: PerceptionSpace) -> list[ClassDensity]:
        """Return p_S class by class; the sum over all classes and voxels is 1.

        Before focus weights the distribution of a class (the paper's p_Sc) sums to its share, which
        is the same for all classes except those of the highway.

        `InputError` when the focus weights leave no mass, no box is in the space, or the classes
        and columns do not fit in memory.
        """
        return _densities.made((self, space), lambda: self._new_densities(space))

    def _new_densities(self, space: PerceptionSpace) -> list[ClassDensity]:
        names = self.class_names
        shapes = self._shapes(space)
        grounds = [
            ground * self._weights(name, space) if self.focus or self._is_measured else ground
            for name, (ground, _) in zip(names, shapes, strict=True)
        ]
        total = sum(float(g.sum()) for g in grounds)
        if not 0.0 < total < math.inf:
            found = "infinitely much" if total else "none"
            raise InputError("prior", "focus", "some weight left in the space", found)
        for ground in grounds:
            ground /= total  # they are large
        return [
            ClassDensity(name, read_only(ground), read_only(profile))
            for name, ground, (_, profile) in zip(names, grounds, shapes, strict=True)
        ]

    @property
    def _is_measured(self) -> bool:
        """Whether its shapes are those of data, which others share."""
        return self.boxes is not None or self.grid is not None

    def _shapes(self, space: PerceptionSpace) -> Sequence[Shape]:
        """Density of each class, which sums to its share of the prior."""
        if self.boxes is not None:
            return voxelised(self.boxes, space).shapes
        if self.grid is not None:
            return self.grid.shapes(space)
        shapes = ((c.share, class_shape(c, space)) for c in self.classes)
        weighted = []
        for share, (ground, profile) in shapes:
            ground *= share
            weighted.append((ground, profile))
        return weighted or [uniform_shape(space)]

    def _weights(self, name: str, space: PerceptionSpace) -> Floats:
        """w(s, c) over the ground (nx, ny)."""
        weights = np.ones(space.shape[:2])
        x = space.centers(0)
        y = space.centers(1)
        for focus in self.focus:
            if focus.classes is None or name in focus.classes:
                rows = (x > focus.x[0]) & (x < focus.x[1])
                columns = (y > focus.y[0]) & (y < focus.y[1])
                with np.errstate(over="ignore"):  # `densities` raises for infinite weights
                    weights[np.ix_(rows, columns)] *= focus.factor
        return weights
