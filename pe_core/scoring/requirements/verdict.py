"""Verdicts: whether a requirement is met, by which margin, where it is worst, and what hides it.

Margins say how far a zone could grow before a requirement fails, or would have to shrink. They err
to the safe side: a step is taken off, and they are rounded down to the centimetre.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats, Ints
from ...base.notebook import ShortRepr
from ...base.setting import Part
from ...scene.rig import Rig, Sensor
from ...scene.vehicle import Vehicle
from ...sensors import kind_of
from ..sight.ground_cells import GroundCells
from .bodies import Body
from .criteria import Criterion, Requirement, levels_of
from .zones import INSIDE_M, PlacedZone

DECIMALS = 2  # Margins are rounded to the centimetre, to the safe side
FARTHEST_M = 10.0  # Zones are grown no farther than this
OCCLUDED = "occluded"
TOO_FEW = "too few"
IN_PART = "in part"
NO_COUNT = "not counted"
"""Codes of reasons, beside those of `Kind.missed`. In part: a share has to be visible, and less may
be. Not counted: the criterion leaves out sensors of this kind."""
CUBE_M = 0.1  # Side of the cubes by which it is told why a sensor does not see a body
LINES = ("path", "spots")
"""Kinds of zones without an inside: one that fails does not shrink."""


def growth(zone: PlacedZone) -> Iterator[float]:
    """Yield how far a zone is grown, time after time [m]: each twice as far as the one before."""
    grown = zone.grow
    while grown < FARTHEST_M:
        grown = min(2.0 * grown, FARTHEST_M)
        yield grown


def margin_of(
    distance: Floats, passed: Flags, wanted: float, step: float, looked: float
) -> tuple[float, bool]:
    """Return how far a zone could grow [m] before it fails, and whether it could grow farther.

    A zone that is grown by d has all samples with a distance of at most d. Negative: how far a zone
    that fails would have to shrink. Between two samples nothing is known, so a step is taken off,
    and figures are rounded down.

    The `distance` (N,) of samples to the zone is negative inside [m]; a share of `wanted` of them
    has to be `passed` (N,). Samples are a `step` apart, and reach as far as was `looked` [m].
    """
    order = np.argsort(distance, kind="stable")
    away = distance[order]
    ok = passed[order]
    share = np.cumsum(ok) / np.arange(1, len(ok) + 1)
    last = np.append(away[1:] - away[:-1] > INSIDE_M, True)  # the last sample at its distance
    away = away[last]
    share = share[last]
    fails = share < wanted
    grown = away > INSIDE_M
    inner = away[~grown]
    if len(inner) and not fails[~grown][-1]:
        first = np.flatnonzero(fails & grown)
        if not len(first):
            return rounded_down(looked), True
        return max(0.0, rounded_down(float(away[first[0]]) - step)), False
    met = np.flatnonzero(~fails & ~grown)
    inward = float(away[met[-1]]) if len(met) else float(inner[0]) - step
    return min(rounded_down(inward), -rounded_down(step)), False


def rounded_down(value: float) -> float:
    """Round down to the centimetre."""
    return math.floor(value * 10**DECIMALS + 1e-6) / 10**DECIMALS


class Reason(NamedTuple):
    """Why a sensor does not see a body: a code, and the part of the vehicle that occludes it."""

    code: str
    part: str = ""


def worst_sample(points: Floats, distance: Floats, counts: Ints, among: Flags) -> int:
    """Return the sample that the fewest sensors see; of equal ones that deepest in the zone."""
    some = np.flatnonzero(among)
    fewest = counts[some].min(axis=1)
    x, y = points[some].T
    order = np.lexsort((y, x, distance[some], fewest))
    return int(some[order[0]])


def columns_of(requirement: Requirement) -> list[Body]:
    """Return the body of each column of what sensors see, the heights of the zone too."""
    levels = levels_of(requirement)
    return [body for body in requirement.bodies for _ in range(levels) for _ in body.headings]


def why_not(sensor: Sensor, body: Body, foot: tuple[float, ...], vehicle: Vehicle | None) -> Reason:
    """Return why a sensor does not see a body. Cubes along the middle of the body, from its foot to
    its top, are asked for: the part that most of the rays end on to cubes that the sensor would see
    without the vehicle."""
    kind = kind_of(sensor)
    x, y, z = foot
    count = max(1, math.ceil(body.size[2] / CUBE_M - 1e-9))
    heights = np.linspace(CUBE_M / 2.0, max(body.size[2] - CUBE_M / 2.0, CUBE_M / 2.0), count)
    centers = np.column_stack([np.full(count, x), np.full(count, y), z + body.low + heights])
    in_view = kind.measure(sensor, centers, CUBE_M, None) > 0.0
    if not in_view.any():
        return Reason(kind.missed(sensor, centers[count // 2], CUBE_M))
    rays = [kind.rays_to(sensor, center, CUBE_M) for center in centers[in_view]]
    directions, lengths = (np.concatenate([ray[k] for ray in rays]) for k in (0, 1))
    part = None if vehicle is None else part_in_the_way(sensor, vehicle, directions, lengths)
    return Reason(TOO_FEW) if part is None else Reason(OCCLUDED, part)


def part_in_the_way(
    sensor: Sensor, vehicle: Vehicle, directions: Floats, lengths: Floats
) -> str | None:
    """Return the part that most of a sensor's rays (N, 3) of `lengths` (N,) [m] end on, or None."""
    if not len(directions):
        return None
    glass = sensor.model.sees_through_glass
    hits = vehicle.first_hit(sensor.pose.position, directions, glass)
    parts = np.asarray(vehicle.parts)[hits.face[hits.distance < lengths]]
    return str(vehicle.part_names[int(np.bincount(parts).argmax())]) if len(parts) else None


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of a zone: `points` (N, 2) [m], `distance` (N,) to the zone, negative inside [m].
    `mask` (NX, NY) are the squares of a zone whose blind ground is asked for."""

    zone: PlacedZone
    points: Floats
    distance: Floats
    mask: Flags | None = None

    @cached_property
    def inside(self) -> Flags:
        """Whether each sample (N,) is in the zone."""
        return self.distance <= INSIDE_M


@dataclass(frozen=True, eq=False)
class ZoneResult:
    """Which samples (N,) of a zone pass.

    `passed`: under all that the requirement has to survive; `whole`: with the rig as it stands;
    `without`: without each sensor. `seen` (N, bodies * headings) is by sensor, too.
    """

    passed: Flags
    whole: Flags
    without: Mapping[str, Flags]
    seen: Mapping[str, Flags]


@dataclass(frozen=True, eq=False)
class GroundFigures:
    """Blind ground of a zone: `blind_m2` of it is blind [m2], to `blind_distance` from the vehicle
    [m].

    Both limits could shrink by `spare_m2` and `spare_out` in the worst case that counts; negative:
    they are passed by so much; None where there is no such limit. `blind` (NX, NY) are the squares.
    """

    blind_m2: float
    blind_distance: float
    spare_m2: float | None
    spare_out: float | None
    blind: Flags
    cells: GroundCells


@dataclass(frozen=True, slots=True)
class VerdictSummary:
    """A verdict in plain values, which a front end may store as JSON and say in its own words.

    `margin_m`, `margin_at_least`, `share`, `blind_m2`, `condition` and `preview` are as in
    `Verdict`. Of the zone's `samples`, `failing` do not pass. `check` is the text that the
    requirement is after, "" for an own one.
    """

    name: str
    check: str
    met: bool
    margin_m: float | None
    margin_at_least: bool
    share: float
    samples: int
    failing: int
    blind_m2: float | None
    condition: str
    preview: bool
    worst: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class VerdictRow:
    """A verdict as result.json has it: the summary, and why; other fields are as in `Verdict`.

    `preset`: Name of the requirement's preset, if it is one. `fewest_sensors`, `most_sensors`: that
    see a body in the zone. `blind_distance_m`, `spare_m2`, `spare_out_m`: as in `GroundFigures`.
    `planes`: How the planes of the vehicle were found.
    """

    summary: Annotated[VerdictSummary, Part(inline=True)]
    preset: str | None
    source: str | None
    met_whole: bool
    worst_body: str | None
    seen_by: tuple[str, ...]
    unseen_by: Mapping[str, Reason]
    without: Mapping[str, bool]
    fewest_sensors: int
    most_sensors: int
    blind_distance_m: float | None
    spare_m2: float | None
    spare_out_m: float | None
    planes: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Verdict(ShortRepr):
    """A verdict on one requirement.

    `margin`: Met: how far the zone could grow before it fails [m]. Not met, negative: how far the
        zone would have to shrink. None: not known (a preview), or a path or spots that fail: they
        have no inside.
    `at_least`: Whether the zone could grow farther than was looked.
    `share`: Share of the zone's samples (of its ground) that pass.
    `worst` (x, y): The worst sample; None where all is seen.
    `body`: The body that is seen worst there.
    `seen_by`: Sensors that see that body.
    `why`: Computes `unseen_by`.
    `without`: Whether it is met without each sensor, by name.
    `sensors`: Fewest and most sensors that see a body in the zone.
    `ground`: Of the zone's ground, where that is asked for.
    `met_whole`: Whether it is met where no sensor is lost and all are mounted as they should.
    `condition`: State and weather of the worst verdict; "" for the vehicle as drawn, in clear air.
    `samples`: Where it was sampled.
    `passed` (N,): Whether each sample passes.
    """

    requirement: Requirement
    met: bool
    margin: float | None
    at_least: bool
    share: float
    worst: tuple[float, float] | None
    body: str | None
    seen_by: tuple[str, ...]
    why: Callable[[], Mapping[str, Reason]]
    without: Mapping[str, bool]
    sensors: tuple[int, int]
    samples: Samples
    passed: Flags
    ground: GroundFigures | None = None
    met_whole: bool = True
    preview: bool = False
    condition: str = ""

    @property
    def name(self) -> str:
        """Name of the requirement."""
        return self.requirement.name

    @cached_property
    def unseen_by(self) -> Mapping[str, Reason]:
        """Why each other sensor does not see that body, by name; computed when asked."""
        return self.why()

    @property
    def blind_m2(self) -> float | None:
        """Blind ground in the zone [m2], where that is asked for."""
        return None if self.ground is None else self.ground.blind_m2

    @property
    def summary(self) -> VerdictSummary:
        """The verdict in plain values."""
        inside = self.passed[self.samples.inside]
        return VerdictSummary(
            name=self.name,
            check=self.requirement.after,
            met=self.met,
            margin_m=self.margin,
            margin_at_least=self.at_least,
            share=round(self.share, 6),
            samples=len(inside),
            failing=int((~inside).sum()),
            blind_m2=self.blind_m2,
            condition=self.condition,
            preview=self.preview,
            worst=self.worst,
        )

    @property
    def breaks_without(self) -> tuple[str, ...]:
        """Sensors whose loss breaks a requirement that the whole rig meets."""
        return tuple(n for n, met in self.without.items() if not met) if self.met_whole else ()

    @property
    def row(self) -> VerdictRow:
        """The verdict in plain values, with why."""
        ground = self.ground
        return VerdictRow(
            summary=self.summary,
            preset=self.requirement.preset,
            source=self.requirement.source or None,
            met_whole=self.met_whole,
            worst_body=self.body,
            seen_by=self.seen_by,
            unseen_by=self.unseen_by,
            without=self.without,
            fewest_sensors=self.sensors[0],
            most_sensors=self.sensors[1],
            blind_distance_m=None if ground is None else ground.blind_distance,
            spare_m2=None if ground is None else ground.spare_m2,
            spare_out_m=None if ground is None else ground.spare_out,
            planes=self.samples.zone.planes.found,
        )

    @property
    def counted_margin(self) -> float:
        """Its margin [m]; of a path or spots that fail, which have none, one below all others."""
        return -FARTHEST_M * (2.0 - self.share) if self.margin is None else self.margin


def body_verdict(
    requirement: Requirement,
    samples: Samples,
    result: ZoneResult,
    rig: Rig,
    vehicle: Vehicle | None,
    preview: bool,
) -> Verdict:
    """Return the verdict on a requirement on bodies, from its samples; a preview has no margin."""
    wanted = requirement.criterion.zone_share
    inside = samples.inside
    share = float(result.passed[inside].mean())
    met = share >= wanted
    margin = None
    at_least = False
    if not (preview if met else samples.zone.kind in LINES):
        step = requirement.zone.step
        looked = samples.zone.grow
        margin, at_least = margin_of(samples.distance, result.passed, wanted, step, looked=looked)
    counts = np.sum([flags.astype(np.int64) for flags in result.seen.values()], axis=0)
    at = counts[inside]
    return Verdict(
        requirement,
        met,
        margin,
        at_least,
        share=share,
        **_worst_place(requirement, samples, result, counts, rig=rig, vehicle=vehicle, met=met),
        without={k: bool(flags[inside].mean() >= wanted) for k, flags in result.without.items()},
        sensors=(int(at.min()), int(at.max())),
        samples=samples,
        passed=result.passed,
        met_whole=bool(result.whole[inside].mean() >= wanted),
        preview=preview,
    )


def _worst_place(
    requirement: Requirement,
    samples: Samples,
    result: ZoneResult,
    counts: NDArray[np.int64],
    rig: Rig,
    vehicle: Vehicle | None,
    met: bool,
) -> dict[str, Any]:
    """Return the worst sample and body, who sees the body, and what says why the others do not."""
    failing = samples.inside if met else samples.inside & ~result.passed
    worst = worst_sample(samples.points, samples.distance, counts, failing)
    column = int(np.argmin(counts[worst]))
    body = columns_of(requirement)[column]
    x, y = samples.points[worst].tolist()

    blind = [s for s in rig if not result.seen[s.name][worst, column]]
    foot = x, y, requirement.zone.z[0]
    why = partial(_reasons, requirement.criterion, blind, body, foot, vehicle=vehicle)
    seen_by = tuple(s.name for s in rig if result.seen[s.name][worst, column])
    return {"worst": (x, y), "body": body.name, "seen_by": seen_by, "why": why}


def _reasons(
    criterion: Criterion,
    blind: Sequence[Sensor],
    body: Body,
    foot: tuple[float, float, float],
    vehicle: Vehicle | None,
) -> dict[str, Reason]:
    """Return why sensors do not see a body at a foot point, by name."""
    reasons = {
        s.name: why_not(s, body, foot, vehicle) if criterion.counts(s.kind) else Reason(NO_COUNT)
        for s in blind
    }
    if criterion.share is None:
        return reasons
    return {n: Reason(IN_PART) if r.code == TOO_FEW else r for n, r in reasons.items()}
