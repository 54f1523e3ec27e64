"""What the extension's preferences say, and what holds where there are none, as in scripts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import bpy

from .engine import catalog, graphics, pe

COLORS = {"free_color": "free", "blocked_color": "occluded", "blind_color": "blind"}
"""Properties of colours, and the fields of the palette that they are."""
LIVE_BUDGET_MS = 20.0
"""A frame at 50 Hz: a move of a LiDAR on the roof of a sedan is scored exactly within it."""


def stored() -> bpy.types.AddonPreferences | None:
    """Return the preferences; None where the add-on is not enabled in Blender's own."""
    addon = bpy.context.preferences.addons.get(__package__)
    return None if addon is None else addon.preferences


def is_updated() -> bool:
    """Whether the extension is newer than the version whose news the user has seen."""
    return getattr(stored(), "seen_version", pe.__version__) != pe.__version__


def mark_seen() -> None:
    """Store that the news of this version were seen; a restart keeps it."""
    if (preferences := stored()) is not None:
        preferences.seen_version = pe.__version__
        bpy.context.preferences.is_dirty = True


def palette() -> graphics.Palette:
    """Return the colours of the overlay: those of the preferences; told apart by colour-blind."""
    chosen = stored()
    if chosen is None:
        return graphics.VIEWPORT
    own = {
        field: tuple(round(share, 4) for share in getattr(chosen, name))
        for name, field in COLORS.items()
    }
    return replace(graphics.VIEWPORT, **own)


def preferred_model(kind: str) -> str:
    """Return the model of a kind that the preferences name; "" without one in the catalogue."""
    model = getattr(stored(), f"{kind}_model", "")
    return model if model in catalog.names(kind) else ""


def in_results_folder(filepath: str, otherwise: str) -> str:
    """Return the path that a file dialog begins with: in the preferred folder, if there is one.

    An absolute path is returned as it is; `otherwise` is the file's name where the path is "".
    """
    folder = getattr(stored(), "results_folder", "")
    if not folder or Path(filepath).is_absolute() or filepath.startswith("//"):
        return filepath
    return str(Path(bpy.path.abspath(folder)) / (filepath or otherwise))


def live_budget_s() -> float:
    """Return how long an update of the live score may take while something moves [s]."""
    return float(getattr(stored(), "live_budget_ms", LIVE_BUDGET_MS)) / 1000.0
