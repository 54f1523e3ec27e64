"""STL, binary: one solid a file, metres in the ground frame."""

from __future__ import annotations

import numpy as np

from .solid import Solid

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER_BYTES = 80


def stl_bytes(solid: Solid) -> bytes:
    """Return a solid as a file; its normals point outwards."""
    corners = solid.points.astype(np.float32)[solid.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).astype(float)
    length = np.sqrt((normal**2).sum(axis=1, keepdims=True))
    facets = np.zeros(len(corners), FACET)
    facets["corners"] = corners
    facets["normal"] = normal / np.where(length > 0.0, length, 1.0)
    # The name last: "solid" is how an ASCII file begins.
    header = f"metres, x forward, y left, z up: {solid.name}".encode("ascii", "replace")
    count = len(facets).to_bytes(4, "little")
    return header[:HEADER_BYTES].ljust(HEADER_BYTES) + count + facets.tobytes()
