"""Objects on the road: upright boxes, grouped into scenes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import Floats, Ints, mapped, read_only
from ..base.errors import InputError, shown
from ..base.notebook import ShortRepr
from ..base.values import A_NAME, numbers
from ..geometry.poses import FARTHEST_M

STRAIGHT = 1e-12
"""A sine or cosine below this counts as zero: the box is parallel to the ground frame's axes."""


@dataclass(frozen=True, eq=False)
class Objects(ShortRepr):
    """Boxes in the ground frame, rotated about the vertical axis only.

    `InputError` when there is no object, arrays differ in length, a number is not finite, a size is
    not positive, or an index is not valid.

    Parameters
    ----------
    centers : (N, 3) float
        Centres; z too is the centre, half a height above the bottom [m].
    sizes : (N, 3) float
        Length (along the heading), width, height [m].
    yaws : (N,) float
        Heading, counter-clockwise from x seen from above [rad].
    labels : (N,) int
        Class of each object: an index into `class_names`.
    scenes : (N,) int, optional
        Scene of each object, whose objects may occlude each other; by default one scene each.
    """

    centers: Floats
    sizes: Floats
    yaws: Floats
    labels: Ints
    class_names: Sequence[str]
    scenes: Ints = None  # type: ignore[assignment]  # one scene each

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
            object.__setattr__(self, key, read_only(values))
        object.__setattr__(self, "class_names", names)

    def __len__(self) -> int:
        return len(self.centers)

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle without cached properties."""
        fields = self.centers, self.sizes, self.yaws, self.labels, self.class_names, self.scenes
        return type(self), fields

    @cached_property
    def headings(self) -> Floats:
        """(N, 2) cosine and sine of the yaws, by `math`: the same bits in all builds."""
        directions = np.stack([mapped(math.cos, self.yaws), mapped(math.sin, self.yaws)], axis=1)
        directions[np.abs(directions) < STRAIGHT] = 0.0
        return read_only(directions)

    @classmethod
    def joined(cls, parts: "Sequence[Objects]") -> "Objects":
        """Return objects of the same classes as one set, with their scenes."""
        keys = ("centers", "sizes", "yaws", "labels", "scenes")
        c, s, y, n, own = (np.concatenate([getattr(p, key) for p in parts]) for key in keys)
        return cls(c, s, y, n, class_names=parts[0].class_names, scenes=own)

    def some(self, which: NDArray) -> "Objects":
        """Return the objects that `which` selects, by indices or flags (N,)."""
        c, s, y, n = (w[which] for w in (self.centers, self.sizes, self.yaws, self.labels))
        return Objects(c, s, y, n, class_names=self.class_names, scenes=self.scenes[which])


def _checked(
    name: str, values: ArrayLike, width: int, count: int | None = None, above: float = -np.inf
) -> Floats:
    """Return a new array (N, width) or (N,) of finite numbers, or raise `InputError`."""
    shape = "(N, 3)" if width else "(N,)"
    array = numbers(values)
    if array is None:
        raise InputError("objects", name, f"{shape} numbers", shown(values))
    array = array + 0.0  # no negative zeros
    if array.ndim != (2 if width else 1) or (width and array.shape[1] != width):
        raise InputError("objects", name, f"{shape} numbers", array.shape)
    if count is not None and len(array) != count:
        raise InputError("objects", name, f"{count} rows, one an object", len(array))
    valid = (array > above) & (np.abs(array) <= FARTHEST_M)
    invalid = ~(valid.all(axis=1) if width else valid)
    if invalid.any():
        first = int(np.flatnonzero(invalid)[0])
        expected = "lengths above 0 m" if above == 0.0 else f"numbers within +-{FARTHEST_M:g}"
        raise InputError("objects", f"object {first}: {name}", expected, array[first].tolist())
    return array


def _indices(name: str, values: ArrayLike, count: int, below: int | None = None) -> Ints:
    """Return (N,) integers from 0, or raise `InputError`."""
    array = numbers(values)
    limit = np.inf if below is None else below
    if array is None or array.shape != (count,) or not _whole(array, limit):
        range_text = "" if below is None else f" below {below}, the number of class_names"
        expected = f"{count} whole numbers from 0{range_text}, one an object"
        raise InputError("objects", name, expected, shown(values))
    return array.astype(np.int64)


def _whole(values: Floats, below: float) -> bool:
    return bool(((values >= 0.0) & (values < below) & (values == np.floor(values))).all())
