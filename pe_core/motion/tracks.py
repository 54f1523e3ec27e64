"""Tracks: when an object is confirmed, and for how long a confirmed one is lost (docs/time.md).

A detector finds the object at frame k with probability p_k, and a track is confirmed when M of the
last N frames found it. A frame is not independent of the one before: with a correlation r it finds
the object with probability ``p_k + r (1 - p_k)`` after a frame that did, and ``p_k (1 - r)`` after
one that did not; never where p_k is 0: nothing sees it. At a steady p it is p on average. r = 0 is
independence; r = 1 is one chance for all frames.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.errors import InputError
from ..base.setting import Panel, check_settings, setting
from ..base.values import SHARE, Number, Whole
from .scan import ap_with_latency

MAX_WINDOW = 8
KEPT = 0.5
"""A track is lost at frames at which M of the last N frames find it with a lower probability."""


@dataclass(frozen=True, slots=True)
class Confirmation:
    """M of N: a track is confirmed when `needed` of the last `window` frames found the object."""

    needed: int = setting(
        3,
        Whole(1, MAX_WINDOW),
        "Frames that confirm a track",
        Panel("track_needed", "Confirmed by"),
    )
    window: int = setting(
        5,
        Whole(1, MAX_WINDOW),
        "Frames among which they have to be",
        Panel("track_window", "Of the Last"),
    )
    correlation: float = setting(
        0.8,
        SHARE,
        "Correlation of neighbouring frames; 0: independent. Measured in real traffic: 0.7 to 0.8",
        Panel("track_correlation", "Correlation"),
    )
    box_latency_s: float = setting(
        0.0,
        Number(0.0, 10.0, unit="s"),
        "How late boxes are when they are used",
        Panel("box_latency_s", "Boxes Late By (s)", soft_max=1.0),
    )
    box_spread_s: float = setting(
        0.0,
        Number(0.0, 10.0, unit="s"),
        "Standard deviation of that time",
        Panel("box_spread_s", "± (s)", soft_max=1.0),
    )
    box_scatter_m: float = setting(
        0.5,
        Number(0.0, 10.0, above=True, unit="m"),
        "Standard deviation of a box's place without latency",
        Panel("box_scatter_m", "Scatter of Boxes", min=0.01),
    )

    def __post_init__(self) -> None:
        check_settings(self, "time")
        if self.needed > self.window:
            raise InputError("time", "needed", f"at most window, {self.window}", self.needed)

    def in_time(self, ap: Floats, speed: Floats) -> Floats:
        """Return AP of bodies of a speed [m/s] when boxes are late, eq. T5."""
        if not (self.box_latency_s or self.box_spread_s):
            return ap
        return ap_with_latency(ap, speed, self.box_latency_s, self.box_spread_s, self.box_scatter_m)

    def confirmed(self, found: ArrayLike) -> Floats:
        """Return the probability (..., K) that the track is confirmed by each frame. `found` (...,
        K) is the probability that each frame finds the object. Exact."""
        return self._reached(np.asarray(found, dtype=float), for_good=True)

    def kept(self, found: ArrayLike) -> Floats:
        """Return the probability (..., K) that M of the last N frames find it, frame by frame."""
        return self._reached(np.asarray(found, dtype=float), for_good=False)

    def _reached(self, found: Floats, for_good: bool) -> Floats:
        """Return the probability (..., K) of M of N, now or (for good) by now. The state is the
        outcome of the last N frames, a bit each, the last one lowest."""
        masks = np.arange(1 << self.window)
        enough = np.array([mask.bit_count() >= self.needed for mask in masks.tolist()])
        after = (masks << 1) & (len(masks) - 1)
        state = np.zeros((*found.shape[:-1], len(masks)))
        state[..., 0] = 1.0
        reached, done = np.zeros(found.shape), np.zeros(found.shape[:-1])
        for k in range(found.shape[-1]):
            p = found[..., k, None]
            r = self.correlation * (p > 0.0) if k else 0.0
            hit = state * np.where(masks & 1, p + r * (1.0 - p), p * (1.0 - r))
            moved = np.zeros_like(state)
            half = len(masks) // 2  # two states, with and without the oldest bit, lead to each
            for outcome, share in ((0, state - hit), (1, hit)):
                moved[..., after[:half] | outcome] = share[..., :half] + share[..., half:]
            reached[..., k] = done + moved[..., enough].sum(axis=-1)
            if for_good:
                done = reached[..., k]
                moved[..., enough] = 0.0
            state = moved
        return reached

    def longest_loss(self, found: Floats, first: int) -> int:
        """Return the longest run of frames after `first` at which the track is lost."""
        longest = run = 0
        for lost in (self.kept(found)[first:] < KEPT).tolist():
            run = run + 1 if lost else 0
            longest = max(longest, run)
        return longest


def first_frame(confirmed: Floats, chance: float) -> int | None:
    """Return the first frame by which a track is confirmed with a probability; None: never."""
    frames = np.flatnonzero(confirmed >= chance)
    return int(frames[0]) if len(frames) else None
