"""Where a sensor would be worth most, where it may go, and what would fix something: for the view.

The places that were scored last in each scene, and the suggestions that were asked for last. They
are kept here and not in a property: they are not part of the user's work.
"""

from __future__ import annotations

from typing import NamedTuple

import bpy

from .. import document, signals
from ..engine import advice, jobs, studies


class Repairs(NamedTuple):
    """Suggestions for `of`: a requirement's name, or a location that was queried [m]."""

    of: str | tuple[float, ...]
    found: tuple[studies.Suggestion, ...]


maps: dict[str, jobs.PlaceMap] = {}
offers: dict[str, Repairs] = {}
regions: dict[str, advice.FreeRegion] = {}
built: dict[str, advice.AsBuilt] = {}
"""All by the scene's name."""


def store(scene_name: str, found: jobs.PlaceMap | None) -> None:
    """Store places, and have them shown; None discards those that are there."""
    _store(maps, scene_name, found)


def store_offers(scene_name: str, found: Repairs | None) -> None:
    """Store suggestions, and have them shown; None discards those that are there."""
    _store(offers, scene_name, found)


def store_region(scene_name: str, found: advice.FreeRegion | None) -> None:
    """Store the free region of a sensor, and have it shown; None discards it."""
    _store(regions, scene_name, found)


def store_built(scene_name: str, found: advice.AsBuilt | None) -> None:
    """Store the comparison with a built rig, and have that shown; None discards it."""
    _store(built, scene_name, found)


def _store(kept: dict, scene_name: str, found: object) -> None:
    if found is not None:
        kept[scene_name] = found
    elif kept.pop(scene_name, None) is None:
        return
    signals.view_changed.emit()


def discard_outdated() -> None:
    """Discard suggestions that are of sensors as they no longer are; the scene is idle."""
    scene = bpy.context.scene
    own = offers.get(scene.name)
    if own is None or not own.found:
        return
    depsgraph = bpy.context.evaluated_depsgraph_get()
    now = document.possible_sensors(document.sensor_objects(scene), depsgraph)
    if {(s.name, s.pose) for s in now} != {(s.name, s.pose) for s in own.found[0].start}:
        store_offers(scene.name, None)


def clear(*_: object) -> None:
    """Discard all: another file is opened, whose scenes may have the same names."""
    maps.clear()
    offers.clear()
    regions.clear()
    built.clear()
