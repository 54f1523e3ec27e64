"""Tracks: when an object is confirmed, and for how long a confirmed one is lost (docs/time.md).

A detector finds the object at frame k with probability p_k, and a track is confirmed when M of the
last N frames found it. Frames depend on each other by the object's hidden rank (`detector_rank`).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Flags, Floats
from ..base.setting import Panel, check_settings, setting
from ..base.values import Whole
from .detector_rank import rank_chain

WINDOW = 5
"""N of M of N: half a second at 10 Hz (Blackman and Popoli, 1999)."""
CORRELATION_TIME_S = 2.5
"""How long a body stays as hard to find as it is. Measured in real traffic: 2.4 s
(docs/validity/tracks)."""
KEPT = 0.5
"""A track is lost at frames at which M of the last N frames find it with a lower probability."""


@dataclass(frozen=True, slots=True)
class Confirmation:
    """M of N: a track is confirmed when `needed` of the last frames found the object.

    How many frames are the last ones, `window`, and how long they depend on each other, `time_s`
    (0: they do not), are given to its methods.
    """

    needed: int = setting(
        3,
        Whole(1, WINDOW),
        f"Frames of the last {WINDOW} that confirm a track",
        Panel("track_needed", f"Confirmed by (of {WINDOW})"),
    )

    def __post_init__(self) -> None:
        check_settings(self, "time")

    def confirmed(
        self,
        found: ArrayLike,
        frame_s: float,
        window: int = WINDOW,
        time_s: float = CORRELATION_TIME_S,
    ) -> Floats:
        """Return the probability (..., K) that the track is confirmed by each frame.

        `found` (..., K) is the probability that each frame finds the object, `frame_s` the time
        between two frames [s].
        """
        return self._reached(np.asarray(found, dtype=float), frame_s, window, time_s, for_good=True)

    def kept(
        self,
        found: ArrayLike,
        frame_s: float,
        window: int = WINDOW,
        time_s: float = CORRELATION_TIME_S,
    ) -> Floats:
        """Return the probability (..., K) that M of the last N frames find it, frame by frame."""
        return self._reached(
            np.asarray(found, dtype=float), frame_s, window, time_s, for_good=False
        )

    def _reached(
        self, found: Floats, frame_s: float, window: int, time_s: float, *, for_good: bool
    ) -> Floats:
        """Return the probability (..., K) of M of N, now or (for good) by now. The state is the
        outcome of the last N frames, a bit each, the last one lowest, and the bin of the rank."""
        chain = rank_chain()
        step = chain.step(frame_s / time_s if time_s else math.inf)
        masks = np.arange(1 << window)
        enough = np.array([mask.bit_count() >= self.needed for mask in masks.tolist()])
        after = (masks << 1) & (len(masks) - 1)
        half = len(masks) // 2  # two states, with and without the oldest bit, lead to each
        state = np.zeros((*found.shape[:-1], len(masks), len(chain.shares)))
        state[..., 0, :] = chain.shares
        reached = np.zeros(found.shape)
        done = np.zeros(found.shape[:-1])
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
