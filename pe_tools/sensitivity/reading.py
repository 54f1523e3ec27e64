"""Read a sensitivity analysis back from result.json."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pe_core.geometry.poses import Pose
from pe_core.scene.rig import Rig
from pe_core.study.objective_setting import EXPECTED_AP

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
    return Sensitivity(
        int(table["voxels"]),
        int(table["evaluations"]),
        tuple(_axis(row, STEEP_AP if by_ap else STEEP_NATS) for row in table["axes"]),
        tuple(_constraint(row) for row in table["constraints"]),
        None if table["endings"] is None else _endings(table["endings"], rig),
        by_ap,
    )


def _axis(row: Mapping[str, Any], steep: float) -> AxisCost:
    cost = {float(step): _difference(values) for step, values in row["cost"].items()}
    return AxisCost(str(row["sensor"]), str(row["axis"]), str(row["status"]), cost, steep)


def _constraint(row: Mapping[str, Any]) -> ActiveConstraint:
    step = PoseStep(str(row["sensor"]), str(row["axis"]), float(row["step"]))
    gain = Difference(-float(row["gain"]), float(row["stderr"]))
    return ActiveConstraint(tuple(map(str, row["constraints"])), step, gain)


def _endings(table: Mapping[str, Any], rig: Rig) -> Endings:
    runners_up = tuple(_runner_up(row, rig) for row in table["runners_up"])
    return Endings(int(table["examined"]), int(table["same_basin"]), runners_up)


def _runner_up(row: Mapping[str, Any], rig: Rig) -> RunnerUp:
    tables = [row["placements"][sensor.name] for sensor in rig]
    poses = [Pose.from_degrees(each["position"], each["rotation"]) for each in tables]
    behind = Difference(float(row["behind"]), float(row["stderr"]))
    return RunnerUp(rig.with_poses(poses), behind, tuple(map(str, row["moved"])))


def _difference(values: list[Any]) -> Difference:
    mean, stderr = map(float, values)
    return Difference(mean, stderr)
