"""Verdicts: whether a requirement is met, by which margin, where it is worst, and what hides it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...scene.rig import Rig, Sensor
from ...scene.vehicle import Vehicle
from ...sensors import kind_of
from ..sight.ground_cells import GroundCells
from .bodies import Body
from .criteria import Requirement
from .zones import INSIDE_M, PlacedZone

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

DECIMALS = 2
"""Margins are rounded to the centimetre, to the safe side."""
TOO_FEW = "too few on it"
CUBE_M = 0.1
"""Side of the cubes by which it is told why a sensor does not see a body."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of a zone: `points` (N, 2) [m], `distance` (N,) to the zone, negative inside [m].

    `mask` (NX, NY) are the squares of a zone whose blind ground is asked for.
    """

    zone: PlacedZone
    points: Floats
    distance: Floats
    mask: Flags | None = None

    @cached_property
    def inside(self) -> Flags:
        """Whether each sample (N,) is in the zone."""
        return self.distance <= INSIDE_M


@dataclass(frozen=True, eq=False)
class Verdict:
    """A verdict on one requirement.

    Attributes
    ----------
    requirement : Requirement
    met : bool
    margin : float or None
        Met: how far the zone could grow before it fails [m]. Not met, negative: how far the zone
        would have to shrink. None: not known (a preview, or blind ground).
    at_least : bool
        Whether the zone could grow farther than was looked.
    share : float
        Share of the zone's samples (of its ground) that pass.
    worst : (x, y) or None
        The worst sample; None where all is seen.
    body : str or None
        The body that is seen worst there.
    seen_by : tuple of str
        Sensors that see that body.
    why : callable
        Computes `hidden`.
    without : dict of bool
        Whether it is met without each sensor, by name.
    sensors : tuple of int
        Fewest and most sensors that see a body in the zone.
    blind_m2 : float or None
        Blind ground in the zone [m2], where that is asked for.
    met_whole : bool
        Whether it is met where no sensor is lost and all are mounted as they should.
    preview : bool
    samples : Samples
        Where it was sampled.
    passed : (N,) bool
        Whether each sample passes.
    """

    requirement: Requirement
    met: bool
    margin: float | None
    at_least: bool
    share: float
    worst: tuple[float, float] | None
    body: str | None
    seen_by: tuple[str, ...]
    why: Callable[[], Mapping[str, str]]
    without: Mapping[str, bool]
    sensors: tuple[int, int]
    samples: Samples
    passed: Flags
    blind_m2: float | None = None
    met_whole: bool = True
    preview: bool = False
    blind: Flags | None = None
    cells: GroundCells | None = None

    @property
    def name(self) -> str:
        """Name of the requirement."""
        return self.requirement.name

    @cached_property
    def hidden(self) -> Mapping[str, str]:
        """Why each other sensor does not see that body, by name; computed when asked.

        A part of the vehicle, or "out of view", "out of range", "between beams", "too few on it".
        """
        return self.why()

    @property
    def margin_text(self) -> str:
        """The margin in words: "margin 0.42 m", "fails 0.15 m inside"."""
        if self.margin is None:
            return f"blind {self.blind_m2:.2f} m2" if self.blind_m2 is not None else ""
        if self.met:
            more = "at least " if self.at_least else ""
            return f"margin {more}{self.margin:.2f} m"
        return f"fails {-self.margin:.2f} m inside"

    @property
    def text(self) -> str:
        """One line: "geometric check after R159 Annex 3: met, margin 0.42 m"."""
        after = f"geometric check after {self.requirement.check}"
        what = after if self.requirement.check else self.name
        parts = ["met" if self.met else "not met", self.margin_text]
        preview = " (preview)" if self.preview else ""
        return f"{what}: {', '.join(p for p in parts if p)}{preview}"

    @property
    def breaks_without(self) -> tuple[str, ...]:
        """Sensors whose loss breaks a requirement that the whole rig meets."""
        return tuple(n for n, met in self.without.items() if not met) if self.met_whole else ()

    def to_dict(self) -> dict[str, Any]:
        """Return the verdict as plain data, as in result.json."""
        return {
            "name": self.name,
            "preset": self.requirement.preset,
            "check": self.requirement.check or None,
            "source": self.requirement.source or None,
            "met": self.met,
            "met_whole": self.met_whole,
            "margin_m": self.margin,
            "margin_at_least": self.at_least,
            "share": round(self.share, 6),
            "samples": int(self.samples.inside.sum()),
            "worst": None if self.worst is None else list(self.worst),
            "worst_body": self.body,
            "seen_by": list(self.seen_by),
            "hidden": dict(self.hidden),
            "without": dict(self.without),
            "fewest_sensors": self.sensors[0],
            "most_sensors": self.sensors[1],
            "blind_m2": self.blind_m2,
            "planes": dict(self.samples.zone.planes.found),
            "text": self.text,
        }


def verdict(
    requirement: Requirement,
    samples: Samples,
    rig: Rig,
    vehicle: Vehicle | None,
    passed: Flags,
    whole: Flags,
    without: Mapping[str, Flags],
    seen: Mapping[str, Flags],
    preview: bool,
) -> Verdict:
    """Return the verdict on a requirement from its samples.

    Parameters
    ----------
    passed : (N,) bool
        Samples that pass, under all that the requirement has to survive.
    whole : (N,) bool
        Samples that pass with the rig as it stands.
    without : mapping of sensor to (N,) bool
        Samples that pass without each sensor.
    seen : mapping of sensor to (N, bodies * headings) bool
    """
    wanted, inside = requirement.criterion.zone_share, samples.inside
    share = float(passed[inside].mean())
    met = share >= wanted
    margin, at_least = (
        (None, False)
        if preview and met
        else margin_of(samples.distance, passed, wanted, requirement.zone.step, samples.zone.grow)
    )
    counts = np.sum([flags.astype(np.int64) for flags in seen.values()], axis=0)
    failing = inside & (~passed if not met else np.ones(len(passed), bool))
    worst = _worst(samples, counts, failing)
    column = int(np.argmin(counts[worst]))
    body = _columns(requirement)[column]
    point = tuple(samples.points[worst].tolist())

    def why() -> dict[str, str]:
        foot = (*point, requirement.zone.z[0])
        blind = [s for s in rig if not seen[s.name][worst, column]]
        return {s.name: why_not(s, body, foot, vehicle) for s in blind}

    at = counts[inside]
    return Verdict(
        requirement,
        met,
        margin,
        at_least,
        share,
        (point[0], point[1]),
        body.name,
        tuple(s.name for s in rig if seen[s.name][worst, column]),
        why,
        {name: bool(flags[inside].mean() >= wanted) for name, flags in without.items()},
        (int(at.min()), int(at.max())),
        samples,
        passed,
        met_whole=bool(whole[inside].mean() >= wanted),
        preview=preview,
    )


def ground_verdict(
    requirement: Requirement,
    samples: Samples,
    cells: GroundCells,
    blind: Flags,
    met: bool,
    without: Mapping[str, bool],
    lost_counts: bool,
    preview: bool,
) -> Verdict:
    """Return the verdict on a requirement of blind ground, from its blind squares (NX, NY).

    `met` says whether the whole rig meets it, `without` whether the rig without each sensor does,
    and `lost_counts` whether it has to.
    """
    area = float(np.count_nonzero(blind)) * cells.step**2
    total = blind.size if samples.mask is None else max(int(np.count_nonzero(samples.mask)), 1)
    i, j = np.nonzero(blind)
    worst = None
    if len(i):
        x, y = cells.x[i], cells.y[j]
        far = samples.zone.distance(np.stack([x, y], axis=1))
        k = int(np.argmin(far))
        worst = (round(float(x[k]), 3), round(float(y[k]), 3))
    return Verdict(
        requirement,
        met and (not lost_counts or all(without.values())),
        None,
        False,
        1.0 - np.count_nonzero(blind) / total,
        worst,
        None,
        (),
        dict,
        without,
        (0, 0),
        samples,
        np.zeros(0, bool),
        blind_m2=math.ceil(area * 100.0 - 1e-6) / 100.0,
        met_whole=met,
        preview=preview,
        blind=blind,
        cells=cells,
    )


def margin_of(
    distance: Floats, passed: Flags, wanted: float, step: float, looked: float
) -> tuple[float, bool]:
    """Return how far a zone could grow [m] before it fails, and whether it could grow farther.

    A zone that is grown by d has all samples with a distance of at most d. Negative: how far a zone
    that fails would have to shrink. Between two samples nothing is known, so a step is taken off,
    and figures are rounded down.

    Parameters
    ----------
    distance : (N,) float
        Of the samples to the zone, negative inside [m].
    passed : (N,) bool
    wanted : float
        Share of the samples that has to pass.
    step : float
        Of the samples [m].
    looked : float
        How far round the zone samples were taken [m].
    """
    order = np.argsort(distance, kind="stable")
    away, ok = distance[order], passed[order]
    share = np.cumsum(ok) / np.arange(1, len(ok) + 1)
    last = np.append(away[1:] - away[:-1] > INSIDE_M, True)  # the last sample at its distance
    away, share = away[last], share[last]
    fails = share < wanted
    grown = away > INSIDE_M
    inner = away[~grown]
    if len(inner) and not fails[~grown][-1]:
        first = np.flatnonzero(fails & grown)
        if not len(first):
            return _down(looked), True
        return max(0.0, _down(float(away[first[0]]) - step)), False
    met = np.flatnonzero(~fails & ~grown)
    inward = float(away[met[-1]]) if len(met) else float(inner[0]) - step
    return min(_down(inward), -_down(step)), False


def _down(value: float) -> float:
    """Round down to the centimetre."""
    return math.floor(value * 10**DECIMALS + 1e-6) / 10**DECIMALS


def _worst(samples: Samples, counts: NDArray[np.int64], among: Flags) -> int:
    """Return the sample that the fewest sensors see; of equal ones that deepest in the zone."""
    some = np.flatnonzero(among)
    fewest = counts[some].min(axis=1)
    x, y = samples.points[some].T
    order = np.lexsort((y, x, samples.distance[some], fewest))
    return int(some[order[0]])


def _columns(requirement: Requirement) -> list[Body]:
    """Return the body of each column of what sensors see, the heights of the zone too."""
    low, high = requirement.zone.z
    levels = 1 if high == low else int(np.ceil((high - low) / requirement.zone.step)) + 1
    return [body for body in requirement.bodies for _ in range(levels) for _ in body.headings]


def why_not(sensor: Sensor, body: Body, foot: tuple[float, ...], vehicle: Vehicle | None) -> str:
    """Return why a sensor does not see a body: a part of the vehicle, or another reason.

    Cubes in the middle, at the top and at the foot of the body are asked for. The first that the
    sensor would see without the vehicle decides: by the part that most of its rays end on.
    """
    kind = kind_of(sensor)
    x, y, z = foot
    heights = (0.5 * body.size[2], max(body.size[2] - CUBE_M / 2.0, 0.0), CUBE_M / 2.0)
    centers = np.array([[x, y, z + body.low + height] for height in heights])
    in_view = kind.measure(sensor, centers, CUBE_M, None) > 0.0
    for center in centers[in_view]:
        directions, lengths = kind.rays_to(sensor, center, CUBE_M)
        if vehicle is None or not len(directions):
            continue
        glass = sensor.model.sees_through_glass
        hits = vehicle.first_hit(sensor.pose.position, directions, glass)
        parts = vehicle.parts[hits.face[hits.distance < lengths]]
        if len(parts):
            return str(vehicle.part_names[int(np.bincount(parts).argmax())])
        return TOO_FEW
    return TOO_FEW if in_view.any() else kind.missed(sensor, centers[0], CUBE_M)
