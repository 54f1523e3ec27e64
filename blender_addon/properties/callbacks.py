"""Update callbacks of properties, and suggestions for their fields."""

import bpy
from bpy.types import Context, PropertyGroup

from .. import signals
from ..engine import catalog, kinds


def redraw(_settings: PropertyGroup, _context: Context) -> None:
    """Update callback of properties that change the 3D view alone."""
    signals.view_changed.emit()


def recolored(settings: PropertyGroup, _context: Context) -> None:
    """Update callback of a sensor's colour: from now on it is this sensor's own."""
    settings.color_of = settings.id_data.name
    signals.view_changed.emit()


def changed(_settings: PropertyGroup, _context: Context) -> None:
    """Update callback of properties that change the score."""
    signals.study_changed.emit()


def selected_object_index(_settings: PropertyGroup) -> int:
    """Return the place of the active object among the scene's objects, for a list of them."""
    active = bpy.context.view_layer.objects.active
    return -1 if active is None else bpy.context.scene.objects.find(active.name)


def select_object_by_index(_settings: PropertyGroup, number: int) -> None:
    """Select the object at a place among the scene's objects, and nothing else."""
    objects = bpy.context.scene.objects
    layer = bpy.context.view_layer
    if 0 <= number < len(objects) and objects[number].visible_get():
        for other in layer.objects.selected[:]:
            other.select_set(False)
        objects[number].select_set(True)
        layer.objects.active = objects[number]


def switched(_settings: PropertyGroup, _context: Context) -> None:
    """Update callback of the switch of the live score."""
    signals.live_toggled.emit()


def model_chosen(settings: PropertyGroup, context: Context) -> None:
    """Update callback of a sensor's model: a unique part of a name is completed."""
    if settings.model not in catalog.entries():
        found = catalog.matching(settings.model)
        if len(found) == 1:
            settings.model = found[0]  # which calls this again
            return
    changed(settings, context)


def models_of_a_kind(
    settings: PropertyGroup, _context: Context, _typed: str
) -> list[tuple[str, str]]:
    """Return the models of a sensor's kind, each with a short description."""
    entry = catalog.entries().get(settings.model)
    found = catalog.names(None if entry is None else entry.kind)
    models = ((name, catalog.load(name)) for name in found)
    return [(name, kinds.kind_of(model).summary(model)) for name, model in models]


def model_suggestions(
    _settings: PropertyGroup, _context: Context, _typed: str
) -> list[tuple[str, str]]:
    """Return the catalogue's names with what they are; Blender filters by what was typed."""
    labels = {n: kind.label for kind in kinds.KINDS.values() for n in catalog.names(kind.name)}
    return [(name, labels[name]) for name in catalog.names() if name in labels]


_kind_items: list[tuple[str, str, str, int]] = []
"""What the menu lists: Blender reads the texts after the function that made them returned."""


def kinds_to_add(
    _settings: PropertyGroup, _context: Context | None
) -> list[tuple[str, str, str, int]]:
    """Return the kinds of sensors that the catalogue has, as items of a Blender menu."""
    listed = [kind for kind in kinds.KINDS.values() if catalog.names(kind.name)]
    _kind_items[:] = [(kind.name, kind.label, "", n) for n, kind in enumerate(listed)]
    return _kind_items
