"""Tracks of a log, when they are seen and confirmed, and what is compared of two series."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pe_core.base import Flags, Floats, Ints

from ..results_file import Json
from ..road.logs import CLASSES, Log
from ..road.models import RINGS_M
from ..road.statistics import HOLDS, OPEN, REFUTED, Bootstrap, rank_correlation, rounded

FRAME_S = 0.1
POINTS = (1, 5, 20)
NEEDED = 3
WINDOW = 5
UNSEEN = 5
"""First frames at which a track that counts is not seen."""
NEAR_S = 0.5
MIN_TRACKS = 10
BOOTSTRAP = Bootstrap(20261127)
OF_BOTH: dict[str, tuple[str, Callable[[Floats], float]]] = {
    "first_s": ("first", lambda late: float(np.median(late))),
    "confirmed_s": ("confirmed", lambda late: float(np.median(late))),
    "error_s": ("confirmed", lambda late: float(np.median(np.abs(late)))),
    "near": ("confirmed", lambda late: float(np.mean(np.abs(late) <= NEAR_S + 1e-9))),
}
"""Figures of predicted minus real times [s]: medians, of the absolute ones, share within 0.5 s."""


def tracks_of(log: Log) -> list[Ints]:
    """Return the boxes of each track in their order; a frame without a box ends a track."""
    scenes = log.objects.scenes
    order = np.lexsort((scenes, log.tracks))
    new = (np.diff(log.tracks[order]) != 0) | (np.diff(scenes[order]) != 1)
    return np.split(order, np.flatnonzero(new) + 1)


def threshold(n: int) -> float:
    """Return the predicted points from which a box is seen with n points: 0.5 for one."""
    return 0.5 if n == 1 else float(n)


@dataclass(frozen=True)
class Moments:
    """Frames of a track's first sight and confirmation (None: never), and its longest loss [s]."""

    first: int | None
    confirmed: int | None
    lost_s: float

    @classmethod
    def of(cls, seen: Flags) -> Moments:
        """Return those of the frames at which a track is seen (K,)."""
        frames = np.flatnonzero(seen)
        if not len(frames):
            return cls(None, None, 0.0)
        total = np.cumsum(np.pad(seen.astype(int), (WINDOW, 0)))
        enough = np.flatnonzero(total[WINDOW:] - total[:-WINDOW] >= NEEDED)
        if not len(enough):
            return cls(int(frames[0]), None, 0.0)
        after = frames[frames >= enough[0]]
        gaps = np.diff(np.concatenate([[enough[0]], after]))
        return cls(int(frames[0]), int(enough[0]), float(max(gaps.max(initial=1) - 1, 0) * FRAME_S))


@dataclass(frozen=True)
class Pair:
    """A track that is unseen at first: what counted and predicted points say of it."""

    name: str
    ring: int
    real: Moments
    said: Moments

    def late(self, what: str) -> float | None:
        """Return predicted minus real time of "first" or "confirmed" [s]; None: one is never."""
        a = getattr(self.real, what)
        b = getattr(self.said, what)
        return None if a is None or b is None else (b - a) * FRAME_S


def pairs_of(log: Log, m: Floats, n: int) -> list[Pair]:
    """Return the tracks of a log that are unseen at first, counted and predicted."""
    pairs = []
    for boxes in tracks_of(log):
        real = log.points[boxes] >= n
        said = m[boxes] >= threshold(n)
        if len(boxes) <= UNSEEN or real[:UNSEEN].any() or said[:UNSEEN].any():
            continue
        moments = Moments.of(real), Moments.of(said)
        at = moments[0].first if moments[0].first is not None else -1
        ring = int(np.digitize(log.distance[boxes[at]], RINGS_M)) - 1
        pairs.append(Pair(CLASSES[log.objects.labels[boxes[0]]], ring, *moments))
    return pairs


