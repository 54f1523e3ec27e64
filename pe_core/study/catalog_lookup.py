"""Lookups in the catalogue for a search: housings, equal models, mounts for result.json."""

from __future__ import annotations

from typing import Any

from .. import catalog
from ..base.errors import InputError
from ..scene.housing import Housing
from ..scene.rig import Rig, SensorModel
from ..search import MountArea, Mounting, SurfaceMount


def housings_of(rig: Rig) -> dict[str, Housing]:
    """Return the housings that the catalogue has, by sensor."""
    housings = {sensor.name: catalog.housing(sensor.model.name) for sensor in rig}
    return {name: housing for name, housing in housings.items() if housing is not None}


def check_pairs(rig: Rig, mounting: Mounting) -> None:
    """Refuse a pair whose sensors are of different models."""
    models = {sensor.name: sensor.model for sensor in rig}
    for pair in mounting.pairs:
        one, other = (models.get(name) for name in pair)
        if one is not None and other is not None and not same_model(one, other):
            named = " and ".join(repr(name) for name in pair)
            found = f"{one.name} and {other.name}"
            raise InputError("optimize", f"pair of {named}", "sensors of one model", found)


def mounts_table(rig: Rig, mounting: Mounting) -> dict[str, dict[str, Any]]:
    """Return the table "mounts" of result.json: the mount of each sensor that is on one."""
    table = {}
    for sensor, name in mounting.on.items():
        mount = mounting.mounts[name]
        if isinstance(mount, SurfaceMount):
            faces = {"parts": list(mount.parts)} if mount.area is None else _area_entry(mount.area)
            own = {**faces, "standoff": mount.standoff, "orientation": mount.orientation}
        else:
            own = {"slot": mount.nearest(rig[sensor].pose.position).name}
        table[sensor] = {"mount": name, **own}
    return table


def _area_entry(area: MountArea) -> dict[str, Any]:
    """Return the entry of an area in result.json: its number of faces."""
    return {"area_triangles": len(area.triangles)}


def same_model(one: SensorModel, other: SensorModel) -> bool:
    """Return whether two models have equal values, whatever their names."""
    return one is other or catalog.to_table(one) == catalog.to_table(other)
