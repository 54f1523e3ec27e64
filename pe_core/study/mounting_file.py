"""Mounts, pairs, groups and constraints of a search: their tables in the study file.

An area of the body is in a mesh file beside the study.

Housings and models of the catalogue are looked up for them.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import catalog
from ..base.errors import InputError, one_of, shown
from ..base.plugins import shipped
from ..base.setting import read_declared, read_settings, settings_table
from ..base.table_reader import Table
from ..base.values import A_NAME, A_PATH
from ..geometry.poses import Pose
from ..scene.mesh import AS_SAID, Mesh
from ..scene.rig import Rig, SensorModel
from ..search import AnyMount, Constraints, MountArea, Mounting, NoGo, Slot, SlotMount, SurfaceMount


def read_mounting(table: Table, on: Mapping[str, str], folder: Path) -> Mounting:
    """Return mounts, pairs, groups and constraints of `[optimize]`. `on` has the name of the mount
    of each sensor that is on one. Files of areas are named relative to `folder`, where the study
    is."""
    mounts = [_read_mount(each, folder) for each in table.tables("mount")]
    names = [name for name, _ in mounts]
    for name in names:
        if names.count(name) > 1:
            raise table.error("mount", "each name once", f"{name!r} twice")
    pairs, groups = (_read_ties(table, key) for key in ("pair", "group"))
    values, areas = read_settings(table, Constraints), table.tables("no_go")
    no_go = [read_declared(each, NoGo, each.text("name", rule=A_NAME)) for each in areas]
    try:
        limits = Constraints(**values, no_go=no_go)
        return Mounting(dict(mounts), on, pairs, groups, limits)
    except InputError as error:
        if error.source.startswith("sensor "):
            raise
        raise table.error(error.field, error.expected, error.found) from None


def mounting_tables(mounting: Mounting) -> dict[str, Any]:
    """Return the tables of `[optimize]` that `read_mounting` reads."""
    limits = mounting.constraints
    return {
        **settings_table(limits),
        "no_go": [{"name": area.name} | settings_table(area) for area in limits.no_go] or None,
        "mount": [_mount_table(*mount) for mount in mounting.mounts.items()] or None,
        "pair": [{"sensors": list(names)} for names in mounting.pairs] or None,
        "group": [{"sensors": list(names)} for names in mounting.groups] or None,
    }


def areas_mesh(mounting: Mounting) -> Mesh | None:
    """Return the areas of all mounts as one mesh with a part for each mount; None without areas."""
    areas = {name: area.triangles for name, area in areas_of(mounting).items()}
    if not areas:
        return None
    parts = np.repeat(np.arange(len(areas), dtype=np.int32), [len(each) for each in areas.values()])
    return Mesh(np.concatenate(list(areas.values())), parts, tuple(areas))


def areas_of(mounting: Mounting) -> dict[str, MountArea]:
    """Return the areas of mounts, by the mount's name."""
    surfaces = ((n, m) for n, m in mounting.mounts.items() if isinstance(m, SurfaceMount))
    return {name: mount.area for name, mount in surfaces if mount.area is not None}


def with_areas_in(mounting: Mounting, file: str) -> Mounting:
    """Return a mounting whose areas are parts of one mesh file, named after their mounts."""
    mounts = dict(mounting.mounts)
    for name, mount in mounts.items():
        if isinstance(mount, SurfaceMount) and mount.area is not None:
            mounts[name] = replace(mount, area=replace(mount.area, file=file, parts=(name,)))
    return replace(mounting, mounts=mounts)


def _read_mount(table: Table, folder: Path) -> tuple[str, AnyMount]:
    name = table.text("name", rule=A_NAME)
    slots = [_read_slot(each) for each in table.tables("slot")]
    if ("parts" in table or "area" in table) == bool(slots):
        found = "both" if slots else "neither"
        expected = "parts of the vehicle or an area, or a list of slots"
        raise table.error("parts, area, slot", expected, found)
    if slots:
        with table.naming():
            mount: AnyMount = SlotMount(slots)
    else:
        file = table.text("area", None, rule=A_PATH)
        parts = table.texts("parts", ()) if file else table.texts("parts")
        area = None if file is None else _read_area(table, folder, file, parts)
        own = read_settings(table, SurfaceMount) | ({} if area is None else {"area": area})
        with table.naming():
            mount = SurfaceMount(() if area else parts, **own)
    table.finish()
    return name, mount


def _read_area(table: Table, folder: Path, file: str, parts: tuple[str, ...]) -> MountArea:
    """Return the faces of a mesh file, of some of its parts or of all."""
    mesh = shipped("reader.mesh")(folder / file, AS_SAID)  # a patch's shape tells nothing
    for part in parts:
        if part not in mesh.part_names:
            expected = one_of(mesh.part_names, part)
            raise table.error("parts", f"{expected} in {file}", shown(part))
    wanted = [mesh.part_names.index(part) for part in parts or mesh.part_names]
    triangles = mesh.triangles[np.isin(mesh.parts, wanted)]
    with table.naming():
        return MountArea(triangles, file, parts)


def _read_slot(table: Table) -> Slot:
    name = table.text("name", rule=A_NAME)
    position = table.numbers("position", 3)
    rotation = table.numbers("rotation", 3, (0.0, 0.0, 0.0))
    table.finish()
    with table.naming():
        return Slot(name, Pose.from_degrees(position, rotation))


def _read_ties(table: Table, key: str) -> list[tuple[str, ...]]:
    ties = []
    for each in table.tables(key):
        ties.append(each.texts("sensors"))
        each.finish()
    return ties


def _mount_table(name: str, mount: AnyMount) -> dict[str, Any]:
    if isinstance(mount, SlotMount):
        slots = [
            {
                "name": slot.name,
                "position": list(slot.pose.position),
                "rotation": list(slot.pose.rotation_deg),
            }
            for slot in mount.slots
        ]
        return {"name": name, "slot": slots}
    area = mount.area
    if area is None:
        faces: dict[str, Any] = {"parts": list(mount.parts)}
    else:
        faces = {"area": area.file, "parts": list(area.parts) or None}
    return {"name": name, **faces, **settings_table(mount)}


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
            area = mount.area
            parts = {"parts": list(mount.parts)}
            faces = parts if area is None else {"area_triangles": len(area.triangles)}
            own = {**faces, "standoff": mount.standoff, "orientation": mount.orientation}
        else:
            own = {"slot": mount.nearest(rig[sensor].pose.position).name}
        table[sensor] = {"mount": name, **own}
    return table


def same_model(one: SensorModel, other: SensorModel) -> bool:
    """Return whether two models have equal values, whatever their names."""
    return one is other or catalog.to_table(one) == catalog.to_table(other)
