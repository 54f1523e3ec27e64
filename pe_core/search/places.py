"""Places on a vehicle's surface for one more sensor: a cover of the surface, coarse to fine.

Points are drawn by area, then ordered farthest-point first (Gonzalez, 1985): every beginning of
the order covers the surface evenly. At each a sensor is upright and looks away from the vehicle's
middle, or is aligned as its mount says. A place where it would break a rule has the rule as reason.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats, Ints
from ..base.errors import InputError
from ..base.values import Whole
from ..geometry.poses import Pose, cross, dot
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..sensors.kind import kind_of
from .domains import MountSurface, pose_on, standoff_point
from .limit import FigureLimits
from .mounts import Constraints, Mounting, SurfaceMount
from .placement import Placement, housings_of
from .search_space import MIN_HEIGHT_M, SearchSpace, rules_of

PLACES = Whole(1, 20_000)
POOL = 6
"""How many places there may be, and points that are drawn for each."""
PLASTIC = 1.32471795724474602596
"""Of the R2 sequence, which fills a square evenly (Roberts, 2018)."""
NO_HEADING_M = 0.05
"""A place nearer to the vehicle's middle than this has no outward direction: it looks ahead."""
SPARE_DEG = 20.0
MAX_TILT_DEG = 45.0
"""A sensor that sees all around is tilted until what it looks at is so far within its field of
view, and by so much at most."""
LOW = f"lower than {MIN_HEIGHT_M:g} m"
IN_BODY = "the sensor would be in the body"


@dataclass(frozen=True, slots=True)
class SurfacePlace:
    """A point and unit normal of a surface [m], and the pose of the sensor there. `reason` is the
    first rule that it breaks as text, empty where it breaks none; `value` the figure of the rig
    with the sensor there, where it is known."""

    point: tuple[float, float, float]
    normal: tuple[float, float, float]
    pose: Pose
    reason: str
    value: float | None = None


def outward_yaw(x: float, y: float) -> float:
    """Return the yaw away from the vehicle's middle of a place at x, y from it [m], in whole
    degrees [rad]; straight ahead where there is no such direction."""
    if math.hypot(x, y) < NO_HEADING_M:
        return 0.0
    return math.radians(round(math.degrees(math.atan2(y, x))))


def surface_points(triangles: Floats, count: int) -> tuple[Floats, Ints]:
    """Return points (N, 3) on triangles (F, 3, 3) [m], and their faces (N,). The coarse cover is
    first; N is `count`. The same triangles give the same points."""
    first = triangles[:, 1] - triangles[:, 0]
    second = triangles[:, 2] - triangles[:, 0]
    normals = cross(first, second)
    area = np.cumsum(np.sqrt(dot(normals, normals)))
    number = np.arange(count * POOL)
    at = (number + 0.5) / len(number) * area[-1]
    face = np.minimum(np.searchsorted(area, at, side="right"), len(area) - 1)
    a = (0.5 + number / PLASTIC) % 1.0
    b = (0.5 + number / PLASTIC**2) % 1.0
    outside = a + b > 1.0  # the other half of the parallelogram
    a = np.where(outside, 1.0 - a, a)
    b = np.where(outside, 1.0 - b, b)
    pool = triangles[face, 0] + a[:, None] * first[face] + b[:, None] * second[face]
    order = [int(np.argmax(pool[:, 2]))]
    away = np.full(len(pool), np.inf)
    while len(order) < count:
        step = pool - pool[order[-1]]
        away = np.minimum(away, dot(step, step))
        order.append(int(np.argmax(away)))
    return pool[order], face[order]


