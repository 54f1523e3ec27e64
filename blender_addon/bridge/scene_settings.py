"""A scene's settings as values of the engine: read for a study, written by an import.

Numbers and switches follow the engine's declarations (`Setting.panel` names the property). Values
that a scene stores in a different form than a study file have separate functions here.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from bpy.types import PropertyGroup, Scene

from ..choices import EXPECTED_AP, OBJECTS
from ..engine import kinds, pe, search, studies

LARGEST_INT = 2**31 - 1  # A property holds no larger whole number
PLACED = frozenset({"score_samples", "targets", "traffic", "scenes"})
"""Settings with a place of their own in the signature of a scene."""


def as_typed(value: float) -> float:
    """Return the shortest decimal number that a property of single precision stands for."""
    return float(str(np.float32(value)))


def pair_as_typed(values: Sequence[float]) -> tuple[float, float]:
    """Return the shortest decimal numbers of a pair of values."""
    low, high = map(as_typed, values)
    return low, high


def values_of(
    settings: PropertyGroup, cls: Any, names: Iterable[str] = (), prefix: str = ""
) -> dict[str, Any]:
    """Return the settings of a dataclass that a group of properties holds, by their fields' names.
    An optional setting is None if its property is 0, off or at the menu's entry for it; angles are
    converted to radians. `prefix` is before the properties' names."""
    return {
        setting.name: value_of_property(setting, getattr(settings, f"{prefix}{name}"))
        for name, setting in _in_panel(cls, names)
    }


def write_values(settings: PropertyGroup, instance: Any, names: Iterable[str] = ()) -> None:
    """Write the settings of a dataclass to a group of properties: the inverse of `values_of`."""
    for name, setting in _in_panel(type(instance), names):
        setattr(settings, name, property_value(setting, getattr(instance, setting.name)))


def _in_panel(cls: Any, names: Iterable[str] = ()) -> Iterator[tuple[str, studies.Setting]]:
    """Yield the settings of a dataclass that have a property, with the property's name."""
    declared = studies.settings_of(cls)
    for name in names or declared:
        if (panel := declared[name].panel) is not None:
            yield panel.property or name, declared[name]


def value_of_property(setting: studies.Setting, value: Any) -> Any:
    """Return a property's value in the unit and type of the engine."""
    rule: Any = setting.rule
    panel = setting.panel
    if isinstance(rule, studies.Pair):
        return pair_as_typed(value)
    if isinstance(rule, studies.Several):
        return tuple(text for text in rule.among if text in value)
    if isinstance(rule, studies.Texts):
        return tuple(text.strip() for text in value.split(",") if text.strip())
    if isinstance(rule, studies.Name):
        return value.strip()
    if studies.is_switch(setting):
        return rule.among[0] if value else None
    if panel is not None and panel.absent is not None and value == panel.absent[0]:
        return None
    if isinstance(rule, studies.Number):
        value = as_typed(value)
    if setting.is_optional and (value < rule.minimum if panel and panel.none else not value):
        return None
    return math.radians(value) if isinstance(rule, studies.Angle) else value


def property_value(setting: studies.Setting, value: Any) -> Any:
    """Return an engine's value as its property holds it."""
    rule = setting.rule
    panel = setting.panel
    if isinstance(rule, studies.Several):
        return set(value)
    if isinstance(rule, studies.Texts):
        return ", ".join(value)
    if studies.is_switch(setting):
        return value is not None
    if value is None:
        return 0 if panel is None else panel.none if panel.absent is None else panel.absent[0]
    if isinstance(rule, studies.Whole):
        return min(value, LARGEST_INT)
    return math.degrees(value) if isinstance(rule, studies.Angle) else value


def space_of(settings: PropertyGroup) -> pe.PerceptionSpace:
    """Return the space that a scene's settings describe. `InputError` when a bound is not below the
    other, or the voxels do not fit."""
    try:
        return pe.PerceptionSpace(**values_of(settings, pe.PerceptionSpace))
    except pe.InputError as error:
        raise error.within("scene", "space") from None


