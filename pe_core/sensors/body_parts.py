"""Parts of test bodies, of which a requirement asks how much is visible."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.arrays import Flags, Ints
from ..base.read_only import read_only
from ..scene.objects import Objects

CELLS, ROUND, INSIDE = range(3)
"""Layers of boxes: the cells that are measured, the shell round the body, boxes inside it."""
LAYERS = 3
NO_END = -1
"""Band of a ray that does not enter a layer."""


@dataclass(frozen=True, eq=False)
class BodyParts:
    """Cells of bodies, and shells that tell in which band of a body a ray ends.

    The surface of a body is between the shell round it and the boxes inside it. A body without one
    of them has its surface on the cells.

    Attributes
    ----------
    cells : Objects
        What is measured; its scenes are the bodies.
    shells : Objects or None
        Boxes round and inside the bodies, with the same scenes.
    bands : (N,) int
        The band of height of each cell and of each shell after them.
    layers : (N,) int
        `CELLS`, `ROUND` or `INSIDE`.
    """

    cells: Objects
    shells: Objects | None
    bands: Ints
    layers: Ints

    @cached_property
    def objects(self) -> Objects:
        """The cells, then the shells."""
        shells = () if self.shells is None else (self.shells,)
        return Objects.joined([self.cells, *shells])

    @cached_property
    def has_layer(self) -> Flags:
        """Whether each body has boxes of each layer, (LAYERS, bodies)."""
        scenes = self.objects.scenes
        has = np.zeros((LAYERS, int(scenes.max()) + 1), bool)
        has[self.layers, scenes] = True
        return read_only(has)
