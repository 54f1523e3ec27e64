"""The steepest way of a sensor: in which direction it would gain most, and the best place near by.

All values are entropies on the same voxels, so their differences have the small errors of paired
scores (`Scatter`). Slopes are central differences: a step forth and a step back. A gain that is
less than `CALM` of its standard errors is not told: it would jump about while a sensor is dragged.
"""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import dist, radians
from typing import Any, TypeAlias, TypeVar

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.values import error_text, rounded
from pe_core.geometry.poses import Pose
from pe_core.scene.rig import Rig
from pe_core.scoring.sampling import SEARCHED
from pe_core.scoring.score import ALIKE, RigEvaluator, Score, paired_error, standard_error
from pe_core.search import (
    PAPER_FREE,
    POSITION_AXES,
    MountSurface,
    OwnPlaces,
    SlotMount,
    SurfaceMount,
)
from pe_core.study.study import Study

from .free_region import EDGE

STEP_M = 0.05
TURN_DEG = 1.0
"""How far a sensor is moved and turned, forth and back."""
WITHIN_M = 0.2
RINGS_M = (0.1, WITHIN_M)
"""How far a better place is looked for, and at which distances."""
BOUNDS = "its bounds"
SCREENED = 16_384
"""Voxels that choose the best place; those of a study judge it."""
CALM = 3.0
"""A gain is told from so many of its standard errors on."""
CAME_SHARE = 0.5
"""A step that comes less far than this share of it has met the edge of the mount."""
T = TypeVar("T")
Steps: TypeAlias = Generator[None, None, T]
"""Pauses after each score, and returns a result."""
ENTROPY = ("rig", "", "entropy")
TURN_WORDS = {"yaw": ("left", "right"), "pitch": ("nose down", "nose up")}
"""The positive and the negative sense of a turn."""
WAY_WORDS = (("forward", "back"), ("left", "right"), ("up", "down"))
NAMED_SHARE = 0.4
"""A direction is named by all axes of which it has at least this share."""


@dataclass(frozen=True, slots=True)
class Slope:
    """How the entropy changes along a way: by `change` [nats] for each 5 cm or each degree, with
    the standard error `error`. `blocked`: what forbids a step; empty where nothing does."""

    name: str
    change: float
    error: float
    blocked: str = ""

    @property
    def is_clear(self) -> bool:
        """Whether it is a gain beyond `CALM` of its errors, and a step is allowed."""
        return not self.blocked and -self.change > max(CALM * self.error, ALIKE)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {
            "way": self.name,
            "change": rounded(self.change),
            "standard_error": rounded(self.error),
            "forbidden_by": self.blocked or None,
        }


@dataclass(frozen=True, slots=True)
class BetterPlace:
    """The best place near a sensor: its pose, how far away it is [m], and by how much the entropy
    changes [nats], with its standard error. `poses` are those of all sensors that move, by name:
    its own, and those that follow it."""

    poses: Mapping[str, Pose]
    pose: Pose
    distance: float
    change: float
    error: float

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {
            "position": list(self.pose.position),
            "rotation_deg": list(self.pose.rotation_deg),
            "distance_m": rounded(self.distance),
            "change": rounded(self.change),
            "standard_error": rounded(self.error),
        }


@dataclass(frozen=True, slots=True)
class SteepestWay:
    """In which direction a sensor gains most.

    `sensor, at`: Its name, and its position [m].
    `direction`: Unit direction (3,) in the ground frame; None where no gain is clear.
    `along`: The slope that way, of 5 cm; None along no surface.
    `turns`: Slopes of yaw and pitch, of 1 deg.
    `better`: The best place within 20 cm; None where none is better, or it was not looked for.
    `sample`: On what was evaluated, as text.
    """

    sensor: str
    at: tuple[float, float, float]
    direction: tuple[float, float, float] | None
    along: Slope | None
    turns: tuple[Slope, ...] = ()
    better: BetterPlace | None = None
    sample: str = ""

    @property
    def clear_turns(self) -> tuple[Slope, ...]:
        """The turns that gain something."""
        return tuple(turn for turn in self.turns if turn.is_clear)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {
            "sensor": self.sensor,
            "direction": None if self.direction is None else [*map(rounded, self.direction)],
            "along": None if self.along is None else self.along.to_dict(),
            "step_m": STEP_M,
            "turns": [turn.to_dict() for turn in self.turns],
            "turn_deg": TURN_DEG,
            "better_place": None if self.better is None else self.better.to_dict(),
            "within_m": WITHIN_M,
            "evaluated_on": self.sample,
        }


