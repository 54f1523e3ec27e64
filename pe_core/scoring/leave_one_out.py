"""The entropy of a sample without each sensor of a rig, in as many steps as there are sensors.

What the other groups add to 1 / sigma^2 is summed once forwards and once backwards over the groups,
as `metric.fusion.LeaveOneOut` does on planes of the grid: no subtraction, which would cost digits.
The floor rule for blind sensors and one frame are assumed (`adds_up`).
"""

from collections.abc import Iterator, Sequence

import numpy as np

from ..base.arrays import Floats
from ..geometry.bins import blocks
from ..metric.entropy import BLIND_PRECISION, entropy_of
from ..metric.fusion import Fusion, Measurement, group_sum, is_whole

VOXELS_AT_ONCE = 1 << 13
"""Voxels computed together: memory for them grows with the number of groups."""


def adds_up(fusion: Fusion) -> bool:
    """Whether what a group adds to 1 / sigma^2 does not depend on the other groups."""
    return fusion.model.blind == "floor" and fusion.model.frames is None


def mean_without_each(
    fusion: Fusion, groups: Sequence[Sequence[Measurement]], distance: Floats
) -> Floats:
    """Return the mean entropy (S,) of voxels without each sensor of the groups, in order [nats].

    `groups` are the measurements (V,) of the sensors of each fusion group, without range terms;
    `distance` (V,) is that of the voxels from the origin [m].
    """
    sums = np.zeros(sum(map(len, groups)))
    for voxels in blocks(len(distance), VOXELS_AT_ONCE):
        part = [[(kind, m[voxels]) for kind, m in group] for group in groups]
        sums += [entropies.sum() for entropies in _without_each(fusion, part, distance[voxels])]
    return sums / len(distance)


def _without_each(
    fusion: Fusion, groups: Sequence[Sequence[Measurement]], distance: Floats
) -> Iterator[Floats]:
    """Yield the entropy (N,) of voxels without each sensor."""

    def added(measurement: Measurement) -> Floats:
        ((kind, m),) = fusion.ranged([measurement], distance)
        return fusion.precision(m, kind) - BLIND_PRECISION

    totals = [(group[0][0], group_sum([m for _, m in group])) for group in groups]
    others = _sums_of_others([added(total) for total in totals])
    for group, total, of_others in zip(groups, totals, others, strict=True):
        precision = of_others + BLIND_PRECISION
        for rank in range(len(group)):
            rest = [] if len(group) == 1 else [added(_rest(group, total, rank))]
            yield entropy_of(sum(rest, precision))


def _rest(group: Sequence[Measurement], total: Measurement, rank: int) -> Measurement:
    """Return the sum of a group's sensors but one: of whole numbers, the exact difference."""
    kind, m = group[rank]
    if is_whole(total[1]):
        return kind, total[1] - m
    return kind, group_sum([other for j, (_, other) in enumerate(group) if j != rank])


def _sums_of_others(added: Sequence[Floats]) -> list[Floats]:
    """Return for each array the sum of all others."""
    others = []
    so_far = np.zeros_like(added[0])
    for one in added:
        others.append(so_far.copy())
        so_far += one
    so_far = np.zeros_like(added[0])
    for before, one in zip(reversed(others), reversed(added), strict=True):
        before += so_far
        so_far += one
    return others
