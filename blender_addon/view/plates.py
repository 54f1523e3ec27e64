"""The plates over a 3D view, in one layout: the read-out, strips, pictures, legends.

A drawer says at each redraw which plates it has, each in sizes from whole to folded into its title.
`laid_out` says where they go: plain numbers, which no window is needed for. What there is no room
for becomes smaller, the least important plate first, and is left out at last.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

from ..engine import Floats, graphics
from . import viewport
from .viewport import PlateBox

MAX_SHARE = 0.25
"""Of the view beside its sidebar, which plates cover at most."""
GAP = 6.0
GIZMOS = 330.0
BESIDE_GIZMOS = 48.0
"""Height and width of Blender's own gizmos, from the upper right corner."""
DRIVE_BY, CAMERAS, READOUT, BIRDS_EYE, LEGEND = range(5)
"""Kinds of plates, from below: those along the lower and the left edge, and legends."""
FOLDED_FIRST = (LEGEND, BIRDS_EYE, CAMERAS, DRIVE_BY, READOUT)
"""Kinds from the least important one."""
AT_LEFT = (BIRDS_EYE, CAMERAS, DRIVE_BY, READOUT)
"""Those that are above each other at the left edge, in the same order."""
CornerPair = tuple[Floats, Floats]  # Lowest and highest corner [m]


class PlateSize(NamedTuple):
    """Width and height of a plate [px]."""

    width: float
    height: float

    @property
    def area(self) -> float:
        """What it covers [px²]."""
        return self.width * self.height


class Plate(NamedTuple):
    """A plate of a redraw: `sizes` from whole to folded; `draw` takes its box and how often it was
    made smaller: an index of `sizes`."""

    kind: int
    sizes: tuple[PlateSize, ...]
    draw: Callable[[PlateBox, int], None]


class PlacedPlate(NamedTuple):
    """Where a plate is drawn [px], in which of its sizes."""

    box: PlateBox
    step: int


class Room(NamedTuple):
    """What plates are laid out in [px]: between toolbar and sidebar, above the panel of the last
    operation and below the headers; what is there; the vehicle; the area that they cover at
    most."""

    box: PlateBox
    scale: float
    taken: Sequence[PlateBox] = ()
    vehicle: PlateBox | None = None
    area: float = np.inf

    @property
    def width(self) -> float:
        """Between toolbar and sidebar [px]."""
        return self.box[2] - self.box[0]

    @property
    def height(self) -> float:
        """Between the panel of the last operation and the headers [px]."""
        return self.box[3] - self.box[1]

    @property
    def gap(self) -> float:
        """Between two plates [px]."""
        return GAP * self.scale


Drawer = Callable[[bpy.types.Context, Room], Iterable[Plate]]
"""Returns what it would draw into the present region; the most important of a kind first."""
_drawers: dict[str, Drawer] = {}
_layouts: dict[int, tuple[object, list[PlacedPlate | None]]] = {}
"""By the region's pointer, what the last layout was made from, and the layout."""


def show(name: str, drawer: Drawer) -> None:
    """Have the plates of a drawer drawn at each redraw."""
    _drawers[name] = drawer


def hide(name: str) -> None:
    """Draw them no more; do nothing if they are not."""
    _drawers.pop(name, None)
    _layouts.clear()


def draw(
    context: bpy.types.Context,
    drawer: Drawer,
    *,
    vehicle: CornerPair | None,
    taken: Sequence[PlateBox] = (),
) -> list[PlateBox]:
    """Draw the plates of a drawer, and of all that are shown, into the present region, clear of the
    vehicle and of boxes that are taken. Return the boxes that are covered: those of the plates, and
    those of Blender's own."""
    room = room_of(context, vehicle, taken)
    drawers = [*_drawers.values(), drawer]
    plates = [each for shown in drawers for each in shown(context, room)]
    plates.sort(key=lambda plate: plate.kind)
    drawn = []
    for plate, placed in zip(plates, _layout_of(context.region, plates, room), strict=True):
        if placed is not None:
            plate.draw(placed.box, placed.step)
            drawn.append((plate.kind, placed.box))
    viewport.note_plates(context.region.as_pointer(), drawn)
    return [*room.taken, *(box for _, box in drawn)]


def room_of(
    context: bpy.types.Context, vehicle: CornerPair | None, taken: Sequence[PlateBox]
) -> Room:
    """Return the room of the present region."""
    scale = viewport.ui_scale()
    right = viewport.sidebar_left(context)
    width = float(context.region.width)
    height = float(context.region.height)
    margin = viewport.MARGIN * scale
    box = (
        viewport.beside_toolbar(context),
        viewport.above_hud(context),
        right - margin,
        height - viewport.HEADER * scale,
    )
    blenders = [
        (right - BESIDE_GIZMOS * scale, height - GIZMOS * scale, right, height),
        (right, 0.0, width, height),
    ]
    return Room(
        box,
        scale=scale,
        taken=[*blenders, *taken],
        vehicle=_box_of(context, vehicle),
        area=MAX_SHARE * max(right, 0.0) * height - sum(map(_area, taken)),
    )


