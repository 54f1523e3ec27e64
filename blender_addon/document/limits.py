"""Limits of a scene: a number and a lock for each figure that can have one, views of its table.

A lock of a figure whose limit has no number stands in the table, too, though it has no effect.
"""

from collections.abc import Mapping
from typing import Any

from bpy.types import PropertyGroup

from ..engine import search
from .study_table import document_of, put, value_at

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
    return document_of(settings, "limits").limits


def limit_of(settings: PropertyGroup, key: str) -> tuple[float | None, bool]:
    """Return the number of a figure's limit, or None, and whether it is locked."""
    found = value_at(settings.table, ("limits", key))
    if found is None:
        return None, not (can_be_kept_alone(key) or key in search.NUMBERED)
    if isinstance(found, Mapping):
        return found.get("value"), found.get("kept", True)
    return (None if found is True else found), True


def put_limit(settings: PropertyGroup, key: str, number: float | None, locked: bool) -> None:
    """Write a figure's limit."""
    usual = not (can_be_kept_alone(key) or key in search.NUMBERED)
    entry: Any = {"value": number, "kept": locked}
    if number is None:
        entry = None if locked == usual else {"kept": locked}
        entry = True if locked and can_be_kept_alone(key) else entry
    elif locked:
        entry = number
    put(settings, ("limits", key), entry)
