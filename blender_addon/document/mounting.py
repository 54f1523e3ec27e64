"""Where a search may put the sensors of a scene: mounts, pairs, groups and constraints.

A mount's faces are those of parts, or painted. The faces and boxes that the 3D view shows
are computed here, too.
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from bpy.types import Collection, Depsgraph, Mesh, Object, PropertyGroup, Scene

from ..choices import BY_MESH, BY_PARTS, ON_SLOTS, ON_SURFACE, LimitBox
from ..engine import pe, search, studies
from .rig import pose_of
from .sensor_records import SensorRecord
from .study_table import TableData, read_row, value_at
from .transform_constraints import free_axes
from .vehicle import drawn_meshes, placed_triangles, triangles_of

MountSettings: TypeAlias = PropertyGroup
CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
AREA_DECIMALS = 5  # A mesh in single precision holds an area exactly to 0.01 mm
PAINTED = 0.5
"""A vertex with a larger weight counts as painted."""


def mounts_of(
    scene: Scene, depsgraph: Depsgraph, records: Sequence[SensorRecord]
) -> dict[str, search.AnyMount]:
    """Return the scene's mounts that visible sensors are on, by name. `InputError` when a mount
    that a sensor is on has no faces or slots, or does not exist."""
    rows = {row.name: row for row in scene.perception_entropy.mounts}
    on = mounted(records)
    for name, mount in on.items():
        if mount not in rows:
            expected = f"one of {', '.join(rows)}" if rows else "a mount of the scene"
            raise pe.InputError("scene", f"sensor {name!r}: mount", expected, repr(mount))
    used = [name for name in rows if name in on.values()]
    try:
        return {name: mount_of_row(scene, depsgraph, rows[name]) for name in used}
    except pe.InputError as error:
        raise of_scene(error) from None


def mounting_of(
    records: Sequence[SensorRecord],
    mounts: Mapping[str, search.AnyMount],
    constraints: pe.Constraints,
) -> pe.Mounting:
    """Return where a search may put the visible sensors of some records. `InputError` when a sensor
    is in two groups, or a mount is missing."""
    try:
        return pe.Mounting(
            mounts, mounted(records), pairs_of(records), groups_of(records), constraints=constraints
        )
    except pe.InputError as error:
        raise of_scene(error) from None


def mount_of_row(scene: Scene, depsgraph: Depsgraph, row: MountSettings) -> search.AnyMount:
    """Return one mount of a scene. `InputError` when it has no faces, or no slots."""
    if row.kind == ON_SLOTS:
        return pe.SlotMount(_slots(row, depsgraph))
    if row.faces == BY_PARTS:
        return read_row(pe.SurfaceMount, row, f"mount {row.name!r}", parts=part_names(row))
    faces = area_faces(scene, depsgraph, row)
    if not len(faces):
        raise area_problem(row)
    area = pe.MountArea(faces, studies.AREAS, (row.name,))
    own = read_row(pe.SurfaceMount, row, f"mount {row.name!r}", parts=[row.name])
    return replace(own, parts=(), area=area)


def with_mount(study: pe.Study, scene: Scene, depsgraph: Depsgraph, name: str) -> pe.Study:
    """Return a scene's study with its mount of a name, though no sensor may be on it."""
    own = study.search.mounting
    if name in own.mounts or name not in scene.perception_entropy.mounts:
        return study
    mount = mount_of_row(scene, depsgraph, scene.perception_entropy.mounts[name])
    mounting = replace(own, mounts={**own.mounts, name: mount})
    return replace(study, search=replace(study.search, mounting=mounting))


def mounted(records: Sequence[SensorRecord]) -> dict[str, str]:
    """Return the mount of each visible sensor that is on one and follows no other sensor."""
    followers = followers_of(pairs_of(records), groups_of(records))
    return {
        record.name: record.mount
        for record in records
        if record.visible and record.mount and record.name not in followers
    }


def pairs_of(records: Sequence[SensorRecord]) -> tuple[tuple[str, str], ...]:
    """Return visible sensors that are linked mirror images, the first by name leading."""
    visible = {record.name: record for record in records if record.visible}
    pairs = []
    for name, record in visible.items():
        other = visible.get(record.mirror_of)
        if other is not None and name < other.name and other.mirror_of == name:
            pairs.append((name, other.name))
    return tuple(sorted(pairs))


