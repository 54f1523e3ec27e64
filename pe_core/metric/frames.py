"""Information over frames: what a static object's frames tell together (docs/time.md).

With lambda = 1 / sigma^2 of an object, f that of a blind sensor, and q the process noise of its
class [1/s], between two frames that are dt apart the variance grows by q dt (`predicted`, eq. T1);
each fusion group that has a frame adds its own information (`updated`, eq. T2)::

    lambda_k = max(1 / (1 / lambda_(k-1) + q dt), f) + sum over groups of (1 / sigma_s,k^2 - f)

H follows from lambda by eq. 8. One frame, or q = inf, is eq. 7 to the bit: so the paper's entropy.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats, ReadOnlyDict
from ..base.setting import Panel, check_settings, setting
from ..base.values import Number, Whole
from .entropy import BLIND_PRECISION, CurveOf, OwnCurve

RATE = Number(0.1, 1000.0, unit="Hz")
NOISE = Number(0.0, noun="process noise", infinite=True)
RATE_HZ = 10.0
"""Frames in a second of a kind of sensor without a rate of its own: most LiDARs'."""
SAME_TIME = 1e-9
"""Frames of two groups that are less apart [s] are at one time."""


def predicted(precision: ArrayLike, noise: float, floor: float = BLIND_PRECISION) -> Floats:
    """Return 1 / sigma^2 before the next frame, eq. T1; `noise` is q dt. Never below the floor."""
    with np.errstate(divide="ignore"):
        variance = 1.0 / np.asarray(precision, dtype=float) + noise
    return np.maximum(1.0 / variance, floor)


def updated(prior: Floats | float, added: Iterable[ArrayLike]) -> Floats:
    """Return 1 / sigma^2 after a frame, eq. T2: what each group adds, and the prior."""
    total = sum((np.asarray(a, dtype=float) for a in added), np.float64(0.0))
    return np.asarray(total + prior, dtype=float)


@dataclass(frozen=True, slots=True)
class Frames:
    """Frames that an entropy is of, the process noise between them, and the rates of sensors.

    `InputError` when a number is out of its range.

    `frames`: Of the slowest sensor; the others have as many as fit between. The last is of all at
        once.
    `q`: Process noise of a class that has none of its own [1/s]; inf: only the last frame counts.
    `noises, rates`: Process noise by class [1/s], rates by kind of sensor [Hz].
    """

    frames: int = setting(
        1,
        Whole(1, 1000),
        "Frames of the entropy over frames; 1: off",
        Panel("time_frames", "Frames", soft_max=20),
    )
    q: float = setting(
        1.0, NOISE, "Process noise of a class [1/s]", Panel("time_q", "Process Noise")
    )
    noises: Mapping[str, float] = field(default_factory=dict)
    rates: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_settings(self, "time")
        for name, rule in (("noises", NOISE), ("rates", RATE)):
            given = getattr(self, name)
            checked = {key: rule.checked(f"time.{name}", key, given[key]) for key in given}
            object.__setattr__(self, name, ReadOnlyDict(checked))

    def of_class(self, name: str) -> "Frames":
        """Return the same with the noise of one class as that of all."""
        return replace(self, q=self.noises.get(name, self.q), noises={})

    def rate(self, kind: CurveOf) -> float:
        """Return the rate of a kind [Hz], also of a sensor with an AP curve of its own."""
        name = kind.kind if isinstance(kind, OwnCurve) else kind
        return self.rates.get(name, RATE_HZ)

    def times(self, rates: Sequence[float]) -> list[tuple[float, list[int]]]:
        """Return the times of frames up to the last one at 0 [s], with the groups that have one."""
        start = -(self.frames - 1) / min(rates)
        ticks = sorted(
            (-k / rate, group)
            for group, rate in enumerate(rates)
            for k in range(int((SAME_TIME - start) * rate) + 1)
        )
        times: list[tuple[float, list[int]]] = []
        for at, group in ticks:
            if times and at - times[-1][0] < SAME_TIME:
                times[-1][1].append(group)
            else:
                times.append((at, [group]))
        return times

    def fused(self, kinds: Sequence[CurveOf], added: Sequence[ArrayLike], floor: float) -> Floats:
        """Return 1 / sigma^2 after the last frame, when each group adds the same at each frame.
        `added` is what each group adds to the floor: 1 / sigma^2 - f, arrays of one shape."""
        precision = np.asarray(floor)
        last = None
        for at, groups in self.times([self.rate(kind) for kind in kinds]):
            prior = floor if last is None else predicted(precision, self.q * (at - last), floor)
            precision = updated(prior, [added[k] for k in sorted(groups)])
            last = at
        return precision
