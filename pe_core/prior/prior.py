"""The prior p_S(s): how likely a voxel belongs to an object, after focus weights w(s, c).

Each class is a density over the ground times a profile over height, so no weight is ever stored for
every one of 64 million voxels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InputError, shown
from ..scene.space import PerceptionSpace
from ..text.memory import require_memory
from ..text.values import A_NAME, ANY, WEIGHT, choice, listed, pair
from .box_density import voxelised
from .boxes import Boxes, BoxReport
from .classes import (
    HIGHWAY_CLASSES,
    ROAD_CLASSES,
    SHIPPED,
    Floats,
    ObjectClass,
    Shape,
    class_shape,
    uniform_shape,
)
from .traffic import Densities, checked_densities, density_of, share_in

__all__ = ["HIGHWAY_CLASSES", "ROAD_CLASSES", "ClassDensity", "Focus", "ObjectClass", "Prior"]

FROM_BOXES, UNIFORM = "boxes", "uniform"
MODELS = (*SHIPPED, UNIFORM, FROM_BOXES)
CLASS_BYTES = 32
"""What a score holds of each class for each column of the space, at its most (measured: 29)."""


@dataclass(frozen=True, slots=True)
class Focus:
    """A factor of w(s, c): counts a region, or some classes, more or less.

    Parameters
    ----------
    factor : float
        At least 0. Where regions overlap, factors multiply.
    x, y : (low, high) float
        Region of the ground [m]; infinite by default.
    classes : sequence of str, optional
        Which classes; all by default.
    """

    factor: float
    x: tuple[float, float] = (-math.inf, math.inf)
    y: tuple[float, float] = (-math.inf, math.inf)
    classes: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        factor = WEIGHT.checked("focus", "factor", self.factor)
        object.__setattr__(self, "factor", factor)
        for name in "xy":
            object.__setattr__(self, name, pair("focus", name, getattr(self, name), ANY))
        if self.classes is not None:
            names = listed(self.classes)
            if names is None:
                raise InputError("focus", "classes", "a list of names", shown(self.classes))
            checked = tuple(A_NAME.checked("focus", "classes", n) for n in names)
            object.__setattr__(self, "classes", checked)


@dataclass(frozen=True, slots=True)
class ClassDensity:
    """One class on one space: p(i, j, k) = ground[i, j] * profile[k], focus weights included.

    `ground` (nx, ny) holds the class's share of the whole prior; `profile` (nz,) sums to 1.
    """

    name: str
    ground: Floats
    profile: Floats


@dataclass(frozen=True, slots=True)
class Prior:
    """A prior: a model's name, its classes or boxes, the focus, and how dense the traffic is.

    `density` has how many objects of a class stand round the vehicle at once, by name: a mapping,
    or pairs.
    Use `road`, `highway`, `uniform` or `from_boxes`. Classes of one's own:
    ``Prior("road", classes=(...))``.
    """

    model: str
    classes: tuple[ObjectClass, ...] = ()
    focus: tuple[Focus, ...] = ()
    boxes: Boxes | None = None
    density: Densities = ()

    def __post_init__(self) -> None:
        choice("prior", "model", self.model, MODELS)
        for name in ("classes", "focus"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        if bool(self.classes) != (self.model in SHIPPED):
            expected = "at least one" if self.model in SHIPPED else f"none with {self.model!r}"
            raise InputError("prior", "classes", expected, len(self.classes))
        if bool(self.boxes) != (self.model == FROM_BOXES):
            expected = "at least one" if self.model == FROM_BOXES else f"none with {self.model!r}"
            raise InputError("prior", "boxes", expected, len(self.boxes or ()))
        names = self.class_names
        for i, name in enumerate(names):
            if name in names[:i]:
                raise InputError("prior", "classes", "each name once", f"{name!r} twice")
        object.__setattr__(self, "density", checked_densities(self.density, names))
        for focus in self.focus:
            for name in focus.classes or ():
                if name not in names:
                    raise InputError("focus", "classes", f"one of {', '.join(names)}", shown(name))

    @classmethod
    def road(cls, focus: Sequence[Focus] = ()) -> Prior:
        """Cars, pedestrians, cyclists, trucks and cones, as met on public roads; equal shares."""
        return cls("road", ROAD_CLASSES, tuple(focus))

    @classmethod
    def highway(cls, focus: Sequence[Focus] = ()) -> Prior:
        """Cars, trucks, motorcyclists and cones on and round three lanes: long and narrow."""
        return cls("highway", HIGHWAY_CLASSES, tuple(focus))

    @classmethod
    def uniform(cls, focus: Sequence[Focus] = ()) -> Prior:
        """Every voxel counts the same."""
        return cls(UNIFORM, (), tuple(focus))

    @classmethod
    def from_boxes(cls, table: Any, focus: Sequence[Focus] = ()) -> Prior:
        """Labelled boxes, voxelised: the classes are the boxes', with equal shares.

        Parameters
        ----------
        table : Boxes, or table
            What `read_boxes` reads from a file, or what `Boxes.of` takes.
        focus : sequence of Focus

        Raises
        ------
        InputError
            When a box is wrong, or none is left.
        """
        boxes = table if isinstance(table, Boxes) else Boxes.of(table)
        return cls(FROM_BOXES, (), tuple(focus), boxes)

    @property
    def class_names(self) -> tuple[str, ...]:
        """Names of the classes; ``("any",)`` for the uniform prior."""
        if self.boxes is not None:
            return self.boxes.classes
        return tuple(c.name for c in self.classes) or ("any",)

    def objects_at_once(self, space: PerceptionSpace) -> dict[str, float]:
        """How many objects of each class stand in a space at once, on average.

        Raises
        ------
        InputError
            When neither the study nor a documented figure tells of a class, or there are none.
        """
        if self.model == UNIFORM:
            raise InputError("prior", "model", "one with classes, to have objects", UNIFORM)
        known = {name: density_of(name, self.density) for name in self.class_names}
        shares = {c.name: share_in(c, space) for c in self.classes}
        return {name: count * shares.get(name, 1.0) for name, count in known.items()}

    def focus_at(self, name: str, x: Floats, y: Floats) -> Floats:
        """w(s, c) of a class at places (N,) [m]: the product of the factors there."""
        weights = np.ones(len(x))
        for focus in self.focus:
            if focus.classes is None or name in focus.classes:
                inside = (x > focus.x[0]) & (x < focus.x[1])
                inside &= (y > focus.y[0]) & (y < focus.y[1])
                with np.errstate(over="ignore"):
                    weights[inside] *= focus.factor
        return weights

    def report(self, space: PerceptionSpace) -> BoxReport | None:
        """How many boxes the prior is made of in a space; None for a prior without boxes."""
        return None if self.boxes is None else voxelised(self.boxes, space).report

    def densities(self, space: PerceptionSpace) -> list[ClassDensity]:
        """p_S class by class; all of it sums to 1.

        Each class's own distribution sums to its share, 1 but for the highway's, before its focus
        weights (the paper's p_Sc), so without focus classes of one share count alike.

        Raises
        ------
        InputError
            When nothing is left of the prior after the focus weights, no box is in the space, or so
        many classes on so many columns do not fit in memory.
        """
        names = self.class_names
        require_memory("prior", "classes", len(names) * math.prod(space.shape[:2]) * CLASS_BYTES)
        shapes = self._shapes(space)
        grounds = [
            ground * self._weights(name, space)
            for name, (ground, _) in zip(names, shapes, strict=True)
        ]
        total = sum(float(g.sum()) for g in grounds)
        if not 0.0 < total < math.inf:
            found = "infinitely much" if total else "none"
            raise InputError("prior", "focus", "some weight left in the space", found)
        return [
            ClassDensity(name, ground / total, profile)
            for name, ground, (_, profile) in zip(names, grounds, shapes, strict=True)
        ]

    def _shapes(self, space: PerceptionSpace) -> Sequence[Shape]:
        """Each class's density, summing to its share of the prior."""
        if self.boxes is not None:
            return voxelised(self.boxes, space).shapes
        shapes = ((c.share, class_shape(c, space)) for c in self.classes)
        weighed = [(share * ground, profile) for share, (ground, profile) in shapes]
        return weighed or [uniform_shape(space)]

    def _weights(self, name: str, space: PerceptionSpace) -> Floats:
        """w(s, c) over the ground (nx, ny)."""
        weights = np.ones(space.shape[:2])
        x, y = space.centers(0), space.centers(1)
        for focus in self.focus:
            if focus.classes is None or name in focus.classes:
                rows = (x > focus.x[0]) & (x < focus.x[1])
                columns = (y > focus.y[0]) & (y < focus.y[1])
                with np.errstate(over="ignore"):  # too many large factors: `densities` complains
                    weights[np.ix_(rows, columns)] *= focus.factor
        return weights
