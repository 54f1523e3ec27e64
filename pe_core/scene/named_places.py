"""Named places of a vehicle where sensors usually are, found on any body.

A place is where a ray that comes from outside meets the body: from above for the roof, else level.
Mirrors are the parts of that name, or what stands out most beside the front of the cabin.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats
from ..geometry.poses import cross, dot
from .mesh import BodyShape
from .vehicle import Vehicle
from .vehicle_description import is_called

ROOF = {
    "roof": (0.0, 0.0, 0.0),
    "roof front": (0.92, 0.0, 0.0),
    "roof front left": (0.88, 0.8, 45.0),
    "roof left": (0.0, 0.9, 90.0),
    "roof rear left": (-0.88, 0.8, 135.0),
    "roof rear": (-0.92, 0.0, 180.0),
}
"""Shares of the roof's half length and half width; yaw [deg]. Each on the left has one right."""
LOW = (0.33, 0.3, 0.6)
BELT = (0.4, 0.4, 0.9)
HIGH = (0.62, 0.5, 1.3)
"""Heights of bumpers, of grille and doors, of tailgates: a share of the vehicle's, limits [m]."""
SIDES = {
    "grille": (0.0, 0.0, 0.0, BELT),
    "bumper front": (0.0, 0.0, 0.0, LOW),
    "bumper front middle left": (0.0, 0.38, 0.0, LOW),
    "bumper front left": (0.0, 0.0, 45.0, LOW),
    "fender front left": (0.88, 0.0, 90.0, LOW),
    "side left": (0.0, 0.0, 90.0, BELT),
    "fender rear left": (-0.88, 0.0, 90.0, LOW),
    "bumper rear left": (0.0, 0.0, 135.0, LOW),
    "bumper rear middle left": (0.0, 0.38, 180.0, LOW),
    "bumper rear": (0.0, 0.0, 180.0, LOW),
    "tailgate": (0.0, 0.0, 180.0, HIGH),
}
"""Where the ray passes across its way, in shares of half length and width; its yaw; its height."""
ROOF_SHARE = 0.85
LEVEL = 0.8
"""The roof: faces higher than this share of the height whose unit normal is so far upright."""
NEAR_M = 0.1
"""The body's outline at a height is that of triangles nearer to it than this."""
MIRRORS = ("mirror",)
TIP_M = 0.02
"""Words of parts; points this near to the outermost one are the tip of a mirror."""
CABIN = (0.45, 0.9)
"""Where mirrors are without such parts: in the front half, between shares of the height."""
WAYS = {"left": 1.0, "right": -1.0}


@dataclass(frozen=True, slots=True)
class NamedPlace:
    """A place of a vehicle's surface, ground frame.

    `point, outward` (3,): The point [m], and the unit direction out of the body there.
    `yaw_deg`: Where a sensor there looks; positive is left.
    """

    point: tuple[float, float, float]
    outward: tuple[float, float, float]
    yaw_deg: float

    def beside(self, distance: float) -> tuple[float, float, float]:
        """Return the position (3,) at a distance outside the surface [m], to a millimetre."""
        x, y, z = (p + distance * o for p, o in zip(self.point, self.outward, strict=True))
        return round(x, 3), round(y, 3), round(z, 3)


def named_places(vehicle: Vehicle) -> Mapping[str, NamedPlace]:
    """Return the places by name: ``"roof"``, ``"mirror left"``, ``"bumper rear right"``.

    A floor in the vehicle's mesh does not count. Where a ray meets no body, in an open mesh, the
    place is on the body's box.
    """
    shape = BodyShape(vehicle.triangles, vehicle.parts, tuple(vehicle.part_names))
    ours = slice(None) if shape.is_ours is None else shape.is_ours
    body = Vehicle(vehicle.triangles[ours], vehicle.parts[ours], vehicle.part_names)
    roof = _roof(body)
    places = {name: _on_roof(body, roof, *row) for name, row in _both(ROOF).items()}
    places |= {name: _on_side(body, *row) for name, row in _both(SIDES).items()}
    return places | {f"mirror {name}": _mirror(body, way) for name, way in WAYS.items()}


