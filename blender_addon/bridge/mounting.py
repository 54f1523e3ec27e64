"""Where a search may put the sensors of a scene: mounts, pairs, groups and constraints."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ..choices import BY_PARTS, ON_SLOTS
from ..engine import pe, search, studies
from .areas import area_problem, painted_area
from .mirroring import mirror_of
from .rig import pose_of
from .typed import as_typed

MountSettings = bpy.types.PropertyGroup
CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


def mounting_of(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    sensors: Sequence[bpy.types.Object],
) -> pe.Mounting:
    """Return what a scene says of where its sensors may sit; `sensors` are those that count.

    Raises
    ------
    InputError
        When a mount that a sensor is on has no faces or slots, or is none.
    """
    pairs, groups = pairs_of(scene, sensors), groups_of(sensors)
    follow = followers_of(pairs, groups)
    on = {o.name: m for o in sensors if (m := o.perception_entropy.mount) and o.name not in follow}
    rows = {row.name: row for row in scene.perception_entropy.mounts}
    for name, mount in on.items():
        if mount not in rows:
            expected = f"one of {', '.join(rows)}" if rows else "a mount of the scene"
            raise pe.InputError("scene", f"sensor {name!r}: mount", expected, repr(mount))
    used = [name for name in rows if name in on.values()]
    try:
        mounts = {name: mount_of_row(scene, depsgraph, rows[name]) for name in used}
        return pe.Mounting(mounts, on, pairs, groups, constraints_of(scene))
    except pe.InputError as error:
        raise _of_scene(error) from None


def mount_of_row(
    scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, row: MountSettings
) -> search.AnyMount:
    """Return one mount of a scene.

    Raises
    ------
    InputError
        When it has no faces, or no slots.
    """
    if row.kind == ON_SLOTS:
        return pe.SlotMount(_slots(row, depsgraph))
    standoff = as_typed(row.standoff)
    if row.faces == BY_PARTS:
        return pe.SurfaceMount(part_names(row), standoff, row.orientation)
    vehicle = scene.perception_entropy.vehicle
    faces = painted_area(vehicle, depsgraph, row)
    if not len(faces):
        raise area_problem(row)
    area = pe.MountArea(faces, studies.AREAS, (row.name,))
    return pe.SurfaceMount((), standoff, row.orientation, area)


def pairs_of(
    scene: bpy.types.Scene, sensors: Sequence[bpy.types.Object]
) -> tuple[tuple[str, str], ...]:
    """Return sensors that are linked mirror images, the first by name leading."""
    names, found = {obj.name for obj in sensors}, []
    for obj in sensors:
        other = mirror_of(obj, scene)
        if other is not None and obj.name < other.name and other.name in names:
            found.append((obj.name, other.name))
    return tuple(found)


def groups_of(sensors: Sequence[bpy.types.Object]) -> tuple[tuple[str, ...], ...]:
    """Return sensors of one rack; the first by name leads, one that is on a mount before others."""
    racks: dict[tuple[str, str], list[bpy.types.Object]] = {}
    for obj in sensors:
        if (key := _rack_of(obj)) is not None:
            racks.setdefault(key, []).append(obj)
    ordered = (
        sorted(each, key=lambda o: (not o.perception_entropy.mount, o.name))
        for each in racks.values()
    )
    return tuple(tuple(obj.name for obj in each) for each in ordered if len(each) > 1)


def followers_of(pairs: Sequence[Sequence[str]], groups: Sequence[Sequence[str]]) -> frozenset[str]:
    """Return the names of sensors that follow others."""
    return frozenset([p[1] for p in pairs] + [name for group in groups for name in group[1:]])


def constraints_of(scene: bpy.types.Scene) -> pe.Constraints:
    """Return what every placement of a scene's search keeps to."""
    settings = scene.perception_entropy
    height, width = (
        as_typed(value) if value else None for value in (settings.max_height, settings.max_width)
    )
    distance = as_typed(settings.min_distance)
    return pe.Constraints(height, width, distance, settings.clear_housings, no_go_of(scene))


def no_go_of(scene: bpy.types.Scene) -> tuple[pe.NoGo, ...]:
    """Return the boxes that are marked as no-go areas, by name."""
    marked = (obj for obj in scene.objects if obj.perception_entropy.is_no_go)
    return tuple(_no_go(obj) for obj in sorted(marked, key=lambda obj: obj.name))


def _no_go(obj: bpy.types.Object) -> pe.NoGo:
    """The box along the axes of the ground frame round an empty or a mesh."""
    if obj.type == "EMPTY":
        local = CORNERS * obj.empty_display_size
    else:
        local = np.array(obj.bound_box, dtype=float)
    ground_from_object = np.array(obj.matrix_world, dtype=float)
    corners = local @ ground_from_object[:3, :3].T + ground_from_object[:3, 3]
    low, high = (np.round(each(axis=0), 5) + 0.0 for each in (corners.min, corners.max))
    return pe.NoGo(obj.name, *zip(low.tolist(), high.tolist(), strict=True))


def _slots(row: MountSettings, depsgraph: bpy.types.Depsgraph) -> list[pe.Slot]:
    """The empties of a mount's collection as slots, by name."""
    objects = () if row.slots is None else row.slots.all_objects
    empties = (o for o in objects if o.type == "EMPTY" and not o.perception_entropy.is_sensor)
    return [pe.Slot(o.name, pose_of(o, depsgraph)) for o in sorted(empties, key=lambda o: o.name)]


def part_names(row: MountSettings) -> list[str]:
    """Return the names of the objects whose faces a mount is made of."""
    return list(dict.fromkeys(each.part.name_full for each in row.parts if each.part is not None))


def _rack_of(obj: bpy.types.Object) -> tuple[str, str] | None:
    """What a sensor moves with: a rack of a name, or the object it is parented to."""
    if rack := obj.perception_entropy.rack:
        return "rack", rack
    parent = obj.parent
    if parent is not None and parent.perception_entropy.is_rack:
        return "parent", parent.name
    return None


def _of_scene(error: pe.InputError) -> pe.InputError:
    """Say of the scene what the engine says of a mount or a search."""
    if error.source == "scene":
        return error
    return pe.InputError("scene", f"{error.source}: {error.field}", error.expected, error.found)
