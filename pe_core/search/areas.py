"""An area of the vehicle's body that is no part of its own: its faces, and the file they are in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from ..scene.vehicle import Vehicle
from ..text.values import A_NAME, A_PATH, listed

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class MountArea:
    """Faces on which a sensor moves, whatever parts of the body they belong to.

    Parameters
    ----------
    triangles : (F, 3, 3) float
        Corners in the ground frame [m].
    file : str, optional
        The mesh file they are in, as a study names it.
    parts : sequence of str
        Parts of that file that they are; none: all of it.

    Raises
    ------
    InputError
        When the triangles are not (F, 3, 3), none are left, or a coordinate is not finite.
    """

    triangles: Floats = field(repr=False)
    file: str | None = None
    parts: Sequence[str] = ()

    def __post_init__(self) -> None:
        put, who = object.__setattr__, "mount"
        try:
            put(self, "triangles", Vehicle(self.triangles).triangles)  # checked as a body's are
        except InputError as error:
            raise InputError(who, "area", error.expected, error.found) from None
        if self.file is not None:
            put(self, "file", A_PATH.checked(who, "area", self.file))
        if (names := listed(self.parts)) is None:
            raise InputError(who, "parts", "names of the area's parts", shown(self.parts))
        put(self, "parts", tuple(A_NAME.checked(who, "parts", name) for name in names))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MountArea):
            return NotImplemented
        same = (self.file, self.parts) == (other.file, other.parts)
        return same and np.array_equal(self.triangles, other.triangles)

    def __hash__(self) -> int:
        return hash((self.file, self.parts, len(self.triangles)))
