"""Have editors drawn anew, in every window."""

from __future__ import annotations

import bpy


def editors(kind: str = "VIEW_3D") -> None:
    """Have every editor of a kind drawn anew; all 3D views by default."""
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type == kind:
                    area.tag_redraw()
