"""How far the entropy of a search's start and end moves: mounted off, or with a sensor lost."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ..scene.sensors import Rig
from ..scoring import RigJudge
from ..scoring.score import rounded
from ..text.degrees import degrees_in_file
from .tolerance import FRESH, Tolerance, mounted_off, without_each

WORKSHOP = Tolerance(0.01, math.radians(0.3), draws=6)
"""The errors of a careful workshop: these are looked at where a study names none."""


@dataclass(frozen=True, slots=True)
class Stands:
    """What becomes of one placement's entropy; all on one sample of voxels [nats].

    Attributes
    ----------
    entropy : float
        As it stands.
    mounted_off, mounted_worst : float
        Mean over the mounting errors, and the worst of them.
    stderr : float
        Standard error of `mounted_off`, from the scatter of the draws; it errs high.
    failed, failed_worst : float or None
        Mean over the loss of each one sensor, and the worst; None of a single sensor.
    missed : str or None
        The sensor whose loss is the worst.
    """

    entropy: float
    mounted_off: float
    mounted_worst: float
    stderr: float
    failed: float | None = None
    failed_worst: float | None = None
    missed: str | None = None

    @property
    def rise(self) -> float:
        """What mounting errors cost on average [nats]."""
        return rounded(self.mounted_off - self.entropy)

    @property
    def loss(self) -> float | None:
        """What the loss of one sensor costs on average [nats]; None of a single sensor."""
        return None if self.failed is None else rounded(self.failed - self.entropy)


@dataclass(frozen=True, slots=True)
class Robustness:
    """Start and end of a search, mounted off and with a sensor lost.

    Attributes
    ----------
    errors : Tolerance
        The mounting errors: the study's, or `WORKSHOP`. The search has not seen these draws.
    samples : int
        Voxels that it was told on.
    before, after : Stands
    """

    errors: Tolerance
    samples: int
    before: Stands
    after: Stands

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {
            "position": self.errors.position,
            "angle": degrees_in_file(self.errors.angle),
            "draws": self.errors.draws,
            "samples": self.samples,
            "before": asdict(self.before),
            "after": asdict(self.after),
        }


def robustness(
    evaluator: RigJudge, before: Rig, after: Rig, tolerance: Tolerance, seed: int = 0
) -> Robustness:
    """Tell how far the entropy of two placements moves.

    Parameters
    ----------
    evaluator : RigJudge
        On a sample: every sensor is measured once for each draw.
    before, after : Rig
    tolerance : Tolerance
        Its mounting errors are looked at where it has some.
    seed : int
        Of the study; the errors are others than a search's of this seed.
    """
    errors = replace(tolerance if tolerance.mounts_off else WORKSHOP, failures=False, worst=False)
    first = _stands(evaluator, before, errors, seed)
    last = first if after is before else _stands(evaluator, after, errors, seed)
    return Robustness(errors, evaluator.samples, first, last)


def _stands(evaluator: RigJudge, rig: Rig, errors: Tolerance, seed: int) -> Stands:
    off = evaluator.entropies(mounted_off(rig, errors, seed, FRESH))
    lost = without_each(rig) if len(rig) > 1 else []
    entropy, *failed = evaluator.entropies([rig, *lost])
    about_errors = (
        rounded(float(np.mean(off))),
        max(off),
        _standard_error(off, errors.draws, len(rig)),
    )
    if not failed:
        return Stands(entropy, *about_errors)
    missed = rig.sensors[int(np.argmax(failed))].name
    return Stands(entropy, *about_errors, rounded(float(np.mean(failed))), max(failed), missed)


def _standard_error(entropies: Sequence[float], draws: int, sensors: int) -> float:
    """From the scatter of each sensor's draws, each with that of opposite signs."""
    half, variance = draws // 2, 0.0
    if half < 2:
        return 0.0
    ways = np.array(entropies).reshape(-1, draws)
    for place in range(sensors):
        by_draw = np.mean([np.roll(own, way * place) for way, own in enumerate(ways)], axis=0)
        variance += float(np.var(by_draw.reshape(2, half).mean(axis=0), ddof=1)) / half
    return rounded(math.sqrt(variance))