def groups_of(records: Sequence[SensorRecord]) -> tuple[tuple[str, ...], ...]:
    """Return groups of visible sensors that are on one rack. The first by name leads; one that is
    on a mount comes before the others."""
    racks: dict[str, list[SensorRecord]] = {}
    for record in records:
        if record.visible and record.rack:
            racks.setdefault(record.rack, []).append(record)
    ordered = (
        sorted(members, key=lambda record: (not record.mount, record.name))
        for members in racks.values()
    )
    groups = (tuple(record.name for record in members) for members in ordered if len(members) > 1)
    return tuple(sorted(groups))


def followers_of(pairs: Sequence[Sequence[str]], groups: Sequence[Sequence[str]]) -> frozenset[str]:
    """Return the names of sensors that follow others."""
    return frozenset([p[1] for p in pairs] + [name for group in groups for name in group[1:]])


def constraints_of(scene: Scene, wanted: pe.Mounting) -> pe.Constraints:
    """Return the constraints of a scene's search, with its no-go areas. `InputError` when one of
    them is impossible."""
    try:
        return replace(wanted.constraints, no_go=no_go_of(scene))
    except pe.InputError as error:
        raise of_scene(error) from None


def no_go_of(scene: Scene) -> tuple[pe.NoGo, ...]:
    """Return the boxes that are marked as no-go areas, by name."""
    marked = (obj for obj in scene.objects if obj.perception_entropy.is_no_go)
    return tuple(_no_go(obj) for obj in sorted(marked, key=lambda obj: obj.name))


def _no_go(obj: Object) -> pe.NoGo:
    """Return the axis-aligned box in the ground frame round an empty or a mesh."""
    if obj.type == "EMPTY":
        local = CORNERS * obj.empty_display_size
    else:
        local = np.array(obj.bound_box, dtype=float)
    ground_from_object = np.array(obj.matrix_world, dtype=float)
    corners = local @ ground_from_object[:3, :3].T + ground_from_object[:3, 3]
    low, high = (np.round(extreme(axis=0), 5) + 0.0 for extreme in (corners.min, corners.max))
    return pe.NoGo(obj.name, *zip(low.tolist(), high.tolist(), strict=True))


def _slots(row: MountSettings, depsgraph: Depsgraph) -> list[pe.Slot]:
    """Return the empties of a mount's collection as slots, by name."""
    objects = () if row.slots is None else row.slots.all_objects
    empties = (o for o in objects if o.type == "EMPTY" and not o.perception_entropy.is_sensor)
    return [pe.Slot(o.name, pose_of(o, depsgraph)) for o in sorted(empties, key=lambda o: o.name)]


def part_names(row: MountSettings) -> list[str]:
    """Return the names of the objects whose faces a mount is made of."""
    return list(dict.fromkeys(item.part.name_full for item in row.parts if item.part is not None))


def of_scene(error: pe.InputError) -> pe.InputError:
    """Return an engine's error with the source "scene"; its own source moves to the field."""
    if error.source == "scene":
        return error
    return error.within("scene")


def painted_area(vehicle: Collection, depsgraph: Depsgraph, mount: PropertyGroup) -> np.ndarray:
    """Return a mount's faces (F, 3, 3) [m], with modifiers, parents and instances applied. They
    equal triangles of the engine's vehicle to the bit. The array is empty if no face is painted."""
    areas = []
    for obj, ground_from_object in drawn_meshes(vehicle, depsgraph):
        if mount.group not in obj.vertex_groups:
            continue
        mesh = obj.to_mesh()
        is_painted = _chosen(obj, mesh, mount)
        triangles = placed_triangles(triangles_of(mesh)[is_painted], ground_from_object)
        areas.append((obj.original.name_full, triangles))
        obj.to_mesh_clear()
    areas.sort(key=lambda pair: pair[0])
    return np.concatenate([area for _, area in areas]) if areas else np.empty((0, 3, 3))


