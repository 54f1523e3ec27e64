"""First hits by embree, a yardstick: embreex of the extra `dev`, on one thread."""

from __future__ import annotations

import numpy as np

RAYS_AT_ONCE = 1 << 20


class Embree:
    """Triangles in embree's tree."""

    def __init__(self, scene: object) -> None:
        self._scene = scene

    @classmethod
    def of(cls, triangles: np.ndarray) -> Embree | None:
        """Build the tree of triangles (F, 3, 3); None where embreex is not installed."""
        try:
            from embreex.mesh_construction import TriangleMesh
            from embreex.rtcore_scene import EmbreeScene
        except ImportError:
            return None
        scene = EmbreeScene()
        TriangleMesh(scene, np.ascontiguousarray(triangles, dtype=np.float32))
        embree = cls(scene)
        embree.first_hit((0.0, 0.0, 0.0), np.eye(3))  # it is built when it is first asked
        return embree

    def first_hit(self, position: tuple[float, float, float], directions: np.ndarray) -> np.ndarray:
        """Triangle (B,) that each ray meets first, -1 for none."""
        parts = [
            self._some(position, directions[start : start + RAYS_AT_ONCE])
            for start in range(0, len(directions), RAYS_AT_ONCE)
        ]
        return np.concatenate(parts)

    def _some(self, position: tuple[float, float, float], directions: np.ndarray) -> np.ndarray:
        origins = np.tile(np.asarray(position, np.float32), (len(directions), 1))
        return self._scene.run(origins, directions.astype(np.float32))  # type: ignore[attr-defined]
