"""Mounts of a study: areas of the body, which are in a mesh file beside it, and their tables."""

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from ..base.codec import Node, hook, read
from ..base.errors import one_of, shown
from ..base.plugins import shipped
from ..base.setting import Part
from ..base.values import A_PATH
from ..scene.mesh import AS_SAID, Mesh
from ..scene.rig import Rig
from ..search import MountArea, Mounting, SurfaceMount


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


@dataclass(frozen=True, slots=True)
class AreaFile:
    """The table of an area: a mesh file, and the parts of it that are the area; all by default."""

    file: Annotated[str, Part(rule=A_PATH)]
    parts: tuple[str, ...] = ()


def _read_area(node: Node) -> MountArea:
    own = read(AreaFile, node)
    mesh = shipped("reader.mesh")(node.folder / own.file, AS_SAID)  # a patch's shape tells nothing
    for name in own.parts:
        if name not in mesh.part_names:
            expected = f"{one_of(mesh.part_names, name)} in {own.file}"
            raise node.error(expected, shown(name), "parts")
    wanted = [mesh.part_names.index(name) for name in own.parts or mesh.part_names]
    with node.naming():
        return MountArea(mesh.triangles[np.isin(mesh.parts, wanted)], own.file, own.parts)


def _write_area(area: MountArea) -> dict[str, Any]:
    table = {"file": area.file, "parts": list(area.parts)}
    return {key: value for key, value in table.items() if value}


hook(MountArea, _read_area, _write_area, AreaFile)


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
