"""Where a scene's vehicle has its axles."""

from __future__ import annotations

import bpy

from ..engine import pe
from .typed import as_typed

KEYS = ("rear_axle_x", "rear_axle_z", "wheelbase", "front_overhang", "rear_overhang")
NEEDED = 2
"""How many of them, from the first on, are always known."""


def reference_of(settings: bpy.types.PropertyGroup) -> pe.Reference | None:
    """Return where the axles are, as the settings say; None where they say nothing."""
    if not settings.axles_known:
        return None
    values = [as_typed(getattr(settings, key)) for key in KEYS]
    return pe.Reference(*values[:NEEDED], *(value or None for value in values[NEEDED:]))


def write_reference(settings: bpy.types.PropertyGroup, reference: pe.Reference | None) -> None:
    """Have the settings say where the axles are; None: nothing of them."""
    settings.axles_known = reference is not None
    for key in KEYS if reference is not None else ():
        setattr(settings, key, getattr(reference, key) or 0.0)
