"""Limits of a scene: a number and a lock for each figure that can have one."""

from bpy.types import PropertyGroup

from ..engine import search
from .scene_settings import as_typed

NONE = -100
"""A field with this value or a lower one is no limit: 0 may be one."""


def limit_property(key: str) -> str:
    """Return the name of the property with the number of a figure's limit."""
    return f"limit_{key}"


def keep_property(key: str) -> str:
    """Return the name of the property that locks a figure."""
    return f"keep_{key}"


def can_be_kept_alone(key: str) -> bool:
    """Whether a figure is kept as it is at the start where its limit has no number."""
    return key in search.KEPT or key == search.REQUIREMENTS


def limits_of(settings: PropertyGroup) -> search.Limits:
    """Return the limits of a scene."""
    found = {key: _limit_of(settings, key) for key in search.LIMITED}
    return search.Limits(**found)


def _limit_of(settings: PropertyGroup, key: str) -> search.Limit | None:
    kept = getattr(settings, keep_property(key))
    number = getattr(settings, limit_property(key), NONE)
    if number <= NONE:
        return search.Limit() if kept and can_be_kept_alone(key) else None
    value = as_typed(number) if isinstance(number, float) else number
    return search.Limit(value, kept)


def write_limits(settings: PropertyGroup, limits: search.Limits) -> None:
    """Write limits to a scene."""
    for key in search.LIMITED:
        limit = limits.limit_on(key)
        is_locked = limit.kept if limit is not None else not can_be_kept_alone(key)
        setattr(settings, keep_property(key), is_locked)
        if key != search.REQUIREMENTS:
            number = None if limit is None else limit.value
            setattr(settings, limit_property(key), NONE if number is None else number)