def places_of(
    study: Study,
    sensor: str,
    *,
    anywhere: bool = False,
    surfaces: dict[SurfaceMount, MountSurface] | None = None,
) -> OwnPlaces:
    """Return where a sensor of a study may go: on its mount, else along those of x, y, z that are
    free; where all three are, over the body. `anywhere` and `surfaces` are those of `OwnPlaces`,
    which says what raises `InputError`."""
    search = study.search
    free = search.free.get(sensor, PAPER_FREE)
    axes = tuple(axis for axis in POSITION_AXES if axis in free)
    is_over_body = study.vehicle is not None and axes == POSITION_AXES
    return OwnPlaces(
        study.rig,
        sensor,
        study.vehicle,
        search.mounting,
        limits=study.limits,
        bounds=search.limits.get(sensor),
        axes=None if is_over_body else axes,
        anywhere=anywhere,
        surfaces=surfaces,
    )


def screen_of(study: Study, workers: int | None = None) -> RigEvaluator:
    """Return what chooses the best place of a study, on voxels that do not judge it."""
    return study.evaluator(SCREENED, workers=workers, shift=SEARCHED)


def steepest_way(
    places: OwnPlaces,
    evaluator: RigEvaluator,
    *,
    with_turns: bool = True,
    screen: RigEvaluator | None = None,
) -> SteepestWay:
    """Return in which direction a sensor gains most.

    Parameters
    ----------
    places : OwnPlaces
        Where the sensor may go: on its mount, over the body, or along axes.
    evaluator : RigEvaluator
        All differences are on its voxels.
    with_turns : bool
        Whether yaw and pitch are looked at, too.
    screen : RigEvaluator, optional
        Chooses the best place within 20 cm, on other and perhaps fewer voxels: a place that was
        lucky on its own sample would look too good. Without it no place is looked for.
    """
    steps = steepest_steps(places, evaluator, with_turns=with_turns, screen=screen)
    while True:
        try:
            next(steps)
        except StopIteration as end:
            found: SteepestWay = end.value
            return found


def steepest_steps(
    places: OwnPlaces,
    evaluator: RigEvaluator,
    *,
    with_turns: bool = True,
    screen: RigEvaluator | None = None,
) -> Steps[SteepestWay]:
    """Yield after each score, and return what `steepest_way` does: who looks on can give up."""
    voxels = f"{evaluator.samples:,} voxels" if evaluator.samples else "all voxels"
    sensor = places.rig[places.name]
    directions = places.tangents()
    slopes: list[Floats] = []
    for tangent in directions:
        slope = yield from _slope_along(places, evaluator, tangent)
        slopes.append(slope)
    direction, along = _steepest(places, directions, slopes)
    turns = list[Slope]()
    for axis in TURN_WORDS if with_turns and not isinstance(places.mount, SlotMount) else ():
        turn = yield from _slope_of_turn(places, evaluator, axis)
        turns.append(turn)
    better = None
    if screen is not None and len(directions):
        better = yield from _better_place(places, directions, evaluator, screen)
    return SteepestWay(
        sensor=places.name,
        at=sensor.pose.position,
        direction=direction,
        along=along,
        turns=tuple(turns),
        better=better,
        sample=voxels,
    )


def _difference(one: Score, other: Score) -> Floats:
    """Return a difference of two entropies and its residuals by batch, as one row (1 + R,): sums of
    such rows are differences, too."""
    scatters = (one.scatter, other.scatter)
    own, its = (np.array(s.residuals[ENTROPY]) if s else np.zeros(1) for s in scatters)
    return np.concatenate([[one.entropy - other.entropy], own - its])


def _slope_along(places: OwnPlaces, evaluator: RigEvaluator, direction: Floats) -> Steps[Floats]:
    """Return the slope (1 + R,) along a direction (3,), of 5 cm; 0 where the mount ends."""
    forth = places.moved(STEP_M * direction)
    back = places.moved(-STEP_M * direction)
    apart = _along(places, forth, direction) - _along(places, back, direction)
    ahead = evaluator.summary(forth)
    yield
    behind = evaluator.summary(back)
    yield
    if apart < 2.0 * CAME_SHARE * STEP_M:
        return np.zeros_like(_difference(ahead, behind))
    return _difference(ahead, behind) * (STEP_M / apart)


def _slope_of_turn(places: OwnPlaces, evaluator: RigEvaluator, axis: str) -> Steps[Slope]:
    """Return the slope of a turn about an axis, of 1 deg, in its better sense."""
    both = [places.turned(axis, sign * radians(TURN_DEG)) for sign in (1.0, -1.0)]
    scores = []
    for rig in both:
        scores.append(evaluator.summary(rig))
        yield
    row = _difference(scores[0], scores[1]) / 2.0
    sense = int(row[0] > 0.0)
    name = f"{axis} {TURN_WORDS[axis][sense]}"
    error = standard_error(row[1:].tolist())
    return Slope(name, -abs(float(row[0])), error, places.reason(both[sense]))


