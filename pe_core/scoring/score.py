"""The score of a rig: entropy, coverage, the same by part, its scatter; what evaluates rigs.

The errors of two scores on one sample are correlated: if the sample has too many far voxels, both
entropies are too high. Their difference is far more precise than either of them. A score therefore
stores the residuals of its means in a few batches of the sample. Residuals of two scores on the
same sample are subtracted by batch (paired); on different samples, their squares are added.
"""

import hashlib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, read_only
from ..base.codec import Recorded
from ..base.notebook import ShortRepr, Tabular
from ..base.setting import AtTimes, NotStored
from ..base.values import DECIMALS, error_text, rounded, shown_share
from ..geometry.grids import PerceptionSpace
from ..metric.entropy import H_BEST, H_BLIND
from ..scene.rig import Rig
from ..sensors import Occlusion

FigureKey = tuple[str, str, str]
"""Group ("rig", "zone", "class"), name (empty for the rig), and measure ("entropy", ...)."""
ALIKE = 10.0**-DECIMALS  # Entropies no farther apart than this do not differ [nats]
RULE_OF_THREE = 3.0
"""Rule of three: if n draws are equal, at most 3 / n of all others differ, with 95 % certainty."""
FARTHEST_M = 80.0
"""Maximum distance of lone objects: a reach of this value means "at least"."""
POINTS = (1, 5, 20)
"""Numbers of points of all LiDARs together by which objects are counted."""
NEAR_M = 10.0
FAR_M = 40.0
ZONES = ("front", "rear", "left", "right", "near", "mid", "far")
"""Half planes before, behind, left and right of the vehicle's centre, and rings round it: nearer
than NEAR_M, farther than FAR_M, and between."""
BY_DISTANCE = ZONES[4:]
SURE = 2.0
"""A difference up to so many of its standard errors is noise."""
NO_DIFFERENCE = "no difference shown"
"""What is said of such a difference, wherever it is shown."""
Watch = Callable[[float], bool]
"""Called repeatedly with the completed share of a score, 0 to 1; returns whether to continue."""


def is_noise(difference: float, error: float) -> bool:
    """Whether a difference is within `SURE` of its standard errors: no difference is shown."""
    return abs(difference) <= SURE * error


@dataclass(frozen=True, slots=True)
class Scatter(ShortRepr):
    """Residuals of a score's means.

    Attributes
    ----------
    sample : str
        Digest of the sample; scores on the same sample have the same digest.
    residuals : mapping of FigureKey to tuple of float
        For each figure, a weighted mean over the sample: what each batch adds to it above the mean,
        sum_i w_i (v_i - mean) / sum w over the batch's members, (R,) in the figure's own unit. They
        sum to 0.
    """

    sample: str
    residuals: Mapping[FigureKey, tuple[float, ...]]

    @property
    def batches(self) -> int:
        """How many batches the sample was divided into."""
        return len(self.residuals["rig", "", "entropy"])

    def error(self, figure: FigureKey) -> float | None:
        """Return the standard error of a figure; None where the score has no such figure."""
        by_batch = self.residuals.get(figure)
        return None if by_batch is None else standard_error(by_batch)

    def to_dict(self) -> dict[str, Any]:
        """Return the residuals as plain JSON data."""
        rows = [[*figure, list(by_batch)] for figure, by_batch in self.residuals.items()]
        return {"sample": self.sample, "residuals": rows}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Scatter":
        """Return the `Scatter` from the data of `to_dict`."""
        rows = {
            (group, name, measure): tuple(sums) for group, name, measure, sums in data["residuals"]
        }
        return cls(data["sample"], rows)


def paired_error(one: Scatter | None, other: Scatter | None, figure: FigureKey) -> float | None:
    """Return the standard error of the difference of a figure of two scores on the same sample.
    None where they are of different samples, or one lacks the figure: their errors are then
    independent."""
    if one is None or other is None or one.sample != other.sample:
        return None
    a = one.residuals.get(figure)
    b = other.residuals.get(figure)
    if a is None or b is None or len(a) != len(b):
        return None
    return standard_error([x - y for x, y in zip(a, b, strict=True)])


