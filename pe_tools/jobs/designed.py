"""Build the study of a design: the chosen sensor models on their mounts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pe_core import catalog
from pe_core.geometry.poses import Pose, rotate
from pe_core.scene.rig import Rig, Sensor, SensorModel
from pe_core.search import (
    Mounting,
    Selection,
    Start,
    SurfaceMount,
    mirrored,
    pose_from_values,
    pose_values,
    standoff_point,
)
from pe_core.study.study import Study

Models = Mapping[str, SensorModel | None]


def design_study(study: Study, models: Models) -> Study:
    """Return the study of a design, without choices.

    `models` has the model of each sensor that the study lets choose; None leaves the sensor out. A
    sensor on a surface keeps the position of its base: with a housing of another height, its origin
    is higher or lower.
    """
    gone = {name for name, model in models.items() if model is None}
    rig = Rig([_taken(sensor, models) for sensor in study.rig if sensor.name not in gone])
    order = [sensor.name for sensor in rig]
    mounting, goals = study.search.mounting, study.search.goals
    groups = [[name for name in group if name not in gone] for group in mounting.groups]
    mounting = replace(
        mounting,
        on={name: mount for name, mount in mounting.on.items() if name not in gone},
        pairs=[pair for pair in mounting.pairs if not gone & set(pair)],
        groups=[group for group in groups if len(group) > 1],
    )
    starts = [
        Start(start.name, {n: pose for n, pose in start.poses.items() if n in order})
        for start in goals.starts
    ]
    goals = replace(goals, fixed=[name for name in goals.fixed if name in order], starts=starts)
    rig = rig.with_poses(_seated(study.rig, rig, mounting))
    search = replace(study.search, mounting=mounting, goals=goals)
    return replace(study, rig=rig, search=search, selection=Selection())


def design_names(designs: Sequence[Models]) -> list[str]:
    """Return a name for each design: its models, with their sensors if two designs need it."""
    names = []
    for models in designs:
        counts = Counter(model.name for model in models.values() if model is not None)
        words = (f"{count} x {name}" if count > 1 else name for name, count in counts.items())
        names.append(" + ".join(words) or "none of them")
    twice = {name for name, count in Counter(names).items() if count > 1}
    for k, models in enumerate(designs):
        if names[k] in twice:
            named = (f"{m.name} ({name})" for name, m in models.items() if m is not None)
            names[k] = " + ".join(named)
    return names


def _taken(sensor: Sensor, models: Models) -> Sensor:
    """Return a sensor with its model; a new kind discards its fusion group and AP curve."""
    model = models.get(sensor.name)
    if model is None or model.kind == sensor.kind:
        return sensor if model is None else replace(sensor, model=model)
    return replace(sensor, model=model, fusion=None, curve=None)


def _seated(before: Rig, rig: Rig, mounting: Mounting) -> list[Pose]:
    """Return the initial pose of each sensor: bases on surfaces stay, pairs are mirrored."""
    poses = {}
    for sensor in rig:
        mount = mounting.mount_of(sensor.name)
        old_model = before[sensor.name].model
        poses[sensor.name] = sensor.pose
        if isinstance(mount, SurfaceMount) and old_model is not sensor.model:
            poses[sensor.name] = _with_base(sensor, mount, old_model)
    for first, second in mounting.pairs:
        if poses[first] is not rig[first].pose:
            poses[second] = mirrored(poses[first])
    return [poses[sensor.name] for sensor in rig]


def _with_base(sensor: Sensor, mount: SurfaceMount, old: SensorModel) -> Pose:
    """Return the pose of a sensor whose base replaces that of the old model."""
    old_seat, new_seat = (
        standoff_point(mount, catalog.housing(m.name)) for m in (old, sensor.model)
    )
    if np.array_equal(old_seat, new_seat):
        return sensor.pose
    shift = rotate(sensor.pose.ground_from_sensor, old_seat - new_seat).tolist()
    position = zip("xyz", sensor.pose.position, shift, strict=True)
    moved = {axis: where + by for axis, where, by in position}
    return pose_from_values(pose_values(sensor.pose) | moved)
