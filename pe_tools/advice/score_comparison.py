"""Compare scores of several rigs: differences, their standard errors, and which are significant."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from statistics import NormalDist

from pe_core import catalog
from pe_core.base.codec import Recorded
from pe_core.motion.drive_by import shown_margin
from pe_core.scene.rig import SensorModel
from pe_core.scoring.sampling import BLOCKS
from pe_core.scoring.score import (
    BY_DISTANCE,
    NO_DIFFERENCE,
    FigureKey,
    PartScore,
    Score,
    TrafficAp,
    is_noise,
    paired_error,
)
from pe_core.scoring.sight import SECTOR_RADIUS_M
from pe_core.search import FIGURES, Figure, KeyFigures
from pe_core.search.figures import (
    AP,
    AP_RINGS,
    BLIND_GROUND,
    BLIND_SECTOR,
    COVERAGE,
    ENTROPY,
    REACH,
    SCENARIO_MARGIN,
)

CERTAINTY = 0.95
TRAFFIC = "in traffic"
NEVER = -math.inf  # Margin of a scenario that is never confirmed: there is no worse one
OTHER_HARDWARE = (
    "The rigs differ in models or numbers of sensors. On simulated rigs of LiDARs entropy was not "
    "shown to rank better than the number of beams, and it can prefer a rig with a blind sector; "
    "nor was it shown to rank rigs of cameras; radars were not tested. Look at blind ground, and "
    "at the expected AP in traffic, beside it (docs/validity)."
)
"""Note beside scores of rigs that differ in their sensors, not in their placement alone."""
OTHER_RETURNS = "LiDAR returns differ, as in the paper or on the road: do not compare scores."
AHEAD = "front"  # Direction whose reach is compared


def sure_factor(studies: int, degrees: int = BLOCKS - 1) -> float:
    """Return how many standard errors a difference must exceed to be significant. It is a two-sided
    quantile of Student's t distribution. All pairs of the studies are compared: the Bonferroni
    correction divides the 5 % error probability among them. The standard errors have `degrees` of
    freedom, the number of batches of the estimate minus one."""
    pairs = max(studies * (studies - 1) // 2, 1)
    z = NormalDist().inv_cdf(1.0 - (1.0 - CERTAINTY) / (2.0 * pairs))
    # Abramowitz & Stegun 26.7.5, quantile of Student's t from that of the normal distribution.
    terms = (
        z,
        (z**3 + z) / 4.0,
        (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / 96.0,
        (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / 384.0,
        (79.0 * z**9 + 776.0 * z**7 + 1482.0 * z**5 - 1920.0 * z**3 - 945.0 * z) / 92160.0,
    )
    return math.fsum(term / degrees**k for k, term in enumerate(terms))


def degrees_of(scores: Iterable[Score]) -> int:
    """Return the degrees of freedom of the errors of several scores: the lowest of all."""
    batches = [score.scatter.batches for score in scores if score.scatter is not None]
    return max(min(batches, default=BLOCKS) - 1, 1)


def difference_errors(scores: Sequence[Score], figure: FigureKey) -> tuple[tuple[float, ...], ...]:
    """Return the standard errors of the differences of a figure between all pairs of scores. Errors
    of scores on the same sample are paired (`scoring.scatter`). Errors of scores on different
    samples are independent: their squares add up. The error is 0 for scores of the whole grid, and
    for reach, which is not sampled. The result (N, N) has the unit of the figure."""
    errors = [_error(score, figure) for score in scores]
    found = [[0.0] * len(scores) for _ in scores]
    for i, j in permutations(range(len(scores)), 2):
        paired = paired_error(scores[i].scatter, scores[j].scatter, figure)
        found[i][j] = math.hypot(errors[i], errors[j]) if paired is None else paired
    return tuple(map(tuple, found))


def difference_error(one: Score, other: Score, figure: FigureKey) -> float:
    """Return the standard error of the difference of a figure between two scores."""
    return difference_errors([one, other], figure)[0][1]


def _error(score: Score, figure: FigureKey) -> float:
    """Return the standard error of a figure of one score."""
    if not score.stderr or figure[2] == "reach":
        return 0.0
    if figure == ("rig", "", "entropy"):
        return score.stderr
    stored = None if score.scatter is None else score.scatter.error(figure)
    if stored is not None:
        return stored
    # The scatter lacks it: it is that of the objects, or an upper bound.
    group, name, measure = figure
    objects = score.objects
    found_class = None if objects is None or group != "class" else objects.per_class.get(name)
    if objects is not None and measure == "ap":
        return objects.ap_stderr if found_class is None else found_class.ap_stderr
    if found_class is not None and measure == "entropy":
        return found_class.stderr
    parts: Mapping[str, PartScore] = score.per_zone if group == "zone" else score.per_class
    share = parts[name].share if name in parts else 1.0
    if measure == "entropy":
        return score.stderr / math.sqrt(share)  # as if its part of the sample were a random draw
    count = score.voxels if objects is None else objects.objects
    return 0.5 / math.sqrt(max(share * count, 1.0))  # maximum standard error of a share, at 0.5


@dataclass(frozen=True, slots=True)
class ComparedRow(Recorded):
    """One figure of several rigs: a row of a comparison table. `group`, `name`: "rig", "zone",
    "class" or "in traffic", and the name of the zone or class. `measure`: A key of `FIGURES`.
    `values`: by score; None for a score without this zone, class or scenario; `NEVER` for a
    scenario that is not confirmed. `errors`: (N, N) standard errors of the differences of each two
    values; 0 where nothing is sampled. `factor`: number of standard errors beyond which a
    difference is significant (`sure_factor`)."""

    derived = ("differences", "best", "spread")
    group: str
    name: str
    measure: str
    values: tuple[float | None, ...]
    errors: tuple[tuple[float, ...], ...]
    factor: float = 0.0

    @property
    def how(self) -> Figure:
        """How its figure is told."""
        return FIGURES[self.measure]

    @property
    def told(self) -> tuple[float | None, ...]:
        """The values as they are told, on the safe side, in units of the heading."""
        return tuple(None if v is None else self.how.told(v) for v in self.values)

    def text(self, k: int) -> str:
        """Return a value as text; "-" where it is missing."""
        value = self.told[k]
        return {None: "-", NEVER: "none"}.get(value, f"{value or 0.0:.{self.how.decimals}f}")

    def change_text(self, k: int, plus_minus: str = "+-") -> str:
        """Return a told value minus the first as text, with the standard error of that after a
        sign; empty for the first, or without a number.

        Within the standard error of the difference no difference is shown.
        """
        first, own = (math.nan if v is None else v for v in (self.told[0], self.told[k]))
        if not k or not math.isfinite(own - first):
            return ""
        text = self.difference_text(own - first, 0, k)
        error = self.how.scale * self.errors[0][k]
        is_told = text != NO_DIFFERENCE and text.strip("+-0.")
        least = 10.0**-self.how.decimals
        sure = f" {plus_minus} {max(error, least):.{self.how.decimals}f}"
        return f"{text}{sure}" if error and is_told else text

    def difference_text(self, by: float, one: int, other: int) -> str:
        """Return a difference of two told values, given by index, as text.

        Within its standard error no difference is shown.
        """
        text = f"{by:+.{self.how.decimals}f}"
        return NO_DIFFERENCE if text.strip("+-0.") and self.is_noise(one, other) else text

    def is_noise(self, one: int, other: int) -> bool:
        """Whether two values, given by index, differ within the standard error of it."""
        a = self.values[one]
        b = self.values[other]
        return a is not None and b is not None and is_noise(a - b, self.errors[one][other])

    def is_told_alike(self, one: int, other: int) -> bool:
        """Whether two values, given by index, are the same to a reader."""
        return self.told[one] == self.told[other]

    @property
    def differences(self) -> tuple[float | None, ...]:
        """Each value minus the first one; None where one of the two is missing."""
        first = self.values[0] if self.values else None
        return tuple(None if v is None or first is None else v - first for v in self.values)

    @property
    def best(self) -> tuple[bool, ...]:
        """Marks of the best value and those not significantly worse; of none if these are all."""
        best = {k for k in self.order if not self.differ(self.order[0], k)}
        return tuple(k in best and len(best) < len(self.order) for k in range(len(self.values)))

    @property
    def order(self) -> tuple[int, ...]:
        """Indices of the scores that have a value, the best first."""
        present = [(self.how.signed(v), k) for k, v in enumerate(self.values) if v is not None]
        return tuple(k for _, k in sorted(present))

    def sense(self, k: int) -> int:
        """Return -1 if a value is clearly better than the first one, 1 if it is worse, else 0. A
        loss counts from two standard errors on, a gain from `factor` of them."""
        less = self.differences[k]
        if less is None or abs(less) <= self.how.least or self.is_noise(0, k):
            return 0
        if self.is_told_alike(0, k):
            return 0
        if (less < 0.0) == self.how.higher:
            return 1
        return -1 if self.differ(0, k) else 0

    @property
    def spread(self) -> float:
        """Difference of best and worst value, as a share of the larger one; 0 if it is not sure."""
        order = self.order
        if not order or not self.differ(order[0], order[-1]):
            return 0.0
        ends = [self.values[k] or 0.0 for k in (order[0], order[-1])]
        return math.inf if NEVER in ends else abs(ends[0] - ends[1]) / max(map(abs, ends))

    def share(self, k: int) -> float:
        """Return how long the bar of a value is, 0 to 1: the longest of the row is 1."""
        known = [value for value in self.values if value not in (None, NEVER)]
        low = min([0.0, *known])
        high = max([0.0, *known])
        return (max(self.values[k] or 0.0, low) - low) / (high - low) if high > low else 0.0

    def differ(self, one: int, other: int) -> bool:
        """Whether two values, given by index, differ significantly; False where one is missing, or
        where both are told alike."""
        if self.is_told_alike(one, other):
            return False
        a = self.values[one]
        b = self.values[other]
        threshold = max(self.how.least, self.factor * self.errors[one][other])
        return a is not None and b is not None and abs(a - b) > threshold


def compare(scores: Mapping[str, Score]) -> tuple[ComparedRow, ...]:
    """Compare scores by name: entropy and coverage of the rigs, of every zone and of every class.
    For scores on objects, expected AP and reach ahead follow. Differences refer to the first
    score."""
    return tuple(_rows(list(scores.values())))


def compare_figures(figures: Mapping[str, KeyFigures]) -> tuple[ComparedRow, ...]:
    """Compare key figures: expected AP in traffic, blind sectors, blind ground, and reach ahead, as
    far as they were computed. Differences refer to the first. The error of a difference of AP is
    paired where rigs share the scenes, and that of independent samples where they do not."""
    columns = list(figures.values())
    if not columns:
        return ()
    rows = [*_traffic_rows([figures.traffic for figures in columns])]
    none = ((0.0,) * len(columns),) * len(columns)
    widths = [{sector.height: sector.width for sector in own.sectors} for own in columns]
    for height in dict.fromkeys(height for own in widths for height in own):
        tall = f"{height:g} m tall, at {SECTOR_RADIUS_M:g} m"
        wide = tuple(own.get(height) for own in widths)
        rows.append(ComparedRow("rig", tall, BLIND_SECTOR, wide, errors=none))
    over_frames = tuple(f.over_frames for f in columns)
    if any(value is not None for value in over_frames):
        rows.append(ComparedRow("rig", "over frames", ENTROPY, over_frames, errors=none))
    for scenario in dict.fromkeys(name for own in columns for name in own.margins):
        told = [shown_margin(own.margins.get(scenario)) for own in columns]
        never = [own.margins.get(scenario, 0.0) is None for own in columns]
        margins = (NEVER if lost else margin for margin, lost in zip(told, never, strict=True))
        rows.append(ComparedRow("scenario", scenario, SCENARIO_MARGIN, tuple(margins), errors=none))
    height_text = f"{columns[0].height:g} m tall, within {columns[0].within:g} m"
    apart = {BLIND_GROUND: height_text}
    detailed = {BLIND_SECTOR, REACH, *AP_RINGS}
    for key in (key for key, row in FIGURES.items() if row.is_seen and key not in detailed):
        values = tuple(f.values.get(key) for f in columns)
        if any(value is not None for value in values):
            rows.append(ComparedRow("rig", apart.get(key, ""), key, values, errors=none))
    for name in dict.fromkeys(name for own in columns for name in own.reach):
        ahead = tuple(f.reach[name][0] if name in f.reach else None for f in columns)
        rows.append(ComparedRow("class", name, REACH, ahead, errors=none))
    return tuple(rows)


def _traffic_rows(found: Sequence[TrafficAp | None]) -> Iterator[ComparedRow]:
    """Yield rows of the expected AP in traffic: of the rigs, and by distance."""
    of_rigs = [None if each is None else (each.ap, each.stderr) for each in found]
    by_ring = {
        name: [None if each is None else each.rings.get(name) for each in found]
        for name in BY_DISTANCE
    }
    for name, cells in {"": of_rigs, **by_ring}.items():
        if any(cell is not None for cell in cells):
            values = tuple(None if cell is None else cell[0] for cell in cells)
            has_ring = [
                None if each is None or cell is None else each
                for each, cell in zip(found, cells, strict=True)
            ]
            errors = tuple(
                tuple(0.0 if a is None or b is None else a.error_from(b, name) for b in has_ring)
                for a in has_ring
            )
            yield ComparedRow(
                TRAFFIC, name, AP, values, errors=errors, factor=sure_factor(len(found))
            )


def _rows(scores: list[Score]) -> Iterator[ComparedRow]:
    for measure in (ENTROPY, COVERAGE):
        values = [getattr(score, measure) for score in scores]
        yield _row(scores, "rig", "", measure, values=values)
    parts = {"zone": [s.per_zone for s in scores], "class": [s.per_class for s in scores]}
    for group, by_name in parts.items():
        for name in dict.fromkeys(name for part in by_name for name in part):
            for measure in (ENTROPY, COVERAGE):
                values = [getattr(p[name], measure) if name in p else None for p in by_name]
                yield _row(scores, group, name, measure, values=values)
    objects = [score.objects for score in scores]
    by_class = [{} if scored is None else scored.per_class for scored in objects]
    names = dict.fromkeys(name for classes in by_class for name in classes)
    if names:
        whole = [None if scored is None else scored.ap for scored in objects]
        yield _row(scores, "rig", "", AP, values=whole)
    for name in names:
        aps = [classes[name].ap if name in classes else None for classes in by_class]
        yield _row(scores, "class", name, AP, values=aps)
        ahead = [classes[name].reach[AHEAD] if name in classes else None for classes in by_class]
        yield _row(scores, "class", name, REACH, values=ahead)


def _row(
    scores: list[Score], group: str, name: str, measure: str, values: list[float | None]
) -> ComparedRow:
    errors = difference_errors(scores, (group, name, measure))
    factor = sure_factor(len(scores), degrees_of(scores))
    return ComparedRow(group, name, measure, tuple(values), errors=errors, factor=factor)


def hardware_note(rigs: Iterable[Sequence[SensorModel]]) -> str:
    """Return `OTHER_HARDWARE` where rigs, by their models in any order, differ; else nothing. Where
    LiDARs have other `returns`, it is `OTHER_RETURNS`."""
    rows = [list(models) for models in rigs]
    if len({m.returns for models in rows for m in models if hasattr(m, "returns")}) > 1:
        return OTHER_RETURNS
    values = [sorted(repr(catalog.to_table(model)) for model in models) for models in rows]
    return OTHER_HARDWARE if any(each != values[0] for each in values) else ""
