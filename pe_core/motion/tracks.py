"""Tracks: when an object is confirmed, and for how long a confirmed one is lost (docs/time.md).

A detector finds the object at frame k with probability p_k, and a track is confirmed when M of the
last N frames found it. Frames depend on each other by the object's hidden rank (`detector_rank`).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Flags, Floats
from ..base.errors import InputError
from ..base.setting import Panel, check_settings, setting
from ..base.values import Number, Whole
from .detector_rank import rank_chain
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
    correlation_time_s: float = setting(
        2.5,
        Number(0.0, 1000.0, unit="s"),
        "Correlation time of how hard a body is to find; 0: frames are independent. Measured in "
        "real traffic: 2.4 s (docs/validity/tracks)",
        Panel("track_correlation_time_s", "Correlation Time (s)", soft_max=10.0),
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
        Number(0.01, 10.0, unit="m"),
        "Standard deviation of a box's place without latency",
        Panel("box_scatter_m", "Scatter of Boxes"),
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

    def confirmed(self, found: ArrayLike, frame_s: float) -> Floats:
        """Return the probability (..., K) that the track is confirmed by each frame.

        `found` (..., K) is the probability that each frame finds the object, `frame_s` the time
        between two frames [s].
        """
        return self._reached(np.asarray(found, dtype=float), frame_s, for_good=True)

    def kept(self, found: ArrayLike, frame_s: float) -> Floats:
        """Return the probability (..., K) that M of the last N frames find it, frame by frame."""
        return self._reached(np.asarray(found, dtype=float), frame_s, for_good=False)

    def _reached(self, found: Floats, frame_s: float, for_good: bool) -> Floats:
        """Return the probability (..., K) of M of N, now or (for good) by now. The state is the
        outcome of the last N frames, a bit each, the last one lowest, and the bin of the rank."""
        chain = rank_chain()
        time_s = self.correlation_time_s
        step = chain.step(frame_s / time_s if time_s else math.inf)
        masks = np.arange(1 << self.window)
        enough = np.array([mask.bit_count() >= self.needed for mask in masks.tolist()])
        after = (masks << 1) & (len(masks) - 1)
        half = len(masks) // 2  # two states, with and without the oldest bit, lead to each
        state = np.zeros((*found.shape[:-1], len(masks), len(chain.shares)))
        state[..., 0, :] = chain.shares
        reached, done = np.zeros(found.shape), np.zeros(found.shape[:-1])
        for k in range(found.shape[-1]):
            hit = state * chain.found(found[..., k])[..., None, :]
            moved = np.zeros_like(state)
            for outcome, share in ((0, state - hit), (1, hit)):
                moved[..., after[:half] | outcome, :] = share[..., :half, :] + share[..., half:, :]
            reached[..., k] = done + moved[..., enough, :].sum(axis=(-2, -1))
            if for_good:
                done = reached[..., k]
                moved[..., enough, :] = 0.0
            state = moved @ step
        return np.minimum(reached, 1.0)


def longest_run(flags: Flags) -> int:
    """Return the length of the longest run of flags (K,) that are set."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return int((edges[1::2] - edges[::2]).max(initial=0))


def first_frame(confirmed: Floats, chance: float) -> int | None:
    """Return the first frame by which a track is confirmed with a probability; None: never."""
    frames = np.flatnonzero(confirmed >= chance)
    return int(frames[0]) if len(frames) else None
