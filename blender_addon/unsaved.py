"""Whether the scene still is the variant that was put there, and whose score still stands.

Looked at once things rest: the list of variants shows it.
"""

from __future__ import annotations

import bpy

from . import bridge, changes, stale


def check() -> None:
    """Look at every scene that has variants."""
    for scene in bpy.data.scenes:
        if scene.perception_entropy.variants and bridge.view_layer_of(scene).depsgraph is not None:
            bridge.check_variants(scene, stale.fingerprint(scene))


def register() -> None:
    """Start listening."""
    changes.rested.connect(check)


def unregister() -> None:
    """Stop listening."""
    changes.rested.disconnect(check)
