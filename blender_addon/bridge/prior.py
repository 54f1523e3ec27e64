"""The scene's prior with its focus weights w(s, c): what counts more, where."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import bpy

from ..choices import CUSTOM, FROM_BOXES, HIGHWAY, REGIONS, ROAD, UNIFORM, Area
from ..engine import pe
from .typed import as_typed

MODELS = {ROAD: pe.Prior.road, HIGHWAY: pe.Prior.highway, UNIFORM: pe.Prior.uniform}


def prior_from_scene(scene: bpy.types.Scene) -> pe.Prior:
    """Return the scene's prior, focus weights included.

    Raises
    ------
    InputError
        When boxes cannot be read, or a focus is no possible one; the line names the file, or the
        focus by its place in the list.
    """
    settings = scene.perception_entropy
    from_boxes = settings.prior == FROM_BOXES
    prior = _prior_from_boxes(settings.boxes) if from_boxes else MODELS[settings.prior]()
    rows = enumerate(settings.focus, start=1)
    return replace(prior, focus=tuple(f for n, row in rows for f in _checked(prior, n, row)))


def prior_signature(scene: bpy.types.Scene) -> list[object]:
    """Return what the prior depends on; unlike the prior itself, also of a focus that is wrong."""
    settings = scene.perception_entropy
    rows = [(as_typed(row.factor), _areas(row), _classes(row)) for row in settings.focus]
    boxes = [settings.boxes] if settings.prior == FROM_BOXES else []
    return [settings.prior, *boxes, *rows]


def prior_key(scene: bpy.types.Scene) -> str:
    """Return a text that is another one for another prior, as long as files are what they were."""
    return repr(prior_signature(scene))


def focus_rows(
    scene: bpy.types.Scene,
) -> tuple[tuple[str, float, tuple[Area, ...], tuple[str, ...] | None], ...]:
    """Return name, factor, areas and classes (None: all) of each focus, as they are typed."""
    rows = scene.perception_entropy.focus
    return tuple((row.name, as_typed(row.factor), _areas(row), _classes(row)) for row in rows)


def _prior_from_boxes(path: str) -> pe.Prior:
    if not path:
        raise pe.InputError("scene", "boxes", "a file of labelled boxes", "none chosen")
    prior = pe.Prior.from_boxes(pe.read_boxes(bpy.path.abspath(path)))
    # The name they get beside a study is part of what is reported, where they lie here is not.
    return replace(prior, boxes=replace(prior.boxes, file=None))


def _checked(prior: pe.Prior, number: int, row: bpy.types.PropertyGroup) -> list[pe.Focus]:
    """Return the focus of one row; errors say which row it is."""
    try:
        _check_classes(prior, row)
        return list(_focus_of(row))
    except pe.InputError as error:
        field = f"focus {number} ({row.name}): {error.field}"
        raise pe.InputError("scene", field, error.expected, error.found) from None


def _focus_of(row: bpy.types.PropertyGroup) -> Iterator[pe.Focus]:
    for x, y in _areas(row):
        yield pe.Focus(as_typed(row.factor), x, y, _classes(row))


def _areas(row: bpy.types.PropertyGroup) -> tuple[Area, ...]:
    """Return the areas that a row weighs."""
    if row.region != CUSTOM:
        return REGIONS[row.region].areas
    (x_low, x_high), (y_low, y_high) = (map(as_typed, v) for v in (row.x_range, row.y_range))
    return (((x_low, x_high), (y_low, y_high)),)


def _classes(row: bpy.types.PropertyGroup) -> tuple[str, ...] | None:
    """Return the classes that a row weighs, None for all, in the order of the menu."""
    known = [item.identifier for item in row.bl_rna.properties["classes"].enum_items]
    return None if row.classes == set(known) else tuple(c for c in known if c in row.classes)


def _check_classes(prior: pe.Prior, row: bpy.types.PropertyGroup) -> None:
    chosen = _classes(row)
    if chosen == ():
        raise pe.InputError("focus", "classes", "at least one class", "none")
    if chosen is not None and prior.model == UNIFORM:
        expected = "all classes, which the uniform prior does not tell apart"
        raise pe.InputError("focus", "classes", expected, ", ".join(chosen))
    for name in chosen or ():
        if name not in prior.class_names:
            raise pe.InputError("focus", "classes", f"some of {', '.join(prior.class_names)}", name)
