"""Mounts, pairs, groups and constraints of a search: their tables in the study file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from ..errors import InputError
from ..scene.geometry import Pose
from ..search import AnyMount, Constraints, Mounting, NoGo, Slot, SlotMount, SurfaceMount
from ..text.tables import Table
from ..text.values import A_NAME

T = TypeVar("T")
LIMITS = ("max_height", "max_width")


def read_mounting(table: Table, on: Mapping[str, str]) -> Mounting:
    """Return what `[optimize]` says of where sensors may sit.

    Parameters
    ----------
    table : Table
    on : mapping of sensor name to name of its mount
    """
    mounts = [_read_mount(each) for each in table.tables("mount")]
    names = [name for name, _ in mounts]
    for name in names:
        if names.count(name) > 1:
            raise table.error("mount", "each name once", f"{name!r} twice")
    pairs, groups = (_read_ties(table, key) for key in ("pair", "group"))
    limits = _read_constraints(table)
    return _made(table, lambda: Mounting(dict(mounts), on, pairs, groups, limits))


def mounting_tables(mounting: Mounting) -> dict[str, Any]:
    """Return the tables of `[optimize]` that `read_mounting` reads."""
    limits = mounting.constraints
    return {
        "max_height": limits.max_height,
        "max_width": limits.max_width,
        "min_distance": limits.min_distance,
        "clear_housings": limits.clear_housings,
        "no_go": [_no_go_table(area) for area in limits.no_go] or None,
        "mount": [_mount_table(*mount) for mount in mounting.mounts.items()] or None,
        "pair": [{"sensors": list(names)} for names in mounting.pairs] or None,
        "group": [{"sensors": list(names)} for names in mounting.groups] or None,
    }


def _read_mount(table: Table) -> tuple[str, AnyMount]:
    name = table.text("name", rule=A_NAME)
    slots = [_read_slot(each) for each in table.tables("slot")]
    if ("parts" in table) == bool(slots):
        found = "both" if slots else "neither"
        raise table.error("parts, slot", "parts of the vehicle, or a list of slots", found)
    mount = _made(table, lambda: SlotMount(slots)) if slots else _read_surface(table)
    table.finish()
    return name, mount


def _read_surface(table: Table) -> SurfaceMount:
    parts = table.texts("parts")
    standoff = table.number("standoff", 0.0)
    orientation = table.text("orientation", "upright")
    return _made(table, lambda: SurfaceMount(parts, standoff, orientation))


def _read_slot(table: Table) -> Slot:
    name = table.text("name", rule=A_NAME)
    position = table.numbers("position", 3)
    rotation = table.numbers("rotation", 3, (0.0, 0.0, 0.0))
    table.finish()
    return _made(table, lambda: Slot(name, Pose.from_degrees(position, rotation)))


def _read_ties(table: Table, key: str) -> list[tuple[str, ...]]:
    ties = []
    for each in table.tables(key):
        ties.append(each.texts("sensors"))
        each.finish()
    return ties


def _read_constraints(table: Table) -> Constraints:
    height, width = (table.number(key, None) for key in LIMITS)
    distance = table.number("min_distance", 0.0)
    clear = table.raw("clear_housings", False)
    areas = [_read_no_go(each) for each in table.tables("no_go")]
    return _made(table, lambda: Constraints(height, width, distance, clear, areas))


def _read_no_go(table: Table) -> NoGo:
    name = table.text("name", rule=A_NAME)
    sides = [table.numbers(axis, 2, None) for axis in "xyz"]
    table.finish()
    return _made(table, lambda: NoGo(name, *sides))  # type: ignore[arg-type]  # checked when made


def _made(table: Table, make: Callable[[], T]) -> T:
    """Make something of a table's values; what is wrong is said of the table."""
    try:
        return make()
    except InputError as error:
        if error.source.startswith("sensor "):
            raise
        raise table.error(error.field, error.expected, error.found) from None


def _no_go_table(area: NoGo) -> dict[str, Any]:
    sides = {axis: getattr(area, axis) for axis in "xyz"}
    return {"name": area.name} | {a: None if s is None else list(s) for a, s in sides.items()}


def _mount_table(name: str, mount: AnyMount) -> dict[str, Any]:
    if isinstance(mount, SurfaceMount):
        return {
            "name": name,
            "parts": list(mount.parts),
            "standoff": mount.standoff,
            "orientation": mount.orientation,
        }
    return {"name": name, "slot": [_slot_table(slot) for slot in mount.slots]}


def _slot_table(slot: Slot) -> dict[str, Any]:
    return {
        "name": slot.name,
        "position": list(slot.pose.position),
        "rotation": list(slot.pose.rotation_deg),
    }
