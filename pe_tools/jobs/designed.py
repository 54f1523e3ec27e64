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
    Goals,
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

    A sensor on a surface keeps the position of its base: with a housing of another height, its
    origin is higher or lower.

    Parameters
    ----------
    study : Study
    models : mapping of sensor name to SensorModel or None
        Model of each sensor that the study lets choose; None leaves the sensor out.

    Returns
    -------
    Study
    """
    mounting = _mounting_of(study.search.mounting, models)
    sensors = [_taken(sensor, models[sensor.name]) for sensor in _kept(study.rig, models)]
    sensors += [sensor for sensor in study.rig if sensor.name not in models]
    rig = Rig(sorted(sensors, key=lambda s: [o.name for o in study.rig].index(s.name)))
    order = [sensor.name for sensor in rig]
    poses = _seated(study.rig, rig, mounting)
    search = replace(study.search, mounting=mounting, goals=_goals_of(study.search.goals, order))
    return replace(study, rig=rig.with_poses(poses), search=search, selection=Selection())


def _goals_of(goals: Goals, names: Sequence[str]) -> Goals:
    """Return the goals of a search without the sensors that are left out."""
    fixed = [name for name in goals.fixed if name in names]
    starts = [
        Start(start.name, {n: pose for n, pose in start.poses.items() if n in names})
        for start in goals.starts
    ]
    return replace(goals, fixed=fixed, starts=starts)


def design_names(designs: Sequence[Models]) -> list[str]:
    """Return a name for each design: its models, with their sensors if two designs need it."""
    short = [_models_named(models) for models in designs]
    twice = {name for name, count in Counter(short).items() if count > 1}
    return [
        _sensors_named(models) if name in twice else name
        for name, models in zip(short, designs, strict=True)
    ]


def _models_named(models: Models) -> str:
    counts = Counter(model.name for model in models.values() if model is not None)
    named = (f"{count} x {name}" if count > 1 else name for name, count in counts.items())
    return " + ".join(named) or "none of them"


def _sensors_named(models: Models) -> str:
    return " + ".join(f"{m.name} ({name})" for name, m in models.items() if m is not None)


def _kept(rig: Rig, models: Models) -> list[Sensor]:
    return [sensor for sensor in rig if models.get(sensor.name) is not None]


def _taken(sensor: Sensor, model: SensorModel | None) -> Sensor:
    """Return a sensor with another model; a new kind discards its fusion group and AP curve."""
    assert model is not None
    if model.kind != sensor.kind:
        return replace(sensor, model=model, fusion=None, curve=None)
    return replace(sensor, model=model)


def _mounting_of(mounting: Mounting, models: Models) -> Mounting:
    """Return the mounting without the sensors that are left out."""
    gone = {name for name, model in models.items() if model is None}
    on = {name: mount for name, mount in mounting.on.items() if name not in gone}
    pairs = [pair for pair in mounting.pairs if not gone & set(pair)]
    groups = [[name for name in group if name not in gone] for group in mounting.groups]
    remaining = [group for group in groups if len(group) > 1]
    return replace(mounting, on=on, pairs=pairs, groups=remaining)


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
