"""Objects on the road: boxes that stand upright, alone or several to a scene."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, shown
from ..text.values import A_NAME, numbers
from .frozen import frozen
from .geometry import FARTHEST_M

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STRAIGHT = 1e-12
"""A sine or cosine below this is zero: the box stands along the ground frame's axes."""


@dataclass(frozen=True, eq=False)
class Objects:
    """Boxes in the ground frame, turned by their yaw alone.

    Parameters
    ----------
    centers : (N, 3) float
        Centres; z too is the centre, half a height above the bottom [m].
    sizes : (N, 3) float
        Length (along the heading), width, height [m].
    yaws : (N,) float
        Heading, counter-clockwise from x seen from above [rad].
    labels : (N,) int
        Class of each: an index into `class_names`.
    class_names : sequence of str
    scenes : (N,) int, optional
        Which scene each stands in; those of one scene hide each other. Each in its own by default.

    Raises
    ------
    InputError
        When there is no object, arrays differ in length, a number is not finite, a size is not
        positive, or an index is none.
    """

    centers: Floats
    sizes: Floats
    yaws: Floats
    labels: Ints
    class_names: Sequence[str]
    scenes: Ints = None  # type: ignore[assignment]  # all different

    def __post_init__(self) -> None:
        centers = _checked("centers", self.centers, 3)
        count = len(centers)
        if not count:
            raise InputError("objects", "centers", "at least one object", "none")
        names = tuple(A_NAME.checked("objects", "class_names", n) for n in self.class_names)
        scenes = np.arange(count) if self.scenes is None else self.scenes
        checked = {
            "centers": centers,
            "sizes": _checked("sizes", self.sizes, 3, count, above=0.0),
            "yaws": _checked("yaws", self.yaws, 0, count),
            "labels": _indices("labels", self.labels, count, len(names)),
            "scenes": _indices("scenes", scenes, count),
        }
        for key, values in checked.items():
            object.__setattr__(self, key, frozen(values))
        object.__setattr__(self, "class_names", names)

    def __len__(self) -> int:
        return len(self.centers)

    def __reduce__(self) -> tuple[object, ...]:
        """What can be worked out again is not sent to another process."""
        own = self.centers, self.sizes, self.yaws, self.labels, self.class_names, self.scenes
        return type(self), own

    @cached_property
    def headings(self) -> Floats:
        """(N, 2) cosine and sine of the yaws: by scalar functions, alike in all builds."""
        turned = np.array([(math.cos(a), math.sin(a)) for a in self.yaws.tolist()])
        turned[np.abs(turned) < STRAIGHT] = 0.0
        return frozen(turned)

    def some(self, which: NDArray) -> Objects:
        """Return some of them, by index or by flags."""
        c, s, y, n = (w[which] for w in (self.centers, self.sizes, self.yaws, self.labels))
        return Objects(c, s, y, n, self.class_names, self.scenes[which])


def _checked(
    name: str, values: ArrayLike, width: int, count: int | None = None, above: float = -np.inf
) -> Floats:
    """Return (N, width) or (N,) finite numbers of one's own, or complain."""
    shape = "(N, 3)" if width else "(N,)"
    found = numbers(values)
    if found is None:
        raise InputError("objects", name, f"{shape} numbers", shown(values))
    found = found + 0.0  # no negative zeros
    if found.ndim != (2 if width else 1) or (width and found.shape[1] != width):
        raise InputError("objects", name, f"{shape} numbers", found.shape)
    if count is not None and len(found) != count:
        raise InputError("objects", name, f"{count} rows, one an object", len(found))
    good = (found > above) & (np.abs(found) <= FARTHEST_M)
    bad = ~(good.all(axis=1) if width else good)
    if bad.any():
        first = int(np.flatnonzero(bad)[0])
        expected = "lengths above 0 m" if above == 0.0 else f"numbers within +-{FARTHEST_M:g}"
        raise InputError("objects", f"object {first}: {name}", expected, found[first].tolist())
    return found


def _indices(name: str, values: ArrayLike, count: int, below: int | None = None) -> Ints:
    """Return (N,) whole numbers from 0, or complain."""
    found = numbers(values)
    limit = np.inf if below is None else below
    if found is None or found.shape != (count,) or not _whole(found, limit):
        most = "" if below is None else f" below {below}, the number of class_names"
        expected = f"{count} whole numbers from 0{most}, one an object"
        raise InputError("objects", name, expected, shown(values))
    return found.astype(np.int64)


def _whole(values: Floats, below: float) -> bool:
    return bool(((values >= 0.0) & (values < below) & (values == np.floor(values))).all())
