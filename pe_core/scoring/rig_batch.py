"""RigBatch: several rigs that are scored together, and the parts of one rig.

A sensor that several rigs have at the same pose is measured once. The parts of a rig are each
sensor alone, and the rig without each sensor.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError
from ..base.values import rounded
from ..geometry.poses import Pose
from ..metric.entropy import CurveOf
from ..metric.fusion import group_sum
from ..scene.rig import Rig, Sensor, SensorModel

Members = tuple[str, ...]


class RigBatch:
    """Rigs of the same sensors, in the same or other poses; sensors may be missing.

    Sensors of one name and pose in several rigs are one sensor. `parts` are the rigs, with new
    names for the sensors: a number for each sensor and pose. `all` is a rig of every sensor of the
    parts once. The names are the same in every call with rigs in the same order, so that
    measurements can be cached by name. Without a rig: `InputError`.
    """

    def __init__(self, rigs: Sequence[Rig]) -> None:
        if not rigs:
            raise InputError("evaluator", "rigs", "at least one rig", "none")
        by_pose: dict[tuple[str, Pose, SensorModel], Sensor] = {}
        counts: dict[str, int] = {}  # poses by sensor

        def numbered(sensor: Sensor) -> Sensor:
            key = sensor.name, sensor.pose, sensor.model
            if key not in by_pose:
                pose = counts.get(sensor.name, 0)
                counts[sensor.name] = pose + 1
                name = f"{list(counts).index(sensor.name)}.{pose}"
                by_pose[key] = replace(sensor, name=name, fusion=sensor.group)
            return by_pose[key]

        self.parts = tuple(Rig([numbered(sensor) for sensor in rig]) for rig in rigs)
        self.all = Rig(list(by_pose.values()))


def mean_or_worst(entropies: Sequence[float], worst: bool) -> float:
    """Return the mean of several entropies, or the highest [nats]."""
    return max(entropies) if worst else rounded(float(np.mean(entropies)))


def parts_of(rig: Rig) -> list[Members]:
    """Return the names in the rig, in each sensor alone, in the rig without each; no repeats."""
    names = tuple(s.name for s in rig)
    if len(names) == 1:
        return [names]
    alone = [(name,) for name in names]
    without = [tuple(n for n in names if n != name) for name in names]
    return [names, *dict.fromkeys([*alone, *without])]


def fused_early(
    rig: Rig, measured: Mapping[str, Any], members: Collection[str]
) -> list[tuple[CurveOf, Any]]:
    """Sum the members' measurements inside each fusion group, eq. 6: (AP curve, sum) of each."""
    groups = []
    for sensors in rig.groups.values():
        present = [measured[s.name] for s in sensors if s.name in members]
        if present:
            groups.append((sensors[0].detector, group_sum(present)))
    return groups


def members_of(rig: Rig, measured: Mapping[str, Any]) -> list[list[tuple[CurveOf, Any]]]:
    """Return (AP curve, measurement) of each sensor of each fusion group."""
    return [[(s.detector, measured[s.name]) for s in group] for group in rig.groups.values()]


def parts_by_sums(
    rig: Rig, whole: float, blind: float, by_sensor: NDArray[np.float64]
) -> dict[Members, NDArray[np.float64]]:
    """Return weighted entropy and coverage (2, 1) of each sensor alone and the rig without it.
    `whole` and `blind` are the weighted entropies of the rig and of no sensor; `by_sensor` (3, S)
    holds the sums of `LeaveOneOut`. Coverage is computed for single sensors only, else 0."""
    names = tuple(s.name for s in rig)
    order = [s.name for sensors in rig.groups.values() for s in sensors]
    lost, gained, coverage = (dict(zip(order, values, strict=True)) for values in by_sensor)
    without = {tuple(n for n in names if n != name): [whole + lost[name], 0.0] for name in names}
    alone = {(name,): [blind + gained[name], coverage[name]] for name in names}
    return {part: np.array(sums)[:, None] for part, sums in (without | alone).items()}
