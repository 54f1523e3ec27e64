"""What happens when a property is set, and what its field suggests."""

from __future__ import annotations

import bpy

from .. import changes
from ..engine import catalog, kinds


def redraw(_settings: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    """Update callback of what only changes the picture."""
    changes.picture.tell()


def changed(_settings: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    """Update callback of what changes the score."""
    changes.study.tell()


def switched(_settings: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    """Update callback of the switch of the live score."""
    changes.live.tell()


def model_chosen(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update callback of a sensor's model: a part of a name is taken for the only one it is in."""
    if settings.model not in catalog.entries():
        found = catalog.matching(settings.model)
        if len(found) == 1:
            settings.model = found[0]  # which calls this again
            return
    changed(settings, context)


def own_curve_switched(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update callback of a sensor's own AP curve: it begins as its kind's."""
    entry = catalog.entries().get(settings.model)
    if settings.own_curve and entry is not None and not settings.is_property_set("curve_a"):
        curve = kinds.KINDS[entry.kind].curve
        settings.curve_a, settings.curve_b = curve.a, curve.b
    changed(settings, context)


def models_of_a_kind(
    settings: bpy.types.PropertyGroup, _context: bpy.types.Context, _typed: str
) -> list[tuple[str, str]]:
    """Return the models of the kind that a sensor is of, each in a few words."""
    entry = catalog.entries().get(settings.model)
    found = catalog.names(None if entry is None else entry.kind)
    models = ((name, catalog.load(name)) for name in found)
    return [(name, kinds.kind_of(model).brief(model)) for name, model in models]


def model_suggestions(
    _settings: bpy.types.PropertyGroup, _context: bpy.types.Context, _typed: str
) -> list[tuple[str, str]]:
    """Return the catalogue's names with what they are; Blender filters by what was typed."""
    labels = {n: kind.label for kind in kinds.KINDS.values() for n in catalog.names(kind.name)}
    return [(name, labels[name]) for name in catalog.names() if name in labels]
