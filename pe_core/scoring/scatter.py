"""How the figures of a sampled score scatter: what the error of a difference is made of.

The errors of two scores on one sample are correlated: if the sample has too many far voxels, both
entropies are too high. Their difference is far more precise than either of them. A score therefore
stores the residuals of its means in a few batches of the sample. Residuals of two scores on the
same sample are subtracted by batch (paired); on different samples, their squares are added.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.values import DECIMALS, rounded

FigureKey = tuple[str, str, str]
"""Group ("rig", "zone", "class"), name (empty for the rig), and measure ("entropy", ...)."""


ALIKE = 10.0**-DECIMALS
"""Entropies no farther apart than this do not differ [nats]."""
RULE_OF_THREE = 3.0
"""Rule of three: if n draws are equal, at most 3 / n of all others differ, with 95 % certainty."""


@dataclass(frozen=True, slots=True)
class Scatter:
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
        return None if by_batch is None else _standard_error(by_batch)

    def to_dict(self) -> dict[str, Any]:
        """Return the residuals as plain JSON data."""
        rows = [[*figure, list(by_batch)] for figure, by_batch in self.residuals.items()]
        return {"sample": self.sample, "residuals": rows}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Scatter:
        """Return the `Scatter` from the data of `to_dict`."""
        rows = {
            (group, name, measure): tuple(sums) for group, name, measure, sums in data["residuals"]
        }
        return cls(data["sample"], rows)


def paired_error(one: Scatter | None, other: Scatter | None, figure: FigureKey) -> float | None:
    """Return the standard error of the difference of a figure of two scores on the same sample.

    None where they are of different samples, or one lacks the figure: their errors are then
    independent.
    """
    if one is None or other is None or one.sample != other.sample:
        return None
    a, b = one.residuals.get(figure), other.residuals.get(figure)
    if a is None or b is None or len(a) != len(b):
        return None
    return _standard_error([x - y for x, y in zip(a, b, strict=True)])


def residuals(
    values: Floats, weights: Floats | None, batch: NDArray[np.int64], batches: int
) -> tuple[float, ...]:
    """Return the residuals by batch (R,) of a mean of values (N,); see `Scatter`.

    `weights` None: equal ones. `batch` (N,) numbers the batch of each value.
    """
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


def _standard_error(batches: Iterable[float]) -> float:
    """Return the standard error of a mean from its residuals in independent batches."""
    values = list(batches)
    square = math.fsum(value * value for value in values)
    return rounded(math.sqrt(square * len(values) / max(len(values) - 1, 1)))