def interval(
    pairs: Sequence[Pair], figure: Callable[[Sequence[Pair]], float]
) -> list[float | None]:
    """Return the value of a figure and its 95 % interval, by bootstrap over the tracks."""
    rng = np.random.default_rng(BOOTSTRAP.seed)
    draws = rng.integers(0, len(pairs), (BOOTSTRAP.resamples, len(pairs)))
    values = [figure([pairs[k] for k in draw]) for draw in draws]
    low, high = np.nanpercentile(values, (2.5, 97.5))
    return [rounded(figure(pairs)), rounded(low), rounded(high)]


def missed(pairs: Sequence[Pair]) -> float:
    """Return the share of tracks that the counted points confirm and the predicted do not."""
    flags = [p.said.confirmed is None for p in pairs if p.real.confirmed is not None]
    return float(np.mean(flags)) if flags else np.nan


def invented(pairs: Sequence[Pair]) -> float:
    """Return the share of tracks that the predicted points confirm and the counted do not."""
    return float(
        np.mean([p.said.confirmed is not None and p.real.confirmed is None for p in pairs])
    )


def compared(pairs: Sequence[Pair]) -> Json:
    """Return the figures of some tracks; None with too few of them."""
    both = [p for p in pairs if p.late("confirmed") is not None]
    head = {"tracks": len(pairs), "both": len(both)}
    if len(both) < MIN_TRACKS:
        return head

    def of(what: str, figure: Callable[[Floats], float]) -> Callable[[Sequence[Pair]], float]:
        return lambda some: figure(np.array([p.late(what) for p in some], float))

    lost = [np.array([getattr(p, who).lost_s for p in both]) for who in ("real", "said")]
    return {
        **head,
        **{name: interval(both, of(*figure)) for name, figure in OF_BOTH.items()},
        "missed": interval(pairs, missed),
        "invented": interval(pairs, invented),
        "lost_rho": rounded(rank_correlation(*lost)),
    }


def by_class_and_ring(pairs: Sequence[Pair]) -> Json:
    """Return the figures of all, of cars and pedestrians, of each class, and of its rings."""
    found: Json = {"all": compared(pairs)}
    found["car and pedestrian"] = compared([p for p in pairs if p.name in ("car", "pedestrian")])
    for name in CLASSES[:-1]:
        own = [p for p in pairs if p.name == name]
        if own:
            found[name] = compared(own)
            for ring in range(len(RINGS_M) - 1):
                cell = compared([p for p in own if p.ring == ring])
                if "near" in cell:
                    found[f"{name}, {RINGS_M[ring]:g} to {RINGS_M[ring + 1]:g} m"] = cell
    return found


def persistence(log: Log, m: Floats, n: int) -> Mapping[str, Json]:
    """Return how a box seen depends on the one before, by class: in thirds of the predicted m.

    ``ratio`` is P(seen | seen before) / P(seen); ``correlation`` (P(seen | seen before) - P) / (1 -
    P), the mean over thirds, by their boxes.
    """
    tracks = tracks_of(log)
    first, then = (np.concatenate([t[cut] for t in tracks]) for cut in (slice(-1), slice(1, None)))
    seen = log.points >= n
    labels = log.objects.labels
    found: dict[str, Json] = {}
    for k, name in enumerate(CLASSES[:-1]):
        own = np.flatnonzero(labels[then] == k)
        if len(own) < 300:
            continue
        rows = []
        for third in np.array_split(own[np.argsort(m[then[own]], kind="stable")], 3):
            p = float(seen[then[third]].mean())
            given = seen[first[third]]
            if 0.0 < p < 1.0 and given.any():
                again = float(seen[then[third]][given].mean())
                rows.append((len(third), again / p, (again - p) / (1.0 - p)))
        if rows:
            size, ratio, linked = np.array(rows).T
            found[name] = {
                "ratio": rounded(np.average(ratio, weights=size)),
                "correlation": rounded(np.average(linked, weights=size)),
                "boxes": int(size.sum()),
            }
    return found


def verdict(values: list[float] | None, low: float, high: float) -> str:
    """Return what an interval says of a goal."""
    if values is None:
        return OPEN
    _, least, most = values
    if least >= low and most <= high:
        return HOLDS
    return REFUTED if most < low or least > high else OPEN