def _both(rows: Mapping[str, tuple]) -> dict[str, tuple]:
    """Return rows with those of the right after those of the left."""
    both = {}
    for name, (x, y, yaw, *rest) in rows.items():
        both[name] = (x, y, yaw, *rest)
        if "left" in name:
            both[name.replace("left", "right")] = (x, 0.0 - y, yaw and 0.0 - yaw, *rest)
    return both


def _roof(body: Vehicle) -> Floats:
    """Return the lowest and the highest corner (2, 3) of the roof [m]."""
    triangles = body.triangles
    low, high = body.bounds
    normals = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    is_level = np.abs(normals[:, 2]) > LEVEL * np.sqrt(dot(normals, normals))
    share = (triangles[:, :, 2].min(axis=1) - low[2]) / max(high[2] - low[2], 1e-9)
    faces = triangles[is_level & (share > ROOF_SHARE)].reshape(-1, 3)
    corners = faces if len(faces) else body.triangles.reshape(-1, 3)
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def _on_roof(body: Vehicle, roof: Floats, x: float, y: float, yaw_deg: float) -> NamedPlace:
    aim = roof.mean(axis=0) + np.array([x, y, 1.0]) * (roof[1] - roof[0]) / 2.0
    return _met(body, aim, np.array([0.0, 0.0, 1.0]), yaw_deg)


def _on_side(
    body: Vehicle, x: float, y: float, yaw_deg: float, height: tuple[float, float, float]
) -> NamedPlace:
    share, least, most = height
    bottom, top = (float(b[2]) for b in body.bounds)
    z = bottom + min(max(share * (top - bottom), least), most)
    low, high = body.triangle_bounds
    at_level = (low[2] < z + NEAR_M) & (high[2] > z - NEAR_M)
    ends = (low[:, at_level].min(axis=1), high[:, at_level].max(axis=1))
    low, high = ends if at_level.any() else body.bounds
    yaw = math.radians(yaw_deg)
    out = np.round([math.cos(yaw), math.sin(yaw), 0.0], 12) + 0.0
    # Along its way out the ray passes the outline's box at its side, or at a corner.
    aim = (low + high) / 2.0 + np.where(out, np.sign(out), (x, y, 0.0)) * (high - low) / 2.0
    return _met(body, np.array([aim[0], aim[1], z]), out, yaw_deg)


def _met(body: Vehicle, aim: Floats, out: Floats, yaw_deg: float) -> NamedPlace:
    """Return the place where a ray that comes in through a point meets the body."""
    reach = float(max(body.bounds[1] - body.bounds[0]))
    depth = float(body.first_hit_from(aim + reach * out, -out[None]).distance[0]) - reach
    return _place(aim - out * (depth if math.isfinite(depth) else 0.0), out, yaw_deg)


def _mirror(body: Vehicle, way: float) -> NamedPlace:
    low, high = body.bounds
    corners = body.triangles.reshape(-1, 3)
    named = [k for k, name in enumerate(body.part_names) if is_called(name, MIRRORS, ())]
    is_there = np.repeat(np.isin(body.parts, named), 3)
    if not is_there.any():
        share = (corners[:, 2] - low[2]) / max(high[2] - low[2], 1e-9)
        is_there = (share > CABIN[0]) & (share < CABIN[1]) & (corners[:, 0] * 2 > low[0] + high[0])
    points = corners[is_there] if is_there.any() else corners
    aside = points[:, 1] * way
    tip = points[aside > aside.max() - TIP_M]
    ahead = tip[:, 0].max()
    height = (tip[:, 2].min() + tip[:, 2].max()) / 2.0
    out = np.array([0.0, way, 0.0])
    return _place(np.array([ahead, way * aside.max(), height]), out, 90.0 * way)


def _place(point: Floats, out: Floats, yaw_deg: float) -> NamedPlace:
    x, y, z = (np.round(point, 3) + 0.0).tolist()
    a, b, c = out.tolist()
    return NamedPlace((x, y, z), (a, b, c), yaw_deg)


PLACE_NAMES = (*_both(ROOF), *_both(SIDES), *(f"mirror {name}" for name in WAYS))
"""Of all places, in their order."""
