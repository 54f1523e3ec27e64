"""Requirements: a zone, test bodies, a criterion, and what the criterion has to survive.

`sees` and `body_met` are the plain definitions: what one sensor sees of one body, and whether what
the sensors see meets a criterion. The kernels of `checker` are held to them by tests.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError, shown
from ...base.setting import FLAG, check_settings, setting
from ...base.values import A_NAME, A_TEXT, SHARE, Number, Whole
from ...scene.objects import Objects
from ...scene.rig import Rig, Sensor
from ...scene.vehicle import Vehicle
from ...sensors import kind_named, kind_of
from ...sensors.object_kernel import PlacedBoxes
from .bodies import DIAGONALS, Body, cell_plan, post_bands
from .zones import Zone

Floats = NDArray[np.float64]
COUNT = Whole(1, 1000)
POSITIVE_SHARE = Number(0.0, 1.0, above=True)
AREA = Number(0.0, 1e6, unit="m2", noun="area")
NEAREST_M = 1e-3
NARROWEST_PX = 1e-9
DISTANCE = Number(0.0, 100.0, unit="m", noun="length")


@dataclass(frozen=True)
class Criterion:
    """What has to be seen of a body at a sample of the zone.

    A sensor sees a body if it has at least `points` on it (kinds that count points) or `pixels` of
    it (other kinds), and at least the `share` of it is visible.

    Parameters
    ----------
    sensors, kinds : int
        At least so many sensors, of at least so many kinds, see the body.
    of : sequence of str
        Only these kinds of sensors count; all by default.
    points, pixels : float
        At least so many beams end on the body, or so many pixels show it.
    pixels_high : float, optional
        The image of the body is at least so many pixels high, where a sensor counts pixels: m over
        the width of the box's image, which errs low.
    per_degree : float, optional
        At least so many beams or pixels on a degree, on average over the body's box: the square
        root of m over its solid angle, which errs high.
    share : float, optional
        At least this share of the body is visible, of its height (bands of 0.1 m) and its width.
    ap : float, optional
        The AP of the body's class, all sensors fused, is at least this.
    zone_share : float
        For at least this share of the zone's samples.
    blind_m2 : float, optional
        At most so much of the zone's ground is blind.
    blind_out : float, optional
        Blind ground in the zone is at most this far from the body's rectangle [m].
    blind_height : float
        Of what is this tall [m].

    Raises
    ------
    InputError
        When a value is none.
    """

    sensors: int = setting(1, COUNT, "At least so many sensors see the body")
    kinds: int = setting(1, COUNT, "These sensors are of at least so many kinds")
    of: tuple[str, ...] = ()
    points: int = setting(1, COUNT, "A LiDAR sees a body with at least so many points on it")
    pixels: float = setting(
        1.0,
        Number(1e-6, 1e9, unit="px"),
        "A camera sees a body with at least so many pixels of it",
    )
    pixels_high: float | None = setting(
        None,
        Number(0.0, 1e6, above=True, unit="px"),
        "A camera sees a body with at least so many pixels in height",
    )
    per_degree: float | None = setting(
        None,
        Number(0.0, 1e4, above=True),
        "A sensor sees a body with at least so many beams or pixels on a degree",
    )
    share: float | None = setting(
        None, POSITIVE_SHARE, "At least this share of the body is visible"
    )
    ap: float | None = setting(
        None, SHARE, "AP of the body's class is at least this, all sensors fused"
    )
    zone_share: float = setting(
        1.0, POSITIVE_SHARE, "For at least this share of the zone's samples"
    )
    blind_m2: float | None = setting(
        None, AREA, "At most so many square metres of the zone's ground are blind"
    )
    blind_out: float | None = setting(
        None, DISTANCE, "Blind ground in the zone is at most this far from the vehicle"
    )
    blind_height: float = setting(0.0, DISTANCE, "Blind ground is that of what is so tall")

    def __post_init__(self) -> None:
        check_settings(self, "criterion")
        for kind in self.of:
            kind_named(kind, "criterion", "of")
        object.__setattr__(self, "of", tuple(self.of))
        if self.kinds > self.sensors:
            object.__setattr__(self, "sensors", self.kinds)

    @property
    def is_of_ground(self) -> bool:
        """Whether the criterion is on blind ground, not on test bodies."""
        return self.blind_m2 is not None or self.blind_out is not None

    def check_rig(self, rig: Rig, who: str) -> None:
        """Raise `InputError` where the rig has not the kinds that are asked for."""
        kinds = {sensor.kind for sensor in rig}
        for kind in self.of:
            if kind not in kinds:
                found = f"{kind}, of which the rig has no sensor"
                raise InputError(who, "criterion.of", f"some of {', '.join(sorted(kinds))}", found)
        eligible = kinds & set(self.of) if self.of else kinds
        count = len(eligible)
        counted = [kind_named(kind, who, "criterion.of").counts_points for kind in eligible]
        if self.pixels_high is not None and all(counted):
            found = f"{', '.join(sorted(eligible))} alone"
            raise InputError(who, "criterion.pixels_high", "a kind that counts pixels", found)
        if self.kinds > count:
            expected = f"at most {count}, the number of kinds of the rig"
            raise InputError(who, "criterion.kinds", expected, self.kinds)


@dataclass(frozen=True)
class Under:
    """What a requirement has to be met under, besides the rig as it stands.

    Parameters
    ----------
    one_lost : bool
        Also with any one sensor lost.
    mounting : bool
        Also with the mounting errors of the search's tolerance.
    """

    one_lost: bool = setting(False, FLAG, "Also with any one sensor lost")
    mounting: bool = setting(False, FLAG, "Also with the mounting errors of the tolerance")

    def __post_init__(self) -> None:
        check_settings(self, "under")


@dataclass(frozen=True)
class Requirement:
    """A requirement: bodies at all samples of a zone meet a criterion.

    Parameters
    ----------
    name : str
        Unique in a study.
    zone : Zone
    bodies : sequence of Body
        Each of them has to meet the criterion, one at a time.
    criterion : Criterion
    under : Under
    preset : str, optional
        Identifier of the preset that it was made from.
    source : str
        Where its figures are from.
    check : str
        What it is called in a verdict: "R159 Annex 3".

    Raises
    ------
    InputError
        When a value is none, there is no body, or a body has no class whose AP is asked for.
    """

    name: str
    zone: Zone
    bodies: tuple[Body, ...] = ()
    criterion: Criterion = field(default_factory=Criterion)
    under: Under = field(default_factory=Under)
    preset: str | None = None
    source: str = ""
    check: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "name", A_NAME.checked("requirement", "name", self.name))
        who = f"requirement {self.name!r}"
        put(self, "bodies", tuple(self.bodies))
        for key, kind in (("zone", Zone), ("criterion", Criterion), ("under", Under)):
            if not isinstance(getattr(self, key), kind):
                found = type(getattr(self, key)).__name__
                raise InputError(who, key, f"a {kind.__name__}", found)
        for key in ("source", "check"):
            if getattr(self, key):
                A_TEXT.checked(who, key, getattr(self, key))
        if not self.bodies and not self.criterion.is_of_ground:
            raise InputError(who, "body", "a test body", "none")
        for body in self.bodies:
            self._check_body(body, who)

    def _check_body(self, body: Body, who: str) -> None:
        if self.criterion.ap is not None and body.class_name is None:
            raise InputError(who, "criterion.ap", f"a class of {body.name!r}", "none")
        zone = self.zone
        if zone.ring is not None and zone.ring[1] - zone.ring[0] < min(body.size[:2]) / 2.0:
            found = f"{body.name}, {min(body.size[:2]):g} m wide, in a ring of {zone.ring} m"
            raise InputError(who, "body", "a body that is not larger than the zone", found)


def checked_requirements(requirements: Sequence[Requirement]) -> tuple[Requirement, ...]:
    """Return requirements; raise `InputError` for two of one name, or what is none."""
    names: set[str] = set()
    for each in requirements:
        if not isinstance(each, Requirement):
            raise InputError("study", "requirements", "requirements", shown(each))
        if each.name in names:
            raise InputError("study", "requirement", "each name once", f"{each.name!r} twice")
        names.add(each.name)
    return tuple(requirements)


def sees(
    sensor: Sensor,
    body: Body,
    foot: Sequence[float],
    heading: float,
    vehicle: Vehicle | None,
    criterion: Criterion,
) -> bool:
    """Whether a sensor sees a body that stands alone at a place: the definition.

    m of the body's box, by the definition of the sensor's kind, reaches the threshold; with a
    share, so much of the body is visible: `visible_share` of the cells that have an m above 0. What
    is beside a cell that is not seen does not count: it may be seen in part.
    """
    measure = kind_of(sensor).measure_objects
    objects = placed(body, [foot], [heading], False)
    m = measure(sensor, objects, vehicle, False)
    if not has_enough(sensor, objects, m, criterion)[0]:
        return False
    if criterion.share is None:
        return True
    cells = measure(sensor, placed(body, [foot], [heading], True), vehicle, False) > 0.0
    return bool(visible_share(body, cells[None])[0] >= criterion.share)


def has_enough(
    sensor: Sensor, objects: Objects, m: Floats, criterion: Criterion
) -> NDArray[np.bool_]:
    """Whether m (N,) of boxes, points or pixels, is enough, for their image and solid angle too.

    An image of m pixels has at least m / w rows, if no row has more than w pixels.
    """
    counts = kind_of(sensor).counts_points
    enough = m >= (criterion.points if counts else criterion.pixels)
    if criterion.pixels_high is not None and not counts:
        widths = kind_of(sensor).image_widths(sensor, objects)
        enough &= m >= criterion.pixels_high * np.maximum(widths, NARROWEST_PX)
    if criterion.per_degree is not None:
        enough &= m >= criterion.per_degree**2 * largest_solid_angle(objects, sensor.pose.position)
    return np.asarray(enough)


def largest_solid_angle(objects: Objects, position: Sequence[float]) -> Floats:
    """Return an upper bound (N,) of the solid angle of boxes from a position [deg2].

    The solid angle of a face is the integral of h / r^3 over its area, with the distance h from its
    plane: at most area times h over the cube of the distance to its nearest point. The position is
    outside of the boxes.
    """
    boxes = PlacedBoxes.of(objects, position)
    low, high = boxes.offsets - boxes.halves, boxes.offsets + boxes.halves
    gap = np.maximum(np.maximum(low, -high), 0.0)  # to the nearest point of the box, by axis
    total = np.zeros(len(gap))
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        height = gap[:, axis]
        area = 4.0 * boxes.halves[:, others[0]] * boxes.halves[:, others[1]]
        nearest = np.sqrt(height**2 + gap[:, others[0]] ** 2 + gap[:, others[1]] ** 2)
        total += area * height / np.maximum(nearest, NEAREST_M) ** 3
    return np.minimum(total, 4.0 * math.pi) * (180.0 / math.pi) ** 2


def visible_share(body: Body, cells: NDArray[np.bool_]) -> Floats:
    """Return the share (N,) of a body that is visible, erring low, from its cells (N, K).

    The cells of a body are bands of columns, and posts beside them (`cell_plan`); a post between
    two that are measured is seen if both are. A column in a band counts if it and its four diagonal
    neighbours are seen, in the bands above and below as well.
    """
    if body.is_ring:
        return cells.mean(axis=1)
    plan = cell_plan(body.bands, *body.columns)
    measured = np.zeros((len(cells), *plan.shape), bool)
    measured[:, plan] = cells
    levels, every = np.array(post_bands(body.bands)), np.arange(body.bands)
    below = levels[np.searchsorted(levels, every, "right") - 1]
    above = levels[np.searchsorted(levels, every)]
    seen = measured[:, below] & measured[:, above]
    seen[:, :, 1:-1, 1:-1] = measured[:, :, 1:-1, 1:-1]
    whole = seen[:, :, 1:-1, 1:-1].copy()
    for rows, columns in DIAGONALS:
        whole &= seen[:, :, rows, columns]
    sure = whole.copy()
    sure[:, 1:] &= whole[:, :-1]
    sure[:, :-1] &= whole[:, 1:]
    return sure.mean(axis=(1, 2, 3))


def body_met(seen: Mapping[str, bool], rig: Rig, criterion: Criterion) -> bool:
    """Whether sensors that see a body, by name, are enough: the definition."""
    eligible = [s for s in rig if seen.get(s.name) and (not criterion.of or s.kind in criterion.of)]
    kinds = {sensor.kind for sensor in eligible}
    return len(eligible) >= criterion.sensors and len(kinds) >= criterion.kinds


def placed(
    body: Body, feet: Sequence[Sequence[float]] | Floats, headings: Sequence[float], cells: bool
) -> Objects:
    """Return a body's boxes at all feet (N, 3) and headings, as objects that each stand alone.

    Foot after foot, heading after heading, cell after cell.
    """
    centers, sizes = body.boxes(cells)
    at = np.asarray(feet, dtype=float).reshape(-1, 1, 1, 3)
    turns = [(math.cos(h), math.sin(h)) for h in headings]
    x, y, z = centers.T
    rotated = np.stack([np.stack([c * x - s * y, s * x + c * y, z], axis=1) for c, s in turns])
    everywhere = (at + rotated[None]).reshape(-1, 3)
    count, per = len(at), len(centers)
    return Objects(
        np.round(everywhere, 9),
        np.tile(sizes, (count * len(headings), 1)),
        np.tile(np.repeat(np.asarray(headings, dtype=float), per), count),
        np.zeros(len(everywhere), np.int64),
        (body.class_name or body.name,),
    )
