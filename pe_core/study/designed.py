"""A design as a study of its own: the sensors that it takes, on the mounts where they stand."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from .. import catalog
from ..scene.geometry import Pose, rotate
from ..scene.sensors import Rig, Sensor, SensorModel
from ..search import (
    Mounting,
    Selection,
    SurfaceMount,
    mirrored,
    pose_from_values,
    pose_values,
    seat_of,
)
from .study import Study

Models = Mapping[str, SensorModel | None]


def design_study(study: Study, models: Models) -> Study:
    """Return the study of a design, which has nothing to choose any more.

    A sensor on a surface keeps the place of its base: where its new housing is of another height,
    its origin is higher or lower.

    Parameters
    ----------
    study : Study
    models : mapping of sensor name to SensorModel or None
        Of each sensor that is chosen; None leaves it out.
    """
    mounting = _mounting_of(study.search.mounting, models)
    sensors = [_taken(sensor, models[sensor.name]) for sensor in _kept(study.rig, models)]
    sensors += [sensor for sensor in study.rig if sensor.name not in models]
    order = [sensor.name for sensor in study.rig]
    rig = Rig(sorted(sensors, key=lambda sensor: order.index(sensor.name)))
    poses = _seated(study.rig, rig, mounting)
    search = replace(study.search, mounting=mounting)
    return replace(study, rig=rig.with_poses(poses), search=search, selection=Selection())


def design_names(designs: Sequence[Models]) -> list[str]:
    """Return a name for each design: its models, and where they sit if that tells two apart."""
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
    """Return a sensor of another model; one of another kind leaves its group and AP curve."""
    assert model is not None
    if model.kind != sensor.kind:
        return replace(sensor, model=model, fusion=None, curve=None)
    return replace(sensor, model=model)


def _mounting_of(mounting: Mounting, models: Models) -> Mounting:
    """Return what is said of sensors that are there."""
    gone = {name for name, model in models.items() if model is None}
    on = {name: mount for name, mount in mounting.on.items() if name not in gone}
    pairs = [pair for pair in mounting.pairs if not gone & set(pair)]
    groups = [[name for name in group if name not in gone] for group in mounting.groups]
    some = [group for group in groups if len(group) > 1]
    return replace(mounting, on=on, pairs=pairs, groups=some)


def _seated(before: Rig, rig: Rig, mounting: Mounting) -> list[Pose]:
    """Return where each sensor starts: bases on surfaces stay where they are, pairs mirror."""
    poses = {}
    for sensor in rig:
        mount = mounting.mount_of(sensor.name)
        old = before[sensor.name].model
        poses[sensor.name] = sensor.pose
        if isinstance(mount, SurfaceMount) and old is not sensor.model:
            poses[sensor.name] = _with_base(sensor, mount, old)
    for first, second in mounting.pairs:
        if poses[first] is not rig[first].pose:
            poses[second] = mirrored(poses[first])
    return [poses[sensor.name] for sensor in rig]


def _with_base(sensor: Sensor, mount: SurfaceMount, old: SensorModel) -> Pose:
    """Return the pose of a sensor whose base is where that of another model was."""
    seat, own = (seat_of(mount, catalog.housing(m.name)) for m in (old, sensor.model))
    if np.array_equal(seat, own):
        return sensor.pose
    away = rotate(sensor.pose.ground_from_sensor, seat - own).tolist()
    position = zip("xyz", sensor.pose.position, away, strict=True)
    moved = {axis: where + by for axis, where, by in position}
    return pose_from_values(pose_values(sensor.pose) | moved)