def residuals(
    values: Floats, weights: Floats | None, batch: NDArray[np.int64], batches: int
) -> tuple[float, ...]:
    """Return the residuals by batch (R,) of a mean of values (N,); see `Scatter`. `weights` None:
    equal ones. `batch` (N,) numbers the batch of each value."""
    shares = np.ones(len(values)) if weights is None else weights
    mass = float(shares.sum())
    off = shares * (values - float((shares * values).sum()) / mass)
    return tuple(rounded(total / mass) for total in np.bincount(batch, off, batches).tolist())


def sample_digest(parts: Iterable[NDArray[Any]]) -> str:
    """Return a digest of the arrays that a sample consists of."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(np.ascontiguousarray(part).tobytes())
    return digest.hexdigest()[:16]


def unseen_error(groups: int, count: int) -> float:
    """Return the standard error of a mean entropy of `count` voxels or objects that do not differ
    [nats]: half of the bound by the rule of three, for others that have any entropy from blind to
    the best that all fusion groups reach."""
    max_difference = H_BLIND - H_BEST + math.log(groups)
    return rounded(RULE_OF_THREE / 2.0 * max_difference / count)


def standard_error(batches: Iterable[float]) -> float:
    """Return the standard error of a mean from its residuals in independent batches."""
    values = list(batches)
    square = math.fsum(value * value for value in values)
    return rounded(math.sqrt(square * len(values) / max(len(values) - 1, 1)))


@dataclass(frozen=True, slots=True)
class FoundClass:
    """How well a rig finds a class of objects.

    `objects`: How many objects were evaluated.
    `share`: Weight of the class in the score, 0 to 1.
    `entropy, stderr`: Mean entropy of its objects [nats], and the standard error.
    `ap, ap_stderr`: Expected AP, 0 to 1: the mean over its objects, and the standard error.
    `points`: Share of its objects that get at least so many points, by number; empty without
        LiDARs.
    `reach`: By direction, the distance up to which a lone object of the class is found with an AP
        of 0.5 [m]: 0 where no object is found, `FARTHEST_M` where AP stays at 0.5 or above.
    """

    objects: int
    share: float
    entropy: float
    stderr: float
    ap: float
    ap_stderr: float
    points: Mapping[int, float]
    reach: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class TrafficAp:
    """Expected AP of objects in traffic: the mean over all, by their weights, and by ring.

    `ap, stderr`: 0 to 1, and its standard error.
    `scenes`: Number of scenes of the sample.
    `rings`: AP and standard error by "near", "mid" and "far" (`ZONES`); a ring without objects is
        left out.
    `scatter`: Residuals of these by batch, for the error of a difference.
    """

    ap: float
    stderr: float
    scenes: int
    rings: Mapping[str, tuple[float, float]]
    scatter: Annotated[Scatter | None, NotStored] = field(default=None, compare=False, repr=False)

    def error_from(self, other: "TrafficAp", ring: str = "") -> float:
        """Return the standard error of the difference from another rig's AP, of a ring or of all:
        paired where both are of the same scenes, else as of independent ones."""
        key = ("zone", ring, "ap") if ring else ("rig", "", "ap")
        paired = paired_error(self.scatter, other.scatter, key)
        if paired is not None:
            return paired
        own = [each.rings[ring][1] if ring else each.stderr for each in (self, other)]
        return math.hypot(*own)


@dataclass(frozen=True, slots=True)
class ObjectScore(Recorded, Tabular):
    """Score of a rig on objects, beside entropy and coverage.

    Attributes
    ----------
    ap, ap_stderr : float
        Expected AP of all classes, by their weights, and its standard error.
    objects, scenes : int
        Numbers of objects and scenes; without traffic each labelled box has its own scene.
    traffic : bool
        Whether the objects of a scene occlude each other. Reach is always that of a lone object.
    per_class : dict of FoundClass
    """

    ap: float
    ap_stderr: float
    objects: int
    scenes: int
    traffic: bool
    per_class: dict[str, FoundClass]

    def _rows(self) -> list[dict[str, Any]]:
        return [
            {"class": name, "objects": c.objects, "AP": c.ap, "entropy [nats]": c.entropy}
            | {f"reach {direction} [m]": far for direction, far in c.reach.items()}
            for name, c in self.per_class.items()
        ]


def zone_masks(x: NDArray[np.float64], y: NDArray[np.float64]) -> dict[str, NDArray[np.bool_]]:
    """Return, by zone, a mask of the points (x, y) [m], broadcast together, that lie in it."""
    x, y = np.broadcast_arrays(x, y)
    square = x * x + y * y
    near = square < NEAR_M**2
    far = square > FAR_M**2
    masks = (x > 0.0, x < 0.0, y > 0.0, y < 0.0, near, ~near & ~far, far)
    return dict(zip(ZONES, masks, strict=True))


def column_zones(space: PerceptionSpace) -> dict[str, NDArray[np.bool_]]:
    """Return, by zone, a mask (nx, ny) of the columns of a space."""
    return zone_masks(space.centers(0)[:, None], space.centers(1)[None, :])


class ScoreStopped(Exception):
    """The `watch` callable stopped a score; there is no result."""


class ScoreProgress:
    """Tells a `Watch` the completed share of some work; raises `ScoreStopped` if it says stop."""

    def __init__(self, watch: Watch | None, total: float) -> None:
        self._watch = watch
        self._total = total
        self._done = 0.0
        self._stopped = False
        self.add(0.0)

    def add(self, work: float = 1.0) -> None:
        """Count work as done."""
        self._done += work
        if self._watch is not None and not self._watch(min(self._done / self._total, 1.0)):
            self._stopped = True
        self.check()

    def check(self) -> None:
        """Raise `ScoreStopped` if the score was stopped; threads ask before each block."""
        if self._stopped:
            raise ScoreStopped


@dataclass(frozen=True, slots=True)
class PartScore:
    """A class or a zone: perception entropy [nats], coverage, and its share of the prior."""

    entropy: float
    coverage: float
    share: float


@dataclass(frozen=True, slots=True)
class SensorScore:
    """One sensor: its score alone, the loss without it, and its occlusion by the vehicle.

    `entropy` and `coverage` are those of a rig of this sensor alone; `lost` is the rise of the
    whole rig's entropy when the sensor fails. `beams` counts a LiDAR's beams, or pixels spread
    evenly over a camera's image; the vehicle occludes `occluded` of them, `occluded_by` counts them
    by part. All are 0 for a kind without this information.
    """

    entropy: float
    coverage: float
    lost: float
    beams: int
    occluded: int
    occluded_by: dict[str, int]


@dataclass(frozen=True, slots=True)
class GroundMap(ShortRepr):
    """Entropy and coverage of every column, averaged over height by the prior; (nx, ny) each.

    `mass` is the prior in each column. Columns without mass, also inside the vehicle, hold NaN.
    """

    entropy: NDArray[np.float64]
    coverage: NDArray[np.float64]
    mass: NDArray[np.float64]

    def coarser(self, columns: int) -> "GroundMap":
        """Return the map in squares of `columns` by `columns` columns (fewer at the far edges)."""
        rows, ys = (np.arange(0, n, columns) for n in self.mass.shape)

        def summed(values: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.add.reduceat(np.add.reduceat(values, rows, axis=0), ys, axis=1)

        mass = summed(self.mass)
        safe = np.where(mass > 0.0, mass, np.nan)
        weighted = (np.nan_to_num(v) * self.mass for v in (self.entropy, self.coverage))
        entropy, coverage = (summed(v) / safe for v in weighted)
        return GroundMap(entropy, coverage, mass)


def ground_map(columns: NDArray[np.float64]) -> GroundMap:
    """Return the map of columns (3, nx, ny): entropy and coverage times prior, and the prior."""
    entropy, coverage, mass = columns
    safe = np.where(mass > 0.0, mass, np.nan)
    return GroundMap(*map(read_only, (entropy / safe, coverage / safe, mass.copy())))


@dataclass(frozen=True, slots=True)
class Score(Recorded, Tabular):
    """Score of a rig.

    Attributes
    ----------
    entropy : float
        Perception entropy, eq. 9 [nats]; lower is better.
    coverage : float
        Prior mass with m > 0 for some sensor, 0 to 1.
    stderr : float
        Standard error of `entropy`; 0 only for a score of the whole grid.
    per_class : dict of PartScore
    per_zone : dict of PartScore
        Zones overlap: see `zones.ZONES`. A zone without prior mass is left out.
    per_sensor : dict of SensorScore
        Empty in a summary.
    voxels : int
        Number of voxels evaluated.
    ground_map : GroundMap or None
        None for a sampled score.
    objects : ObjectScore or None
        Only for a score on objects: entropy, coverage and the other figures are then weighted
        means over objects, and no voxel was evaluated.
    scatter : Scatter or None
        Residuals of the figures by batch, for the error of a difference; None for a grid score.
    ap : float or None
        Expected AP of all objects, where these are scored.
    """

    entropy: float
    coverage: float
    stderr: float
    per_class: dict[str, PartScore]
    per_zone: dict[str, PartScore]
    per_sensor: dict[str, SensorScore]
    voxels: int
    ground_map: Annotated[GroundMap | None, NotStored] = None
    objects: Annotated[ObjectScore | None, AtTimes] = None
    scatter: Annotated[Scatter | None, NotStored] = None
    ap: Annotated[float | None, NotStored] = None

    def _caption(self) -> str:
        error = f" ± {error_text(self.stderr)}" if self.stderr else ""
        return f"{self.entropy:.3f}{error} nats, coverage {shown_share(self.coverage):.1%}"

    def _rows(self) -> list[dict[str, Any]]:
        whole = PartScore(self.entropy, self.coverage, 1.0)
        of: dict[str, Mapping[str, PartScore | SensorScore]] = {"rig": {"": whole}}
        of |= {"class": self.per_class, "zone": self.per_zone, "sensor": self.per_sensor}
        rows = []
        for group, parts in of.items():
            for name, part in parts.items():
                row: dict[str, Any] = {"of": group, "name": name, "entropy [nats]": part.entropy}
                row["coverage"] = part.coverage
                if isinstance(part, PartScore):
                    row["share"] = part.share
                else:
                    row |= {"lost [nats]": part.lost, "beams": part.beams}
                    row["occluded"] = part.occluded / part.beams if part.beams else None
                rows.append(row)
        return rows


def sensor_score(entropy: float, coverage: float, lost: float, occlusion: Occlusion) -> SensorScore:
    """Return the score of one sensor; `occlusion` counts its occluded beams."""
    return SensorScore(
        entropy,
        coverage,
        lost,
        occlusion.rays,
        occluded=occlusion.occluded,
        occluded_by=occlusion.by_part,
    )


class RigEvaluator(Protocol):
    """Scores rigs in one space, under one prior, on one vehicle; methods are as `Evaluator`'s.

    `samples` is how many voxels or objects are evaluated; 0: all voxels.
    """

    samples: int

    def score(self, rig: Rig, *, watch: Watch | None = None) -> Score:
        """Score a rig in full."""

    def summary(self, rig: Rig) -> Score:
        """Score a rig as a whole, without the part by sensor."""

    def entropy(self, rig: Rig) -> float:
        """Return a rig's entropy [nats]."""

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Return the entropy of each of several rigs [nats]."""

    def residuals(self, rigs: Sequence[Rig]) -> Floats:
        """Return by rig what each batch of the sample adds to the entropy above its mean (N, R)."""
