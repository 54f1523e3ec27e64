"""Read a sensitivity analysis back from result.json."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pe_core.geometry.poses import Pose
from pe_core.scene.rig import Rig
from pe_core.study.study import EXPECTED_AP

from .analysis import Sensitivity
from .constraints import ActiveConstraint
from .flatness import AxisCost, PoseStep
from .fresh_samples import STEEP_AP, STEEP_NATS, Difference
from .optima import Endings, RunnerUp


def sensitivity_from_dict(table: Mapping[str, Any] | None, rig: Rig) -> Sensitivity | None:
    """Return the analysis that `Sensitivity.to_dict` wrote; None for None.

    Runners-up are of the rig's sensors, at other poses. `KeyError`, `TypeError` or `ValueError`
    when the table is no such analysis.
    """
    if table is None:
        return None
    by_ap = table.get("objective") == EXPECTED_AP
    steep = STEEP_AP if by_ap else STEEP_NATS
    axes, constraints = list[AxisCost](), list[ActiveConstraint]()
    for row in table["axes"]:
        cost = {float(step): Difference(*map(float, pair)) for step, pair in row["cost"].items()}
        names = str(row["sensor"]), str(row["axis"]), str(row["status"])
        axes.append(AxisCost(*names, cost, steep))
    for row in table["constraints"]:
        step = PoseStep(str(row["sensor"]), str(row["axis"]), float(row["step"]))
        gain = Difference(-float(row["gain"]), float(row["stderr"]))
        constraints.append(ActiveConstraint(tuple(map(str, row["constraints"])), step, gain))
    found = table["endings"]
    endings = None
    if found is not None:
        runners_up = tuple(_runner_up(row, rig) for row in found["runners_up"])
        endings = Endings(int(found["examined"]), int(found["same_basin"]), runners_up)
    counts = int(table["voxels"]), int(table["evaluations"])
    return Sensitivity(*counts, tuple(axes), tuple(constraints), endings, by_ap)


def _runner_up(row: Mapping[str, Any], rig: Rig) -> RunnerUp:
    tables = [row["placements"][sensor.name] for sensor in rig]
    poses = [Pose.from_degrees(each["position"], each["rotation"]) for each in tables]
    behind = Difference(float(row["behind"]), float(row["stderr"]))
    return RunnerUp(rig.with_poses(poses), behind, tuple(map(str, row["moved"])))