def area_faces(scene: Scene, depsgraph: Depsgraph, mount: PropertyGroup) -> np.ndarray:
    """Return the faces (F, 3, 3) of a mount that is no part of the vehicle [m]: painted, or those
    of a mesh of its own, to 0.01 mm; an empty array where there are none."""
    if mount.faces != BY_MESH:
        return painted_area(scene.perception_entropy.vehicle, depsgraph, mount)
    obj = mount.area
    if obj is None or obj.type != "MESH":
        return np.empty((0, 3, 3))
    own = obj.evaluated_get(depsgraph)
    triangles = placed_triangles(triangles_of(own.to_mesh()), np.array(own.matrix_world, float))
    own.to_mesh_clear()
    return np.round(triangles, AREA_DECIMALS) + 0.0


def _chosen(obj: Object, mesh: Mesh, mount: PropertyGroup) -> np.ndarray:
    """Return a mask (F,) of the triangles of a mesh that belong to the mount."""
    count = len(mesh.loop_triangles) if mesh.loop_triangles else _triangulated(mesh)
    corners = np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return _painted(mesh, obj.vertex_groups[mount.group].index)[corners.reshape(-1, 3)].all(axis=1)


def _painted(mesh: Mesh, group: int) -> np.ndarray:
    """Return a mask (P,) of the vertices with a weight above 0.5 in a vertex group."""
    weights = (
        any(element.group == group and element.weight > PAINTED for element in vertex.groups)
        for vertex in mesh.vertices
    )
    return np.fromiter(weights, bool, len(mesh.vertices))


def _triangulated(mesh: Mesh) -> int:
    mesh.calc_loop_triangles()
    return len(mesh.loop_triangles)


def area_problem(mount: PropertyGroup) -> pe.InputError:
    """Return the error of a surface that has no faces."""
    if mount.faces == BY_MESH:
        return pe.InputError("scene", f"mount {mount.name!r}: mesh", "a mesh with faces", "none")
    field = f"mount {mount.name!r}: vertex group {mount.group!r}"
    expected = "faces of the vehicle that are painted in it, with weights above 0.5"
    return pe.InputError("scene", field, expected, "none")


def mount_key(row: PropertyGroup) -> Hashable:
    """Return a cache key of a mount's faces, besides the vehicle; None for a list of slots."""
    if row.kind != ON_SURFACE:
        return None
    if row.faces == BY_MESH:
        obj = row.area
        own = () if obj is None else (obj.name, len(obj.data.vertices), str(obj.matrix_world))
        return row.faces, own
    return row.faces, tuple(part_names(row)) if row.faces == BY_PARTS else row.group


def mount_faces(
    scene: Scene, depsgraph: Depsgraph, row: PropertyGroup, vehicle: pe.Vehicle
) -> np.ndarray:
    """Return the faces (F, 3, 3) of a surface mount [m]; an empty array without faces."""
    if row.faces == BY_PARTS:
        wanted = [n for n, name in enumerate(vehicle.part_names) if name in part_names(row)]
        return vehicle.triangles[np.isin(vehicle.parts, wanted)]
    return area_faces(scene, depsgraph, row)


def bounds_box(
    obj: Object, sensor: pe.Sensor, vehicle: pe.Vehicle | None, around: np.ndarray | None = None
) -> LimitBox | None:
    """Return the box of a sensor's own bounds; None for one without any. On a fixed axis the box
    has no extent. On a free axis without bounds it has the default bounds; for a sensor on a
    surface it spans the faces `around` (F, 3, 3) and the sensor."""
    limits: TableData = value_at(obj.perception_entropy.table, ("bounds",), {})
    if not set("xyz") & set(limits):
        return None
    usual = search.default_bounds(sensor, vehicle)
    free = free_axes(obj)
    ends = []
    for number, axis in enumerate("xyz"):
        position = sensor.pose.position[number]
        side_range = (position, position) if axis not in free else usual[axis]
        if around is not None:
            side = around[:, :, number]
            side_range = (min(float(side.min()), position), max(float(side.max()), position))
        ends.append(
            limits.get(axis, side_range) if around is not None or axis in free else side_range
        )
    return _box(ends, False)


def no_go_boxes(scene: Scene) -> tuple[LimitBox, ...]:
    """Return the no-go areas of a scene."""
    return tuple(_box((area.x, area.y, area.z), True) for area in no_go_of(scene))


def _box(sides: Iterable[tuple[float, float] | None], forbidden: bool) -> LimitBox:
    """Return a box with ranges along all axes: those of a scene's objects have no open side."""
    low, high = zip(*(side for side in sides if side is not None), strict=True)
    return LimitBox(low, high, forbidden)
