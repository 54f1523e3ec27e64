"""What a search has to know of the catalogue: housings, and whether two sensors are alike."""

from __future__ import annotations

from typing import Any

from .. import catalog
from ..errors import InputError
from ..scene.housing import Housing
from ..scene.sensors import Rig, SensorModel
from ..search import MountArea, Mounting, SurfaceMount


def housings_of(rig: Rig) -> dict[str, Housing]:
    """Return the housings that are known, by sensor."""
    found = {sensor.name: catalog.housing(sensor.model.name) for sensor in rig}
    return {name: housing for name, housing in found.items() if housing is not None}


def check_pairs(rig: Rig, mounting: Mounting) -> None:
    """Complain of a pair whose sensors are of different models."""
    models = {sensor.name: sensor.model for sensor in rig}
    for pair in mounting.pairs:
        one, other = (models.get(name) for name in pair)
        if one is not None and other is not None and not alike(one, other):
            named = " and ".join(repr(name) for name in pair)
            found = f"{one.name} and {other.name}"
            raise InputError("optimize", f"pair of {named}", "sensors of one model", found)


def mounts_told(rig: Rig, mounting: Mounting) -> dict[str, dict[str, Any]]:
    """Return what result.json says of the mounts that a rig's sensors are on, by sensor."""
    told = {}
    for sensor, name in mounting.on.items():
        mount = mounting.mounts[name]
        if isinstance(mount, SurfaceMount):
            faces = {"parts": list(mount.parts)} if mount.area is None else _area_told(mount.area)
            own = {**faces, "standoff": mount.standoff, "orientation": mount.orientation}
        else:
            own = {"slot": mount.nearest(rig[sensor].pose.position).name}
        told[sensor] = {"mount": name, **own}
    return told


def _area_told(area: MountArea) -> dict[str, Any]:
    """Return what result.json says of an area, whatever file it is in: how many faces."""
    return {"area_triangles": len(area.triangles)}


def alike(one: SensorModel, other: SensorModel) -> bool:
    """Whether two models are the same, whatever they are called."""
    return one is other or catalog.to_table(one) == catalog.to_table(other)
