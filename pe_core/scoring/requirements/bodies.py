"""Test bodies: what stands in a zone, as upright boxes that lie wholly inside the body.

A beam that meets a box inside a body also meets the body, and the image of the box lies inside
that of the body. So a body never gets fewer beams or pixels than its box: verdicts err to the safe
side.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np

from ...base.arrays import Flags, Floats, Ints
from ...base.codec import Node, hook, read, write
from ...base.errors import InputError, shown
from ...base.setting import Each, Named, Part, Triple
from ...base.values import A_NAME, Angle, Number, choice
from ...prior.classes import ROAD_CLASSES

LENGTH = Number(1e-3, 100.0, unit="m", noun="length")
HEADINGS = Each(Angle(-360.0, 360.0), most=72)
LOW = Number(0.0, 100.0, unit="m", noun="length")
BAND_M = 0.1
"""Height of the bands of a body whose visible share is asked for."""
RING_PLACES = 16
"""Places round a ring at which it has to be seen, each at its lower and its upper edge. They are
turned by a quarter of a step, so that those of the far half are between those of the near half:
what hides a strip of 5 mm hides one of them."""
RING_CELL_M = 1e-3
"""Side of the cells of a ring, and of the posts at the corners of its box: less than a pixel."""
CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
COLUMN_M = 0.5
MAX_COLUMNS = 4
"""A body is one column wide and long up to `COLUMN_M`, at most `MAX_COLUMNS` beyond."""
_BEFORE = slice(None, -2)
_AFTER = slice(2, None)
DIAGONALS = ((_BEFORE, _BEFORE), (_BEFORE, _AFTER), (_AFTER, _BEFORE), (_AFTER, _AFTER))
"""The diagonal neighbours of all columns, as slices of a band of `cell_plan`."""
POST_EVERY = 4
POST_SHARE = 0.25
"""Side of the posts beside a body, as a share of its shorter horizontal side."""
FLAT_M = 1e-3  # Thickness of a patch of ground
_ALONG = (0.0, math.pi / 2.0)
_PRIOR = "core of the class of the road prior (docs/metric.md)"


@dataclass(frozen=True, slots=True)
class Body:
    """A test body.

    `InputError` when a size is none.

    `size` (3,): Length along the heading, width, height [m]; of a round body twice the diameter.
    `low`: Height of its lower edge above its foot [m].
    `is_round`: Whether it is an upright cylinder; then the box inside has 0.71 times its diameter.
    `is_ring`: Whether it is the rim of the cylinder that has to be seen, all round.
    `class_name`: Its class of objects, for criteria of AP.
    `headings`: Headings at which it stands at every sample [rad].
    `source`: Where its size is from.
    """

    name: str
    size: tuple[float, float, float]
    low: float = 0.0
    is_round: bool = False
    is_ring: bool = False
    class_name: str | None = None
    headings: tuple[float, ...] = (0.0,)
    source: str = ""

    def __post_init__(self) -> None:
        who = f"body {A_NAME.checked('body', 'name', self.name)!r}"
        size = tuple(LENGTH.checked(who, "size", v) for v in self.size)
        if len(size) != 3:
            raise InputError(who, "size", "length, width, height", shown(self.size))
        object.__setattr__(self, "size", size)
        object.__setattr__(self, "low", LOW.checked(who, "low", self.low))
        object.__setattr__(self, "headings", HEADINGS.checked(who, "headings", self.headings))

    @property
    def box(self) -> tuple[float, float, float]:
        """Length, width and height [m] of the box inside the body."""
        length, width, height = self.size
        inside = math.sqrt(0.5) if self.is_round else 1.0
        return length * inside, width * inside, height

    @property
    def hiding(self) -> tuple[float, float, float]:
        """Length, width and height [m] of the box that hides what is behind the body.

        It is the extent of the body; of one of `BODIES` at least the mean box of its class in the
        road prior: those of `BODIES` are small, which is safe only for what has to be seen.
        """
        sizes = [self.size]
        if BODIES.get(self.name) == self:
            sizes += [each.size for each in ROAD_CLASSES if each.name == self.class_name]
        length, width, height = np.max(sizes, axis=0).tolist()
        return length, width, height

    @property
    def largest(self) -> float:
        """The longest horizontal side [m]."""
        return max(self.size[:2])

    def boxes(self, cells: bool) -> tuple[Floats, Floats]:
        """Return centres (K, 3), from the foot, and sizes (K, 3) of the body's boxes [m].

        `cells`: The cells of which a share has to be visible, and the posts beside the body,
            instead of the one box: band after band, those of `cell_plan`. Of a ring,
            `_ring_cells`.
        """
        length, width, height = self.box
        if not cells:
            center = [0.0, 0.0, self.low + height / 2.0]
            return np.array([center]), np.array([[length, width, height]])
        if self.is_ring:
            return self._ring_cells()
        along, across = (self._divided(axis) for axis in (0, 1))
        k, i, j = np.nonzero(cell_plan(self.bands, *self.columns))
        z = self.low + (k + 0.5) * height / self.bands
        thick = np.full(len(k), height / self.bands)
        sizes = np.stack([along[i, 1], across[j, 1], thick], axis=1)
        return np.stack([along[i, 0], across[j, 0], z], axis=1), sizes

    def cell_bands(self) -> tuple[Ints, Flags]:
        """Return the band of each of `boxes(True)` (K,), and whether it is a post."""
        if self.is_ring:
            posts = np.repeat([False, True], [2 * RING_PLACES, len(CORNERS)])
            return np.zeros(len(posts), np.int64), posts
        k, i, j = np.nonzero(cell_plan(self.bands, *self.columns))
        along, across = self.columns
        inner = np.ones(len(k), bool)
        inner &= (i > 0) & (i <= along) & (j > 0) & (j <= across)
        return k, ~inner

    def _ring_cells(self) -> tuple[Floats, Floats]:
        """Return centres (K, 3), from the foot, and sizes (K, 3) of the cells of a ring [m].

        First cells inside the ring, at its edges all round. Then posts outside the corners of its
        box: if a plane through the camera cuts the ring, as a side of the picture does, one of them
        is wholly on the side that is not seen.
        """
        radius = self.size[0] / 2.0
        height = self.size[2]
        turns = (np.arange(RING_PLACES) + 0.25) * (2.0 * math.pi / RING_PLACES)
        away = radius - RING_CELL_M * math.sqrt(0.5)
        around = np.array([(away * math.cos(a), away * math.sin(a)) for a in turns.tolist()])
        edge = (height - RING_CELL_M) / 2.0
        inside = np.column_stack([np.tile(around, (2, 1)), np.repeat([-edge, edge], RING_PLACES)])
        corners = CORNERS * (np.array([radius, radius, height / 2.0]) + RING_CELL_M / 2.0)
        centers = np.concatenate([inside, corners])
        centers[:, 2] += self.low + height / 2.0
        return centers, np.full(centers.shape, RING_CELL_M)

    def shells(self) -> tuple[Floats, Floats, Ints]:
        """Return boxes round a cylinder, which its cells do not fill; none of a box. Centres (S, 3)
        from the foot, sizes (S, 3) [m], and bands (S,)."""
        tall = self.size[2] / self.bands
        count = self.bands if self.is_round and not self.is_ring else 0
        bands = np.arange(count)
        centers = np.zeros((count, 3))
        centers[:, 2] = self.low + (bands + 0.5) * tall
        return centers, np.tile([*self.size[:2], tall], (count, 1)), bands

    @property
    def bands(self) -> int:
        """Number of bands of equal height."""
        return max(1, math.ceil(self.size[2] / BAND_M - 1e-9))

    @property
    def columns(self) -> tuple[int, int]:
        """Number of the columns along and across into which the body is divided."""
        along, across = (
            min(MAX_COLUMNS, max(1, math.ceil(side / COLUMN_M - 1e-9))) for side in self.size[:2]
        )
        return along, across

    def _divided(self, axis: int) -> Floats:
        """Return centre and width (C + 2, 2) of the columns along an axis, and of both posts."""
        count = self.columns[axis]
        inside = self.box[axis]
        post = POST_SHARE * min(self.size[:2])
        away = (self.size[axis] + post) / 2.0
        middles = ((np.arange(count) + 0.5) / count - 0.5) * inside
        widths = [post, *[inside / count] * count, post]
        return np.column_stack([[-away, *middles, away], widths])


@cache
def cell_plan(bands: int, along: int, across: int) -> Flags:
    """Return which cells (bands, along + 2, across + 2) of a body are measured.

    Those inside the edge are the columns of the body, those at the edge posts beside the body: the
    diagonal neighbours of columns, in the bands of `post_bands`. A post touches the body's extent
    from outside. So if a side of the picture, which is a plane through the camera, cuts a column,
    it also leaves out all of a diagonal neighbour, there or in the next post above or below.
    """
    plan = np.zeros((bands, along + 2, across + 2), bool)
    for rows, columns in DIAGONALS:
        plan[post_bands(bands), rows, columns] = True
    plan[:, 1:-1, 1:-1] = True
    plan.setflags(write=False)
    return plan


def post_bands(bands: int) -> list[int]:
    """Return the bands that have posts: the lowest, the highest, and each `POST_EVERY`-th."""
    return sorted({*range(0, bands, POST_EVERY), bands - 1})


BODIES: Mapping[str, Body] = MappingProxyType(
    {
        body.name: body
        for body in (
            Body(
                "cylinder",
                (0.3, 0.3, 0.8),
                is_round=True,
                class_name="pedestrian",
                source="UN R158 and FMVSS 111: 0.8 m high, 0.3 m in diameter",
            ),
            Body(
                "pole_ring",
                (0.05, 0.05, 0.01),
                low=0.9,
                is_round=True,
                is_ring=True,
                source="UN R159 Annex 3: ring of 10 mm on a pole of 50 mm, lower edge at 900 mm",
            ),
            Body(
                "patch", (0.15, 0.15, FLAT_M), source="a patch of ground of 0.15 m, as in UN R158"
            ),
            Body(
                "child",
                (0.2, 0.2, 1.1),
                class_name="pedestrian",
                source="core of a child; the targets of tests are somewhat taller and wider "
                "(unchecked)",
            ),
            Body("adult", (0.3, 0.3, 1.7), class_name="pedestrian", source=_PRIOR),
            Body(
                "cyclist",
                (0.5, 0.35, 1.7),
                class_name="cyclist",
                headings=_ALONG,
                source=f"the rider: {_PRIOR}",
            ),
            Body(
                "motorcyclist",
                (0.6, 0.4, 1.4),
                class_name="cyclist",
                headings=_ALONG,
                source="the rider: an estimate (unchecked)",
            ),
            Body(
                "car",
                (4.1, 1.7, 1.3),
                class_name="car",
                headings=_ALONG,
                source="smallest small car of Euro NCAP Low Speed Collisions v1.1, App. A",
            ),
            Body("pole", (0.05, 0.05, 0.91), is_round=True, source="the pole of `pole_ring`"),
            Body(
                "cone",
                (0.2, 0.2, 0.45),
                is_round=True,
                class_name="cone",
                source="cylinder in the cone of the road prior: 0.4 m wide and 0.9 m high",
            ),
        )
    }
)
"""Bodies by name; sizes are those of the boxes that count, or of the cylinder."""


@dataclass(frozen=True, slots=True)
class BodyTable:
    """The table of a body: one of `BODIES` by its name, or the size of an own one, or its diameter
    and height; and its headings."""

    name: Named = "own"
    size: Annotated[tuple[float, float, float] | None, Part(rule=Triple(LENGTH))] = None
    diameter: Annotated[float | None, Part(rule=LENGTH)] = None
    height: Annotated[float | None, Part(rule=LENGTH)] = None
    low: Annotated[float, Part(rule=LOW)] = 0.0
    class_name: Annotated[str | None, Part(key="class", rule=A_NAME)] = None
    headings: Annotated[tuple[float, ...] | None, Part(rule=HEADINGS)] = None

    def __post_init__(self) -> None:
        is_round = self.diameter is not None and self.height is not None
        if (self.size is None) != is_round and not self.is_known:
            expected = "a size, or a diameter and a height"
            raise InputError("body", "size", expected, "both" if is_round else "neither")

    @property
    def is_known(self) -> bool:
        """Whether it is one of `BODIES`, perhaps with other headings."""
        own = self.size, self.diameter, self.height, self.low, self.class_name
        return self.name in BODIES and not any(own)

    @property
    def body(self) -> Body:
        """The body."""
        is_round = self.diameter is not None
        size = self.size or (self.diameter, self.diameter, self.height)
        made = (
            BODIES[self.name]
            if self.is_known
            else Body(self.name, size, self.low, is_round, class_name=self.class_name)  # type: ignore[arg-type]
        )
        return made if self.headings is None else replace(made, headings=self.headings)


def _read_body(node: Node) -> Body:
    """Return one of `BODIES` by its name, or a body from its table."""
    if isinstance(node.value, Mapping) and set(node.value) != {"name"}:
        own = read(BodyTable, node)
        with node.naming():
            return own.body
    name = node.value["name"] if isinstance(node.value, Mapping) else node.value
    return BODIES[choice(node.source, node.path, name, BODIES)]


def _write_body(body: Body) -> Any:
    known = BODIES.get(body.name)
    if body == known:
        return body.name
    if known is not None and replace(body, headings=known.headings) == known:
        return write(BodyTable(body.name, headings=body.headings))
    width, _, height = body.size
    sizes: Any = {"diameter": width, "height": height} if body.is_round else {"size": body.size}
    headings = None if body.headings == (0.0,) else body.headings
    table = BodyTable(
        body.name, low=body.low, class_name=body.class_name, headings=headings, **sizes
    )
    return write(table)


hook(Body, _read_body, _write_body, {})
