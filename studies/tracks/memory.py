"""How long frames of one object depend on each other: correlations by lag, and the time they give.

`docs/validity/tracks/plan.md` says what is measured, and what would refute it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pe_core.base import Flags, Floats, Ints
from pe_core.motion import Confirmation

from ..results_file import Json
from ..road.logs import CLASSES, Log
from ..road.statistics import rounded
from .moments import BOOTSTRAP, FRAME_S, tracks_of

LAGS = (1, 2, 3, 5, 10, 20)
JUDGED = LAGS[:-1]
"""Lags of the fit and of the statements."""
OF_CLASSES = ("car", "pedestrian")
GROUPS = {"thirds": 3, "tenths": 10}
MIN_PAIRS = 300
TIMES_S = np.round(np.arange(1, 301) * 0.1, 1)
LASTING = np.round(np.arange(0, 20) * 0.05, 2)
"""Shares of the variance that stay for good, of the form of two numbers."""
NEAR = 0.1
HEAD = ("", "T [s]", *(f"{lag * FRAME_S:g} s" for lag in LAGS))
"""Heading of the page's table."""


@dataclass(frozen=True)
class Pairs:
    """Counts of pairs of frames of one class in one log, by track and group (T, G).

    `all` pairs, of those whose `first` frame is seen, whose `then` frame is, and `both`.
    """

    all: Floats
    first: Floats
    then: Floats
    both: Floats

    def some(self, counts: Ints) -> Pairs:
        """Return the pairs of tracks that count so often (T,), as one track."""

        def drawn(table: Floats) -> Floats:
            return np.asarray(counts @ table)[None]

        return Pairs(drawn(self.all), drawn(self.first), drawn(self.then), drawn(self.both))

    @property
    def total(self) -> float:
        """Number of pairs."""
        return float(self.all.sum())


@dataclass(frozen=True)
class Linked:
    """Chances of both frames and the correlation (G,) of each group that has one, with pairs."""

    first: Floats
    then: Floats
    correlation: Floats
    pairs: Floats

    @classmethod
    def of(cls, pairs: Pairs) -> Linked:
        """Return those of pairs; groups that are always or never seen have none."""
        then = pairs.then.sum(axis=0)
        count = pairs.all.sum(axis=0)
        first = pairs.first.sum(axis=0)
        both = pairs.both.sum(axis=0)
        kept = (first > 0.0) & (then > 0.0) & (then < count)
        then = then[kept]
        count = count[kept]
        first = first[kept]
        both = both[kept]
        p = then / count
        return cls(first / count, p, (both / first - p) / (1.0 - p), count)

    def modelled(self, correlation: float) -> Floats:
        """Return the correlations (G,) by the model with a correlation of z."""
        chances = np.stack([self.first, self.then], axis=-1)
        lag = -math.log(correlation) if correlation > 0.0 else math.inf
        both = Confirmation(2).confirmed(chances, lag, window=2, time_s=1.0)[:, 1]
        return np.asarray((both / self.first - self.then) / (1.0 - self.then))


def pairs_of_class(log: Log, m: Floats, name: str, lag: int, n: int, groups: int) -> Pairs:
    """Return the pairs of boxes of a class that are `lag` frames apart, grouped by predicted m. A
    box is seen from n points on."""
    label = CLASSES.index(name)
    tracks = [t for t in tracks_of(log) if log.objects.labels[t[0]] == label and len(t) > lag]
    if not tracks:
        none = np.zeros((1, groups))
        return Pairs(none, none, none, none)
    first = np.concatenate([t[:-lag] for t in tracks])
    then = np.concatenate([t[lag:] for t in tracks])
    track = np.repeat(np.arange(len(tracks)), [len(t) - lag for t in tracks])
    group = np.empty(len(then), np.int64)
    order = np.argsort(m[then], kind="stable")
    for k, part in enumerate(np.array_split(order, groups)):
        group[part] = k
    seen = log.points >= n
    cell = track * groups + group
    shape = len(tracks), groups

    def counted(flags: Flags) -> Floats:
        table = np.bincount(cell[flags], minlength=math.prod(shape)).reshape(shape)
        return table.astype(float)

    every = np.ones(len(cell), bool)
    return Pairs(
        counted(every), counted(seen[first]), counted(seen[then]), counted(seen[first] & seen[then])
    )


Cells = dict[int, list[Pairs]]
"""Pairs of each class in each log, by lag."""


def mean(cells: Sequence[Pairs], value: Callable[[Linked], Floats]) -> float:
    """Return the mean of a value over all groups of some cells, by their pairs; NaN: no group."""
    linked = [Linked.of(pairs) for pairs in cells]
    weights = np.concatenate([own.pairs for own in linked])
    values = np.concatenate([value(own) for own in linked])
    return float(np.average(values, weights=weights)) if len(weights) else math.nan


def measured(cells: Sequence[Pairs]) -> float:
    """Return the correlation of all groups of some cells."""
    return mean(cells, lambda own: own.correlation)


def modelled(cells: Sequence[Pairs], correlation: float) -> float:
    """Return the same by the model with a correlation of z."""
    return mean(cells, lambda own: own.modelled(correlation))