def perception_of(settings: PropertyGroup) -> pe.PerceptionModel:
    """Return the AP curves of a scene; a kind without a curve has its default curve."""
    curves: dict[str, Any] = {
        row.name: pe.ApCurve(**values_of(row, pe.ApCurve))
        for row in settings.curves
        if row.own and row.name in kinds.KINDS
    }
    return pe.PerceptionModel(**values_of(settings, pe.PerceptionModel), **curves)


def clearance_of(scene: Scene) -> float:
    """Return how far a flush-mounted sensor counts as protruding from the surface [m]."""
    return values_of(scene.perception_entropy, pe.Vehicle)["clearance"]


def targets_of(settings: PropertyGroup) -> pe.TargetRule:
    """Return whether voxels or objects are scored; traffic concerns objects alone. So do scenes,
    unless a search goes by the expected AP of objects."""
    if settings.targets != OBJECTS:
        by_ap = settings.objective == EXPECTED_AP
        return pe.TargetRule(scenes=settings.scenes) if by_ap else pe.TargetRule()
    return pe.TargetRule(**values_of(settings, pe.TargetRule))


def search_of(settings: PropertyGroup, *, is_choice: bool) -> pe.Search:
    """Return the settings of a scene's search, without its sensors and mounts. The schedule is the
    scene's where one is used: by the method, or to screen a choice of sensors."""
    is_scheduled = is_choice or settings.method == search.SCHEDULED_METHOD
    schedule = pe.Schedule(**values_of(settings, pe.Schedule)) if is_scheduled else pe.Schedule()
    values = values_of(settings, pe.Tolerance)
    if not settings.mounting_errors:
        values |= {"position": 0.0, "angle": 0.0}
    grid = pe.MountingGrid(**values_of(settings, pe.MountingGrid))
    several = values["position"] > 0.0 or values["angle"] > 0.0 or values["failures"]
    return pe.Search(
        schedule=schedule,
        method=settings.method,
        tolerance=pe.Tolerance(**values | {"worst": values["worst"] and several}),
        grid=grid if settings.on_grid else pe.MountingGrid(),
        goals=search.Goals(
            search.Stop(**values_of(settings, search.Stop)),
            starts=search.Start.of_text(settings.start_poses),
            front=search.Front(**values_of(settings, search.Front)),
            **values_of(settings, search.Goals),
        ),
        **values_of(settings, pe.Search),
    )


def write_goals(settings: PropertyGroup, goals: search.Goals) -> None:
    """Write the goals of a search to a scene; further starts as JSON text."""
    for each in (goals.stop, goals.front, goals):
        write_values(settings, each)
    settings.start_poses = search.Start.text_of(goals.starts)
    settings.start_variants = False


def reference_of(settings: PropertyGroup) -> pe.Reference | None:
    """Return the positions of the axles; None if the scene does not have them."""
    return pe.Reference(**values_of(settings, pe.Reference)) if settings.axles_known else None


def write_reference(settings: PropertyGroup, reference: pe.Reference | None) -> None:
    """Write the positions of the axles; None removes them."""
    settings.axles_known = reference is not None
    if reference is not None:
        write_values(settings, reference)


def settings_signature(settings: PropertyGroup) -> list[object]:
    """Return the settings of a score that were set, including invalid ones."""
    scored = (
        setting.panel.property
        for _, setting, *_ in studies.setting_keys(of_scene=True)
        if setting.scored and setting.panel is not None
    )
    names = [each for each in scored if each not in PLACED and settings.is_property_set(each)]
    values = [_plain(getattr(settings, name)) for name in names]
    curves = [(r.name, *map(as_typed, (r.a, r.b, r.c))) for r in settings.curves if r.own]
    return [*zip(names, values, strict=True), *curves]


def targets_signature(settings: PropertyGroup) -> list[object]:
    """Return the settings of targets if they differ from the paper's voxels."""
    rule = targets_of(settings)
    return [rule.targets, rule.traffic, rule.scenes] if rule.are_objects else []


def _plain(value: Any) -> object:
    """Return a property's value as the decimal number that was typed."""
    if isinstance(value, float):
        return as_typed(value)
    return value if isinstance(value, int | str) else pair_as_typed(value)