class MountingPlaces:
    """Places for one more sensor of a rig; iterated, it yields them, the coarse cover first.

    `InputError` when there is no vehicle or no such part, or what a constraint needs is not known.

    `rig, sensor`: The other sensors, and the one to place, whose pose does not matter.
    `parts`: Parts of the vehicle that are covered; none: all of them.
    `mount`: The mount that is covered instead, with its stand-off and orientation. Without one the
        stand-off is that of the sensor's kind.
    `look_at`: A point [m] that the sensor looks at, instead of away from the vehicle's middle. One
        that sees all around stands upright where the point is in its field of view, else it is
        tilted towards the point, by as little as that takes.
    """

    def __init__(
        self,
        rig: Rig,
        sensor: Sensor,
        vehicle: Vehicle | None,
        constraints: Constraints,
        limits: FigureLimits,
        *,
        parts: Sequence[str] = (),
        mount: SurfaceMount | None = None,
        count: int = 2000,
        look_at: tuple[float, float, float] | None = None,
    ) -> None:
        if vehicle is None:
            raise InputError("where", "vehicle", "a vehicle with a surface", "none")
        kind = kind_of(sensor)
        self._rig = rig
        self._sensor = sensor
        self._vehicle = vehicle
        self._housings = housings_of([*rig, sensor])
        own_parts = parts or vehicle.part_names
        anywhere = SurfaceMount(own_parts, kind.stand_off_m, max_slope=math.pi)
        self._mount = mount or anywhere
        self.surface = MountSurface("where", self._mount, vehicle)
        self._base = standoff_point(self._mount, self._housings.get(sensor.name) if mount else None)
        self._turned = kind.outward(sensor.model) and self._mount.orientation != "facing"
        self._tilted = not kind.outward(sensor.model) and self._mount.orientation == "upright"
        self._lowest_ray = kind.lowest_ray(sensor.model)
        self._middle = (vehicle.bounds[0] + vehicle.bounds[1]) / 2.0
        self._look_at = look_at
        moving = {sensor.name}
        space = SearchSpace(
            mounting=Mounting(constraints=constraints),
            vehicle=vehicle,
            housings=self._housings,
            figure_limits=limits,
        )
        self._rules = rules_of(self.with_sensor(sensor.pose), space, moving, moving, domains={})
        count = PLACES.checked("where", "places", count)
        faces = self.surface.faces
        self._points, chosen = surface_points(self.surface.triangles[faces], count)
        self._faces = faces[chosen]

    def __iter__(self) -> Iterator[SurfacePlace]:
        for point, face in zip(self._points, self._faces.tolist(), strict=True):
            if not self.surface.carries(face):
                continue
            normal = self.surface.outward(face)
            x, y, z = point.tolist()
            pitch, yaw = self._angles(x, y, z)
            pose = pose_on(self._mount, point, normal, (0.0, pitch, yaw), point=self._base)
            yield SurfacePlace((x, y, z), tuple(normal.tolist()), pose, self._reason(pose))

    def _angles(self, x: float, y: float, z: float) -> tuple[float, float]:
        """Return pitch and yaw of a sensor at a place [m], in whole degrees [rad]."""
        if self._look_at is None or not (self._turned or self._tilted):
            outward = outward_yaw(x - self._middle[0], y - self._middle[1])
            return 0.0, outward if self._turned else 0.0
        ahead = self._look_at[0] - x
        left = self._look_at[1] - y
        down = math.degrees(math.atan2(z - self._look_at[2], math.hypot(ahead, left)))
        if self._turned:
            return math.radians(round(down)), outward_yaw(ahead, left)
        unseen = down - math.degrees(self._lowest_ray)
        if unseen <= 0.0:
            return 0.0, 0.0
        tilt = min(unseen + SPARE_DEG, MAX_TILT_DEG)
        return math.radians(math.ceil(tilt)), outward_yaw(ahead, left)

    def with_sensor(self, pose: Pose) -> Rig:
        """Return the rig with the sensor at a pose."""
        return Rig([*self._rig, self._sensor.moved(pose)])

    def _reason(self, pose: Pose) -> str:
        if pose.position[2] < MIN_HEIGHT_M:
            return LOW
        trial = Placement(self.with_sensor(pose), self._vehicle, self._housings)
        broken = next((rule.text for rule in self._rules if rule.broken(trial)), "")
        for own in (f" for {self._sensor.name!r}", f" of {self._sensor.name!r}"):
            broken = broken.removesuffix(own)
        return IN_BODY if broken == "the body" else broken
