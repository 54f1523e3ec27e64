"""The table of kinds: which there are, and which one a sensor is of."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..errors import InputError, shown
from ..scene.sensors import Sensor, SensorModel
from .kind import Kind

_kinds: dict[str, Kind] = {}
KINDS: Mapping[str, Kind] = MappingProxyType(_kinds)
"""All kinds by name, in the order in which they were registered: LiDAR, camera, others."""


def register(kind: Kind) -> None:
    """Add a kind; from then on its sensors can be studied, scored, searched and shown.

    Raises
    ------
    InputError
        When there is a kind of that name, or the model class names another one.
    """
    if kind.name in _kinds:
        raise InputError("kinds", "name", "a name used once", repr(kind.name))
    if getattr(kind.model, "kind", None) != kind.name:
        found = repr(getattr(kind.model, "kind", None))
        raise InputError(f"kind {kind.name!r}", "model.kind", repr(kind.name), found)
    _kinds[kind.name] = kind


def unregister(name: str) -> None:
    """Take a kind away again; do nothing if there is none of that name."""
    _kinds.pop(name, None)


def kind_named(name: object, source: str, field: str = "kind") -> Kind:
    """Return the kind of that name; `source` and `field` say where it was named.

    Raises
    ------
    InputError
        When there is no such kind.
    """
    found = _kinds.get(name) if isinstance(name, str) else None
    if found is None:
        raise InputError(source, field, f"one of {', '.join(_kinds)}", shown(name))
    return found


def kind_of(sensor: Sensor | SensorModel) -> Kind:
    """Return the kind of a sensor, or of its model.

    Raises
    ------
    InputError
        When its kind is not in the table.
    """
    return kind_named(getattr(sensor, "kind", None), sensor.name)