def _layout_of(
    region: bpy.types.Region, plates: Sequence[Plate], room: Room
) -> list[PlacedPlate | None]:
    """Return the layout of a region: that of the last redraw while it has the same plates."""
    key = tuple((plate.kind, plate.sizes) for plate in plates), room
    known = _layouts.get(region.as_pointer())
    if known is None or known[0] != key:
        known = _layouts[region.as_pointer()] = (key, laid_out(plates, room))
    return known[1]


def laid_out(plates: Sequence[Plate], room: Room) -> list[PlacedPlate | None]:
    """Return where plates go, in the order of their kinds; None for one that there is no room for.

    No plate is over another one, over what is taken or over the vehicle, and all together cover no
    more than the room's area. The read-out alone is drawn, folded, where only the vehicle is in its
    way: who places a sensor looks at both.
    """
    steps = _steps(plates, room)
    covered = list(room.taken)
    found: list[PlacedPlate | None] = []
    for plate, first in zip(plates, steps, strict=True):
        placed = None if first is None else _placed(plate, first, room, covered)
        found.append(placed)
        covered += [] if placed is None else [placed.box]
    return found


def _steps(plates: Sequence[Plate], room: Room) -> list[int | None]:
    """Return in which size each plate is at most, so that those at the left edge fit above each
    other, and all cover no more than the area; None: it is left out."""
    steps: list[int | None] = [0] * len(plates)

    def sizes(kinds: Iterable[int]) -> list[PlateSize]:
        pairs = zip(plates, steps, strict=True)
        return [p.sizes[s] for p, s in pairs if s is not None and p.kind in kinds]

    def is_too_high() -> bool:
        return sum(size.height + room.gap for size in sizes(AT_LEFT)) > room.height + room.gap

    def is_too_large() -> bool:
        return sum(size.area for size in sizes(FOLDED_FIRST)) > room.area

    for is_too_much, kinds in ((is_too_high, AT_LEFT), (is_too_large, FOLDED_FIRST)):
        for k, step in _smaller(plates, kinds):
            if not is_too_much():
                break
            now = steps[k]
            steps[k] = None if step is None or now is None else max(now, step)
    return steps


def _smaller(plates: Sequence[Plate], kinds: Sequence[int]) -> Iterator[tuple[int, int | None]]:
    """Yield numbers of plates and their next size, the least important plate first; at last None:
    it is left out."""
    numbers = [(kind, k) for k, plate in enumerate(plates) if (kind := plate.kind) in kinds]
    order = [k for _, k in sorted(numbers, key=lambda pair: (kinds.index(pair[0]), -pair[1]))]
    for k in order:
        yield from ((k, step) for step in range(1, len(plates[k].sizes)))
    yield from ((k, None) for k in order)


def _placed(
    plate: Plate, first: int, room: Room, covered: Sequence[PlateBox]
) -> PlacedPlate | None:
    """Return where a plate goes in the largest size, from a first one on, that fits."""
    sizes = list(enumerate(plate.sizes))[first:]
    for step, size in sizes:
        box = _free_box(size, room, covered, at_left=plate.kind != LEGEND)
        if box is not None:
            return PlacedPlate(box, step)
    if plate.kind != READOUT:
        return None
    step, size = sizes[-1]
    box = _free_box(size, room._replace(vehicle=None), covered, at_left=True)
    return None if box is None else PlacedPlate(box, step)


def _free_box(
    size: PlateSize, room: Room, covered: Sequence[PlateBox], *, at_left: bool
) -> PlateBox | None:
    """Return the lowest free box of a size: at the left edge, or at the right one if it can be, and
    else the one farthest left; None: there is none."""
    left, bottom, right, top = room.box
    width, height = size
    gap = room.gap
    blocks = [*covered, *([] if room.vehicle is None else [room.vehicle])]
    at_edge = left if at_left else right - width
    across = [at_edge]
    if not at_left:
        across += sorted(
            {left, *(b[2] + gap for b in blocks), *(b[0] - gap - width for b in blocks)}
        )
    up = sorted({bottom, *(b[3] + gap for b in blocks), *(b[1] - gap - height for b in blocks)})
    up = [y for y in up if bottom <= y <= top - height]
    for columns in ([at_edge], across[1:]):
        for y in up:
            for x in columns:
                box = (x, y, x + width, y + height)
                is_within = left <= x and box[2] <= right
                if is_within and not any(graphics.boxes_overlap(box, each) for each in blocks):
                    return box
    return None


def _area(box: PlateBox) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def _box_of(context: bpy.types.Context, vehicle: CornerPair | None) -> PlateBox | None:
    """Return the box of the vehicle in the view; None without one, or where the eye is in it."""
    if vehicle is None:
        return None
    ends = np.array(vehicle)
    corners = [(ends[i, 0], ends[j, 1], ends[k, 2]) for i, j, k in np.ndindex(2, 2, 2)]
    places = [
        location_3d_to_region_2d(context.region, context.region_data, corner) for corner in corners
    ]
    if any(place is None for place in places):
        return None
    x, y = zip(*((place.x, place.y) for place in places), strict=True)
    return min(x), min(y), max(x), max(y)