def _steepest(
    places: OwnPlaces, directions: Floats, slopes: Sequence[Floats]
) -> tuple[tuple[float, float, float] | None, Slope | None]:
    """Return the direction of the steepest fall and its slope; where it is blocked, the steepest of
    those along one direction alone that is clear. Without a clear one there is no direction."""
    if not slopes:
        return None, None
    rows = np.array(slopes)
    size = float(np.sqrt((rows[:, 0] ** 2).sum()))
    share = -rows[:, 0] / size if size > 0.0 else np.zeros(len(rows))
    ways = [share, *(sign * each for each in np.eye(len(rows)) for sign in (1.0, -1.0))]
    found = [_way(places, way @ directions, way @ rows) for way in ways]
    steepest = found[0]
    ordered = [steepest, *sorted(found[1:], key=lambda each: each[1].change)]
    clear = next((each for each in ordered if each[1].is_clear), None)
    return clear if clear is not None else (None, steepest[1])


def _way(
    places: OwnPlaces, direction: Floats, row: Floats
) -> tuple[tuple[float, float, float], Slope]:
    """Return a direction, and its slope from its row (1 + R,)."""
    x, y, z = direction.tolist()
    change = float(row[0])
    error = standard_error(row[1:].tolist())
    blocked = ""
    if -change > max(CALM * error, ALIKE):
        blocked = _blocked(places, direction, STEP_M)[0]
    return (x, y, z), Slope(way_text(direction), change, error, blocked)


def _blocked(places: OwnPlaces, direction: Floats, length: float) -> tuple[str, Rig]:
    """Return what forbids a step in a direction (3,), and the rig after it."""
    rig = places.moved(length * direction)
    if _along(places, rig, direction) < CAME_SHARE * length:
        return BOUNDS if places.surface is None else EDGE, rig
    return places.reason(rig), rig


def _along(places: OwnPlaces, rig: Rig, direction: Floats) -> float:
    """Return how far the sensor has come along a direction (3,) [m]."""
    now = np.array(places.rig[places.name].pose.position)
    away = np.array(rig[places.name].pose.position) - now
    return float((away * direction).sum())


def _better_place(
    places: OwnPlaces, directions: Floats, evaluator: RigEvaluator, screen: RigEvaluator
) -> Steps[BetterPlace | None]:
    """Return the best place within 20 cm: chosen on the voxels of `screen`, judged on others."""
    rigs = []
    for length in RINGS_M:
        for shares in product((-1.0, 0.0, 1.0), repeat=len(directions)):
            way = np.array(shares) @ directions
            size = float(np.sqrt((way**2).sum()))
            if size > 0.0:
                blocked, rig = _blocked(places, way / size, length)
                rigs += [] if blocked else [rig]
    values = []
    for rig in [places.rig, *rigs]:
        values.append(screen.summary(rig).entropy)
        yield
    best = int(np.argmin(values))
    if best == 0:
        return None
    rig = rigs[best - 1]
    base = evaluator.summary(places.rig)
    yield
    score = evaluator.summary(rig)
    yield
    error = paired_error(score.scatter, base.scatter, ENTROPY) or 0.0
    pose = rig[places.name].pose
    found = BetterPlace(
        poses={own.name: own.pose for own in rig if own.pose != places.rig[own.name].pose},
        pose=pose,
        distance=dist(pose.position, places.rig[places.name].pose.position),
        change=score.entropy - base.entropy,
        error=error,
    )
    return found if -found.change > max(CALM * error, ALIKE) else None


def way_text(direction: Floats) -> str:
    """Return a direction (3,) of the ground frame in words: "forward and left"."""
    parts = sorted(zip(np.abs(direction).tolist(), direction.tolist(), WAY_WORDS, strict=True))
    named = [words[int(value < 0.0)] for size, value, words in parts[::-1] if size >= NAMED_SHARE]
    return " and ".join(named)


def steepest_lines(found: SteepestWay) -> list[str]:
    """Return the steepest way in lines: along the surface, turns, and the best place near by."""
    lines = []
    along = found.along
    if along is not None and found.direction is not None:
        lines.append(f"this way: {along.name}, {along.change:+.3f} nats per 5 cm {_error(along)}")
    elif along is not None:
        why = f": {along.name} is better, but forbidden by {along.blocked}" if along.blocked else ""
        lines.append(f"no direction with a clear gain{why} {_error(along)}")
    for turn in found.clear_turns:
        lines.append(f"turned: {turn.name}, {turn.change:+.3f} nats per degree {_error(turn)}")
    if (better := found.better) is not None:
        x, y, z = better.pose.position
        lines.append(
            f"best place within 20 cm: ({x:.3f}, {y:.3f}, {z:.3f}), "
            f"{better.distance * 100.0:.0f} cm away, {better.change:+.3f} nats {_error(better)}"
        )
    lines.append(f"on {found.sample}; gains below {CALM:g} standard errors are not told")
    return [f"{found.sensor}: {lines[0]}", *(f"  {line}" for line in lines[1:])]


def _error(found: Slope | BetterPlace) -> str:
    return f"(+- {error_text(found.error)})" if found.error else "(on all voxels)"
