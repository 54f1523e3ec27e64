"""Parts of the sedan that are not skin: the shape of its wheels, its mirrors."""

from __future__ import annotations

import numpy as np
from parts import Part, join, tube
from wheels import Wheel

WHEEL = Wheel(
    tyre=[(0.205, -0.095), (0.240, -0.106), (0.290, -0.1125), (0.318, -0.100), (0.330, -0.070),
          (0.330, 0.070), (0.318, 0.100), (0.290, 0.1125), (0.246, 0.108)],
    rim=[(0.246, 0.108), (0.238, 0.110), (0.228, 0.102), (0.220, 0.060)],
    disc=[(0.220, 0.060), (0.212, 0.030), (0.060, 0.022)],
    hub=[(0.066, 0.030), (0.064, 0.088), (0.050, 0.098), (0.022, 0.100)],
    spoke=[(0.045, 0.092, 0.020), (0.130, 0.095, 0.016), (0.229, 0.100, 0.020)],
    pairs=5,
    apart=0.20,
    segments=36,
)  # fmt: skip


def mirror() -> Part:
    """The left door mirror: a rounded housing with a flat glass, on a short foot."""
    # y, centre x, centre z, half depth, half height
    stations = [(0.842, 0.672, 1.000, 0.026, 0.028), (0.862, 0.670, 1.006, 0.062, 0.056),
                (0.900, 0.664, 1.010, 0.076, 0.068), (0.955, 0.654, 1.012, 0.074, 0.068),
                (0.995, 0.644, 1.013, 0.060, 0.058),
                (1.015, 0.636, 1.013, 0.030, 0.034)]  # fmt: skip
    angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    cos = np.cos(angle)
    sin = np.sin(angle)
    cos = np.sign(cos) * np.abs(cos) ** 0.8
    sin = np.sign(sin) * np.abs(sin) ** 0.8
    rings = [np.column_stack([x + np.maximum(cos * dx, -0.045), np.full(16, y), z + sin * dz])
             for y, x, z, dx, dz in stations]  # fmt: skip
    head = tube(np.array(rings), "paint", (True, True))
    corner = head.points[head.triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    glass = normal[:, 0] < -0.97 * np.linalg.norm(normal, axis=1)
    head = head._replace(materials=["glass" if flag else "paint" for flag in glass])
    return join(head, mirror_foot())


def mirror_foot() -> Part:
    """A tapered arm from the door to the housing."""
    angle = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    rings = [np.column_stack([x + dx * np.cos(angle), np.full(8, y), z + dz * np.sin(angle)])
             for y, x, z, dx, dz in ((0.765, 0.690, 0.962, 0.050, 0.020),
                                     (0.880, 0.672, 0.985, 0.034, 0.016))]  # fmt: skip
    return tube(np.array(rings), "trim", (True, True))