def interval(cells: Sequence[Pairs]) -> list[float | None]:
    """Return the correlation of some cells with its 95 % interval, by bootstrap over tracks."""
    rng = np.random.default_rng(BOOTSTRAP.seed)
    values = []
    for _ in range(BOOTSTRAP.resamples):
        drawn = []
        for pairs in cells:
            count = len(pairs.all)
            drawn.append(pairs.some(np.bincount(rng.integers(0, count, count), minlength=count)))
        values.append(measured(drawn))
    low, high = np.nanpercentile(values, (2.5, 97.5))
    return [rounded(measured(cells)), rounded(low), rounded(high)]


def latent(time_s: float, lag: int, lasting: float = 0.0) -> float:
    """Return the correlation of z after a lag, with a share of the variance that is lasting."""
    return lasting + (1.0 - lasting) * math.exp(-lag * FRAME_S / time_s)


def fitted(cells: Cells) -> Json:
    """Return the correlation time [s] of cells, and the form of two numbers, by least squares."""
    lags = [lag for lag in JUDGED if cells[lag]]
    grid = np.round(np.arange(1, 200) * 0.005, 3)
    wanted = {lag: measured(cells[lag]) for lag in lags}
    by_latent = {lag: [modelled(cells[lag], float(rho)) for rho in grid] for lag in lags}
    weights = {lag: sum(pairs.total for pairs in cells[lag]) for lag in lags}

    def loss(time_s: float, lasting: float = 0.0) -> float:
        off = [
            weights[lag]
            * (np.interp(latent(time_s, lag, lasting), grid, values) - wanted[lag]) ** 2
            for lag, values in by_latent.items()
        ]
        return float(sum(off))

    time_s = float(min(TIMES_S, key=loss))
    pairs = [(float(t), float(c)) for t in TIMES_S for c in LASTING]
    two = min(pairs, key=lambda pair: loss(*pair))
    return {
        "time_s": time_s,
        "model": [rounded(modelled(cells[lag], latent(time_s, lag))) for lag in LAGS],
        "two": {"time_s": two[0], "lasting": two[1]},
        "model_of_two": [
            rounded(modelled(cells[lag], latent(two[0], lag, two[1]))) for lag in LAGS
        ],
    }


def row(cells: Cells) -> Json:
    """Return correlations by lag with intervals, what the model says of them, and its time."""
    counted = {"pairs": [int(sum(pairs.total for pairs in cells[lag])) for lag in LAGS]}
    by_lag = {"correlation": [interval(cells[lag]) for lag in LAGS]}
    return {**counted, **by_lag, **fitted(cells)}


def memory(logs: Sequence[tuple[Log, Floats]], n: int) -> Json:
    """Return the correlations of all logs together, and of each class in each log, by grouping."""
    found: Json = {}
    for grouping, groups in GROUPS.items():
        rows: Json = {}
        whole: Cells = {lag: [] for lag in LAGS}
        for log, m in logs:
            for name in OF_CLASSES:
                cells = {
                    lag: [pairs_of_class(log, m, name, lag, n=n, groups=groups)] for lag in LAGS
                }
                if min(cells[lag][0].total for lag in JUDGED) >= MIN_PAIRS:
                    rows[f"{log.name}, {name}"] = row(cells)
                    for lag in LAGS:
                        whole[lag] += cells[lag]
        found[grouping] = {"all": row(whole), **rows}
    return found


def table_rows(found: Json) -> list[list[str]]:
    """Return the rows of the page's table: all together by grouping, and each cell in thirds."""
    rows = []
    for grouping, by_cell in found.items():
        for name, own in by_cell.items():
            measured_values = [values[0] for values in own["correlation"]]
            texts = ["-" if value is None else f"{value:.2f}" for value in measured_values]
            if name == "all":
                time_s = f"{own['time_s']:.1f}"
                rows.append([f"**all, {grouping}**", time_s, *texts])
                ends = [f"{low:.2f} to {high:.2f}" for _, low, high in own["correlation"]]
                rows.append(["interval", "", *ends])
                rows.append(["model", "", *(f"{value:.2f}" for value in own["model"])])
                chain = [f"{measured_values[0] ** lag:.2f}" for lag in LAGS]
                rows.append(["one frame", "", *chain])
            elif grouping == next(iter(GROUPS)):
                log, _, of_class = name.partition(", ")
                rows.append([f"{log[:8]}, {of_class}", f"{own['time_s']:.1f}", *texts])
    return rows


def memory_statements(found: Json) -> list[list[str]]:
    """Return a row for each statement of the plan, by grouping: figures and verdict."""
    rows = []
    for grouping, by_cell in found.items():
        whole = by_cell["all"]
        values = np.array([own[0] for own in whole["correlation"]])[: len(JUDGED)]
        off = np.abs(np.array(whole["model"])[: len(JUDGED)] - values)
        chain = np.abs(values[0] ** np.array(JUDGED) - values)
        describes = bool(off.max() <= NEAR)
        said = f"at most {off.max():.2f} off"
        rows.append([f"10. One correlation time, {grouping}", said, _verdict(describes)])
        too_short = bool(chain[JUDGED.index(5) :].max() > NEAR)
        said = f"up to {chain.max():.2f} off"
        rows.append([f"11. One frame is too short, {grouping}", said, _verdict(too_short)])
    return rows


def _verdict(holds: bool) -> str:
    return "holds" if holds else "does not hold"
