"""How many objects of each class stand round the vehicle at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import InputError, shown
from ..scene.space import PerceptionSpace
from ..text.values import Number
from .classes import ObjectClass, met_in

Densities = tuple[tuple[str, float], ...]
"""Objects of a class at once, by its name; of what is left out the documented figure holds."""

COUNT = Number(0.0, cap=1e6, unit="objects")
PAPER_SPACE = PerceptionSpace()
"""The figures are of objects 80 m ahead and behind and 40 m to the sides."""
DOCUMENTED = {"car": 8.2, "pedestrian": 5.1, "cyclist": 1.0, "truck": 2.4, "cone": 2.4}
"""Boxes with a score of 0.4 and more that CenterPoint finds in a frame of nuScenes val, in that
space (6019 frames of 150 scenes; boxes from the public AB3DMOT repository). The detector ends at
about 54 m. Argoverse 2's labels have more (five logs: 22 cars, 7 pedestrians, 3 cyclists, 2 trucks
and 1 cone), KITTI tracking's fewer, of the front camera's view alone (4, 2, 0.2, 0.2)."""


def checked_densities(values: Any, names: Sequence[str]) -> Densities:
    """Return densities in the order of the classes; `InputError` for what is none of one."""
    pairs = dict(values) if isinstance(values, Mapping | tuple) else None
    if pairs is None:
        raise InputError("prior", "density", "numbers of objects by class", shown(values))
    for name in pairs:
        if name not in names:
            raise InputError("prior", "density", f"one of {', '.join(names)}", shown(name))
    counts = {n: COUNT.checked("prior", f"density.{n}", pairs[n]) for n in names if n in pairs}
    return tuple(counts.items())


def density_of(name: str, given: Densities) -> float:
    """Return how many of a class stand in the paper's space at once.

    Raises
    ------
    InputError
        When neither the study nor a documented figure tells.
    """
    known = DOCUMENTED | dict(given)
    if name not in known:
        raise InputError("prior", "density", f"how many of {name!r} stand round at once", "none")
    return known[name]


def share_in(cls: ObjectClass, space: PerceptionSpace) -> float:
    """Return how many of a class are met in a space, for each one in the paper's."""
    return met_in(cls, space) / met_in(cls, PAPER_SPACE)
