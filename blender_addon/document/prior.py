"""The scene's prior with its focus weights w(s, c): regions and classes that count more."""

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import replace

import bpy
from bpy.types import PropertyGroup, Scene

from ..choices import CUSTOM, FROM_BOXES, HIGHWAY, REGIONS, ROAD, UNIFORM, FocusArea, FocusRegion
from ..engine import formats, pe
from .study_table import as_typed

MODELS = {ROAD: pe.Prior.road, HIGHWAY: pe.Prior.highway, UNIFORM: pe.Prior.uniform}


def prior_from_scene(scene: Scene) -> pe.Prior:
    """Return the scene's prior, focus weights included. `InputError` when boxes cannot be read, or
    a focus is no possible one; the line names the file, or the focus by its place in the list."""
    settings = scene.perception_entropy
    from_boxes = settings.prior == FROM_BOXES
    prior = _prior_from_boxes(settings.boxes) if from_boxes else MODELS[settings.prior]()
    rows = enumerate(settings.focus, start=1)
    return replace(prior, focus=tuple(f for n, row in rows for f in _checked(prior, n, row)))


def prior_signature(scene: Scene) -> list[object]:
    """Return the settings that the prior depends on, including invalid focus weights."""
    settings = scene.perception_entropy
    rows = [(as_typed(row.factor), _areas(row), _classes(row)) for row in settings.focus]
    boxes = [settings.boxes] if settings.prior == FROM_BOXES else []
    return [settings.prior, *boxes, *rows]


def prior_key(scene: Scene) -> str:
    """Return a cache key of the prior, valid as long as the file of boxes does not change."""
    return repr(prior_signature(scene))


def focus_regions(scene: Scene) -> tuple[FocusRegion, ...]:
    """Return the focus weights of a scene, wrong ones included."""
    rows = scene.perception_entropy.focus
    return tuple(FocusRegion(r.name, as_typed(r.factor), _areas(r), _classes(r)) for r in rows)


def write_prior(settings: PropertyGroup, prior: pe.Prior) -> None:
    """Write a prior's model and its focus weights to a scene. A prior of labelled boxes and a focus
    on a class that is not in the menu are left out."""
    with contextlib.suppress(TypeError):  # the menu does not have the model
        settings.prior = prior.model
    settings.focus.clear()
    for number, (region, focus) in enumerate(_by_region(prior.focus), start=1):
        row = settings.focus.add()
        row.name = f"Focus {number}"
        row.factor = focus.factor
        row.region = region
        row.x_range = focus.x
        row.y_range = focus.y
        if focus.classes is not None:
            with contextlib.suppress(TypeError):  # the menu does not have the class
                row.classes = set(focus.classes)


def _by_region(weights: Sequence[pe.Focus]) -> Iterator[tuple[str, pe.Focus]]:
    """Yield focus weights with their region in the menu; several areas may form one region."""
    left = list(weights)
    while left:
        first = left[0]
        for region in REGIONS.values():
            same = [replace(first, x=x, y=y) for x, y in region.areas]
            if same and left[: len(same)] == same:
                break
        else:
            region = REGIONS[CUSTOM]
            same = [first]
        yield region.key, first
        del left[: len(same)]


def _prior_from_boxes(path: str) -> pe.Prior:
    if not path:
        raise pe.InputError("scene", "boxes", "a file of labelled boxes", "none chosen")
    prior = pe.Prior.from_boxes(formats.read_boxes(bpy.path.abspath(path)))
    # The name they get beside a study is part of what is reported, where they lie here is not.
    boxes = prior.boxes
    return prior if boxes is None else replace(prior, boxes=replace(boxes, file=None))


def _checked(prior: pe.Prior, number: int, row: PropertyGroup) -> list[pe.Focus]:
    """Return the focus weights of one row, one for each area; errors name the row."""
    try:
        _check_classes(prior, row)
        return list(_focus_of(row))
    except pe.InputError as error:
        raise error.within("scene", f"focus {number} ({row.name})") from None


def _focus_of(row: PropertyGroup) -> Iterator[pe.Focus]:
    for x, y in _areas(row):
        yield pe.Focus(as_typed(row.factor), x, y, _classes(row))


def _areas(row: PropertyGroup) -> tuple[FocusArea, ...]:
    """Return the areas of a focus weight."""
    if row.region != CUSTOM:
        return REGIONS[row.region].areas
    (x_low, x_high), (y_low, y_high) = (map(as_typed, v) for v in (row.x_range, row.y_range))
    return (((x_low, x_high), (y_low, y_high)),)


def _classes(row: PropertyGroup) -> tuple[str, ...] | None:
    """Return the classes of a focus weight in the order of the menu; None for all classes."""
    names = [item.identifier for item in row.bl_rna.properties["classes"].enum_items]
    return None if row.classes == set(names) else tuple(c for c in names if c in row.classes)


def _check_classes(prior: pe.Prior, row: PropertyGroup) -> None:
    classes = _classes(row)
    if classes == ():
        raise pe.InputError("focus", "classes", "at least one class", "none")
    if classes is not None and prior.model == UNIFORM:
        expected = "all classes, which the uniform prior does not tell apart"
        raise pe.InputError("focus", "classes", expected, ", ".join(classes))
    for name in classes or ():
        if name not in prior.class_names:
            raise pe.InputError("focus", "classes", f"some of {', '.join(prior.class_names)}", name)
