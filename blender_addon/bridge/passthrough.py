"""What an imported rig's file had besides the rig, as the scene keeps it: a text in JSON."""

from __future__ import annotations

import bpy

from ..engine import exchange


def passthrough_of(settings: bpy.types.PropertyGroup) -> exchange.Passthrough | None:
    """Return what is kept of the imported file; None where that is nothing.

    Raises
    ------
    InputError
        When something else stands there.
    """
    return exchange.passthrough_of_text(settings.passthrough, "scene")


def write_passthrough(settings: bpy.types.PropertyGroup, kept: exchange.Passthrough | None) -> None:
    """Have the scene keep it; None: nothing."""
    settings.passthrough = exchange.passthrough_text(kept)
