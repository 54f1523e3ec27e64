"""Planes of a vehicle that zones are anchored to, and lengths measured from them.

A place is written as a plane and an offset: ``front + 0.8`` is 0.8 m ahead of the foremost plane.
Offsets from an outer plane (front, rear, left, right, near, off) run outwards; those from the
other planes run forward or to the left. ``25 %`` is that share of the vehicle's extent, from the
rear or from the right.

Axles and mirrors of a body whose parts have no telling names are found by shape: many foreign
meshes are one part, or have parts named ``Mesh.003``. All that touches the ground are tyres; a
mirror is a small piece high up that sticks out at both sides.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ...base.arrays import Flags, Floats, Ints, ReadOnlyDict, read_only
from ...base.errors import InputError, shown
from ...base.values import FINITE, LENGTH, real
from ...scene.vehicle import Vehicle
from ...scene.vehicle_description import Reference, guessed_reference, is_called

CONTACT_M = 0.03
"""Height above the lowest point at which tyres are cut: a tyre of 0.3 m radius is 0.27 m long."""
GAP_M = 0.3
"""Contact patches that are nearer than this along the vehicle are on one axle."""
PATCH_M = 1.0
"""A longer contact patch is no tyre: a body that lies on the ground, or a plane under it."""
SIDE_SHARE = 0.15
"""Tyres are farther than this share of the width from the middle, on both sides."""
MIRROR_M = 1.2  # Largest side of a mirror with its arm; those of a coach are 1 m long
MIRROR_LOW_M = 0.5  # A mirror is higher above the lowest point than this
STICKS_OUT_M = 0.02
TWIN_M = 0.1
"""Largest difference of a mirror and the mirror image of the one on the other side."""
MIN_WIDTH = 0.7
"""Without its mirrors a body has at least this share of its width; else none are found."""
WELD_M = 1e-4
"""Corners on one grid of this size are one: triangles that share it hang together."""
MAX_FACES = 300_000  # Larger bodies are not searched for mirrors: it would take seconds
Place = float | str
"""A coordinate of a zone: metres in the ground frame, or a plane with an offset."""
PlaneSource = dict[str, Any]
FOUND = ("mesh", "without named", "without shaped", "stated", "wheels", "tyres", "door")
"""Codes of how planes are found: of the mesh; without `parts` that are named mirrors, or without
what has the shape of mirrors in ranges `x` and `z` [m]; each perhaps `below` a height [m]; stated
in the study; of parts named wheel, tire or tyre; where tyres touch the ground; the rear edge of a
door."""
MIRRORS = ("mirror", "antenna", "aerial", "wiper")
"""Beginnings of words in the names of parts that the planes leave out, as UN R159 does."""
DOORS = ("door",)
NO_DOORS = ("window", "windows", "handle", "mirror")
LONGEST_DOOR_M = 1.8
"""A longer part is several doors, of which the rear edge is not that of the first."""
SIDES = ("left", "right")
OUTWARD = {"front": 1.0, "rear": -1.0, "left": 1.0, "right": -1.0}
X_PLANES = ("front", "rear", "front_axle", "rear_axle", "door", "eyes", "center", "origin")
Y_PLANES = ("left", "right", "near", "off", "center", "origin")
PLACE = re.compile(r"(?:([a-z_]+)|([0-9.]+)\s*%)\s*(?:([+-])\s*([0-9.]+))?")
MAX_SHARE = 100.0
DECIMALS = 6
"""Coordinates are rounded to the micrometre."""
OCTAGON = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)], float)


def axles_of(vehicle: Vehicle) -> tuple[float, float] | None:
    """Return x of the rearmost and the foremost axle [m], by where tyres touch the ground. None
    where what touches the ground are not tyres on both sides of two axles or more."""
    triangles = vehicle.triangles
    height = float(triangles[..., 2].min()) + CONTACT_M
    points = parts_below(triangles[triangles[..., 2].min(axis=1) <= height], height)
    low = np.nanmin(points, axis=1)
    high = np.nanmax(points, axis=1)
    right = vehicle.bounds[0][1]
    left = vehicle.bounds[1][1]
    off = SIDE_SHARE * (left - right)
    is_left = low[:, 1] - (left + right) / 2.0 > off
    if not (is_left | (high[:, 1] - (left + right) / 2.0 < -off)).all():
        return None
    order = np.argsort(low[:, 0])
    low = low[order, 0]
    high = np.maximum.accumulate(high[order, 0])
    is_left = is_left[order]
    ends = np.flatnonzero(low[1:] - high[:-1] > GAP_M) + 1
    axles = []
    for part in np.split(np.arange(len(low)), ends):
        rear = float(low[part[0]])
        front = float(high[part[-1]])
        if front - rear > PATCH_M or is_left[part].all() or not is_left[part].any():
            return None
        axles.append((rear + front) / 2.0)
    return (axles[0], axles[-1]) if len(axles) > 1 else None


@lru_cache(maxsize=4)
def mirror_faces(vehicle: Vehicle) -> Flags:
    """Return which triangles (F,) are mirrors by their shape; none where it is not clear. Pieces
    that hang together are mirrors if they are small and high up, stick out beyond all larger
    pieces, and have a twin on the other side."""
    triangles = vehicle.triangles
    none = read_only(np.zeros(len(triangles), bool))
    if len(triangles) > MAX_FACES:
        return none
    piece, count = _pieces(triangles)
    low = np.full((count, 3), np.inf)
    high = np.full((count, 3), -np.inf)
    np.minimum.at(low, piece, triangles.min(axis=1))
    np.maximum.at(high, piece, triangles.max(axis=1))
    ground = float(low[:, 2].min())
    small = ((high - low).max(axis=1) <= MIRROR_M) & (low[:, 2] > ground + MIRROR_LOW_M)
    if small.all() or not small.any():
        return none
    right = float(low[~small, 1].min())
    left = float(high[~small, 1].max())
    if left - right < MIN_WIDTH * float(high[:, 1].max() - low[:, 1].min()):
        return none
    out = small & ((high[:, 1] > left + STICKS_OUT_M) | (low[:, 1] < right - STICKS_OUT_M))
    image_low = low.copy()
    image_high = high.copy()
    image_low[:, 1] = left + right - high[:, 1]
    image_high[:, 1] = left + right - low[:, 1]
    found = np.flatnonzero(out)
    away = np.maximum(
        np.abs(low[found, None] - image_low[None, found]).max(axis=2),
        np.abs(high[found, None] - image_high[None, found]).max(axis=2),
    )
    mirrors = np.zeros(count, bool)
    mirrors[found] = (away <= TWIN_M).any(axis=1)
    return read_only(mirrors[piece])


def parts_below(triangles: Floats, height: float) -> Floats:
    """Return points (F, 6, 3) of triangles below a height: corners and cuts of edges, else NaN."""
    a = triangles
    b = triangles[:, [1, 2, 0]]
    rise = b[..., 2] - a[..., 2]
    is_cut = (a[..., 2] <= height) != (b[..., 2] <= height)
    share = (height - a[..., 2]) / np.where(is_cut, rise, 1.0)
    cuts = np.where(is_cut[..., None], a + share[..., None] * (b - a), np.nan)
    return np.concatenate([np.where(a[..., 2:] <= height, a, np.nan), cuts], axis=1)


def _pieces(triangles: Floats) -> tuple[Ints, int]:
    """Return the piece (F,) that each triangle is of, and the number of pieces. The smallest number
    of a corner spreads over the piece; paths are halved between two rounds."""
    grid = np.round((triangles - triangles.min(axis=(0, 1))) / WELD_M).astype(np.int64)
    keys = (grid[..., 0] << 42) + (grid[..., 1] << 21) + grid[..., 2]
    _, corner = np.unique(keys, return_inverse=True)
    corner = corner.reshape(-1, 3)
    label = np.arange(int(corner.max()) + 1)
    while True:
        smallest = label[corner].min(axis=1)
        spread = label.copy()
        for k in range(3):
            np.minimum.at(spread, corner[:, k], smallest)
            np.minimum.at(spread, label[corner[:, k]], smallest)
        spread = spread[spread]
        if np.array_equal(spread, label):
            break
        label = spread
    _, piece = np.unique(label[corner[:, 0]], return_inverse=True)
    return piece, int(piece.max()) + 1


@dataclass(frozen=True, eq=False)
class VehiclePlanes:
    """The planes of a vehicle by name, and its outline seen from above.

    `along, across`: x of the planes across the vehicle, y of the planes along it [m].
    `found`: By plane how it was found: a `code` (`FOUND`), and values.
    `missing`: By plane that was not found: what would be needed.
    `outline` (K, 2): Corners of the convex outline of the body seen from above, counter-clockwise
        [m].
    """

    along: Mapping[str, float]
    across: Mapping[str, float]
    found: Mapping[str, PlaneSource]
    missing: Mapping[str, str]
    outline: Floats

    @classmethod
    def of(
        cls,
        vehicle: Vehicle,
        reference: Reference | None = None,
        below: float | None = None,
        near_side: str = "right",
        eyes: float | None = None,
    ) -> "VehiclePlanes":
        """Find the planes of a vehicle.

        `reference`: The axles; by default those of parts that are wheels by name, else of tyres by
            shape.
        `below`: What is higher than this is left out [m], as UN R159 leaves out what is above 2.0
            m.
        `near_side` {"left", "right"}: The side of the kerb.
        `eyes`: x of the driver's eyes [m].
        """
        points, how = _body_points(vehicle, below)
        low = points[:, :2].min(axis=0)
        high = points[:, :2].max(axis=0)
        along = {"front": float(high[0]), "rear": float(low[0]), "origin": 0.0}
        across = {"left": float(high[1]), "right": float(low[1]), "origin": 0.0}
        along["center"], across["center"] = ((low + high) / 2.0).tolist()
        across["near"], across["off"] = (
            across[side] for side in (SIDES if near_side == "left" else SIDES[::-1])
        )
        found: dict[str, PlaneSource] = dict.fromkeys((*OUTWARD, "near", "off", "center"), how)
        missing = _add_axles(along, found, vehicle, reference)
        driver = SIDES[near_side == SIDES[0]]
        missing |= _add_door(along, found, vehicle, driver, middle=across["center"])
        if eyes is None:
            missing["eyes"] = "eyes = x of the driver's eyes"
        else:
            along["eyes"] = eyes
            found["eyes"] = {"code": "stated"}
        rounded = ({k: round(v, DECIMALS) for k, v in own.items()} for own in (along, across))
        x, y = (ReadOnlyDict(each) for each in rounded)
        outline = read_only(convex_outline(points[:, :2]))
        return cls(x, y, found, missing, outline=outline)

    def coordinate(self, axis: int, place: Place, near_side: str, source: str, field: str) -> float:
        """Return a coordinate [m] of a place along x (0) or y (1), or raise `InputError`."""
        if not isinstance(place, str):
            return FINITE.checked(source, field, place)
        name, share, sign, offset = parsed(axis, place, source, field)
        planes = (self.along, self.across)[axis]
        shift = (-1.0 if sign == "-" else 1.0) * offset
        if name is None:
            low, high = (planes[n] for n in (("rear", "front"), ("right", "left"))[axis])
            return round(low + share / MAX_SHARE * (high - low) + shift, DECIMALS)
        if name not in planes:
            raise InputError(source, field, f"{self.missing[name]}, for the plane {name}", "none")
        other = "left" if near_side == "right" else "right"
        outer = {"near": near_side, "off": other}.get(name, name)
        return round(planes[name] + OUTWARD.get(outer, 1.0) * shift, DECIMALS)


def parsed(
    axis: int, place: str, source: str, field: str
) -> tuple[str | None, float, str | None, float]:
    """Return plane (or None), share [%], sign and offset [m] of a place written as text.
    `InputError` when it is no plane with an offset, or the plane is one of the other axis."""
    known = (X_PLANES, Y_PLANES)[axis]
    match = PLACE.fullmatch(place.strip())
    name, share, sign, offset = match.groups() if match else (None, None, None, None)
    numbers = [real_text(share), real_text(offset)]
    far = any(not number <= LENGTH.cap for number in numbers)  # NaN, too
    wrong = match is None or far or numbers[0] > MAX_SHARE
    if wrong or (name is not None and name not in known):
        expected = f"metres, or a plane and an offset (front + 0.8), planes {', '.join(known)}, N %"
        raise InputError(source, field, expected, shown(place))
    return name, numbers[0], sign, numbers[1]


def real_text(text: str | None) -> float:
    """Return the number of a text, 0 of None, NaN of what is none."""
    try:
        return 0.0 if text is None else real(float(text))
    except ValueError:
        return float("nan")


def convex_outline(points: Floats) -> Floats:
    """Return the corners (K, 2) of the convex hull of points (N, 2), counter-clockwise. Andrew's
    monotone chain; before, points inside the octagon of the extreme points are dropped."""
    extreme = points[[int(np.argmax(points @ d)) for d in OCTAGON]]
    inside = np.ones(len(points), bool)
    for a, b in zip(extreme, np.roll(extreme, -1, axis=0), strict=True):
        side = (b[0] - a[0]) * (points[:, 1] - a[1]) - (b[1] - a[1]) * (points[:, 0] - a[0])
        inside &= (side > 0.0) | bool((a == b).all())
    kept = np.unique(np.round(np.vstack([points[~inside], extreme]), DECIMALS), axis=0)
    ordered = [tuple(p) for p in kept.tolist()]
    lower = _chain(ordered)
    upper = _chain(ordered[::-1])
    return np.array(lower[:-1] + upper[:-1] or ordered)


def _chain(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    chain: list[tuple[float, float]] = []
    for x, y in points:
        while len(chain) > 1:
            (ax, ay), (bx, by) = chain[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                break
            chain.pop()
        chain.append((x, y))
    return chain


def _body_points(vehicle: Vehicle, below: float | None) -> tuple[Floats, PlaneSource]:
    """Return corners (N, 3) of the body without mirrors, below a height, and how it was made."""
    names = vehicle.part_names
    named = [k for k, name in enumerate(names) if is_called(name, MIRRORS, ())]
    left_out = np.isin(vehicle.parts, named) if named else mirror_faces(vehicle)
    body = vehicle.triangles[~left_out]
    how: PlaneSource = {"code": "mesh"}
    if named and len(body):
        how = {"code": "without named", "parts": [names[k] for k in named]}
    elif left_out.any():
        x = vehicle.triangles[left_out][..., 0]
        z = vehicle.triangles[left_out][..., 2]
        x_m, z_m = ([round(float(end), 2) for end in (w.min(), w.max())] for w in (x, z))
        how = {"code": "without shaped", "x": x_m, "z": z_m}
    body = body if len(body) else vehicle.triangles
    if below is None:
        return body.reshape(-1, 3), how
    low = parts_below(body, below).reshape(-1, 3)
    low = low[~np.isnan(low[:, 0])]
    return (low, how | {"below": below}) if len(low) else (body.reshape(-1, 3), how)


def _add_axles(
    along: dict[str, float],
    found: dict[str, PlaneSource],
    vehicle: Vehicle,
    reference: Reference | None,
) -> dict[str, str]:
    """Add the axles to the planes; return what is missing."""
    own = reference or guessed_reference(vehicle)
    if own is None:
        if (axles := axles_of(vehicle)) is None:
            needed = "[reference] with the axles, parts named wheel, tire or tyre, or tyres alone "
            needed += "on the ground"
            return {"rear_axle": needed, "front_axle": needed}
        for name, x in zip(("rear_axle", "front_axle"), axles, strict=True):
            along[name] = x
            found[name] = {"code": "tyres"}
        return {}
    how: PlaneSource = {"code": "stated" if reference is not None else "wheels"}
    along["rear_axle"] = own.rear_axle_x
    found["rear_axle"] = how
    if own.wheelbase is None:
        return {"front_axle": "[reference] with a wheelbase"}
    along["front_axle"] = own.rear_axle_x + own.wheelbase
    found["front_axle"] = how
    return {}


def _add_door(
    along: dict[str, float],
    found: dict[str, PlaneSource],
    vehicle: Vehicle,
    side: str,
    middle: float,
) -> dict[str, str]:
    """Add the rear edge of the driver's door to the planes; return what is missing.

    It is the foremost part named door that lies along the driver's side and ahead of the rear axle:
    doors of the other side, of a trailer and at the rear are none. `middle` is y of the vehicle's.
    """
    named = [k for k, name in enumerate(vehicle.part_names) if is_called(name, DOORS, NO_DOORS)]
    named = [k for k in named if (vehicle.parts == k).any()]
    if not named:
        return {"door": "a part whose name has the word door"}
    if "rear_axle" not in along:
        return {"door": "[reference] with the rear axle: the driver's door is ahead of it"}
    doors: dict[str, tuple[float, float]] = {}
    for k in named:
        corners = vehicle.triangles[vehicle.parts == k]
        beside = (OUTWARD[side] * (corners[..., 1] - middle)).min(axis=1) > 0.0
        if not beside.any():
            continue
        low = corners[beside].min(axis=(0, 1))
        high = corners[beside].max(axis=(0, 1))
        length, depth = (high - low)[:2].tolist()
        if depth < length <= LONGEST_DOOR_M and low[0] > along["rear_axle"]:
            doors[vehicle.part_names[k]] = float(low[0]), float(high[0])
    if not doors:
        names = ", ".join(vehicle.part_names[k] for k in named)
        needed = f"a door on the driver's side ({side}), ahead of the rear axle, at most "
        return {"door": f"{needed}{LONGEST_DOOR_M:g} m long; not {names}"}
    foremost = max(doors, key=lambda name: sum(doors[name]))
    along["door"] = doors[foremost][0]
    found["door"] = {"code": "door", "parts": [foremost]}
    return {}
