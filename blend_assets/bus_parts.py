"""Parts of the bus that are not skin: the shape of its wheels, the pod on its roof."""

from __future__ import annotations

import bus_profile as profile
import numpy as np
from curves import Array
from parts import Part, join, tube
from wheels import Wheel

WHEEL = Wheel(
    tyre=[(0.260, -0.106), (0.330, -0.1175), (0.366, -0.104), (0.380, -0.070),
          (0.380, 0.070), (0.366, 0.104), (0.330, 0.1175), (0.272, 0.112)],
    rim=[(0.272, 0.112), (0.254, 0.110), (0.246, 0.070)],
    disc=[(0.246, 0.070), (0.236, 0.040), (0.070, 0.034)],
    hub=[(0.092, 0.040), (0.089, 0.096), (0.072, 0.108)],
    spoke=[(0.065, 0.098, 0.034), (0.150, 0.101, 0.030), (0.254, 0.104, 0.042)],
    pairs=4,
    apart=0.24,
    segments=30,
)  # fmt: skip

POD_X = -0.15
POD_HALF = (1.25, 0.64)
POD_Z = (2.36, profile.HEIGHT - 0.004)
# Share of the half axes, share of the height: outline of the pod, from the roof upwards.
POD_RINGS = [(1.00, 0.00), (0.985, 0.45), (0.965, 0.70), (0.935, 0.87), (0.895, 0.965),
             (0.84, 1.00)]  # fmt: skip
POD_SQUARE = 0.34  # exponent of the superellipse: small is square
FANS = ((0.45, 0.27), (-0.45, 0.27))  # x from the pod's middle, radius


def superellipse(half: tuple[float, float], count: int, power: float) -> Array:
    """Points (count, 2) around an oblong with round corners."""
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    wave = np.column_stack([np.cos(angle), np.sin(angle)])
    return np.sign(wave) * np.abs(wave) ** power * half


def upright_rings(outline: Array, levels: list[tuple[float, float]]) -> Array:
    """The outline, scaled, at each of some (scale, height)."""
    return np.array(
        [np.column_stack([outline * scale, np.full(len(outline), z)]) for scale, z in levels]
    )


def pod() -> Part:
    """The air conditioning on the roof, with two fans."""
    low, high = POD_Z
    levels = [(scale, low + share * (high - low)) for scale, share in POD_RINGS]
    shell = tube(upright_rings(superellipse(POD_HALF, 48, POD_SQUARE), levels), "paint",
                 (True, True))  # fmt: skip
    shell = shell._replace(points=shell.points + np.array([POD_X, 0, 0]))
    return join(shell, *[fan(x, radius) for x, radius in FANS])


def fan(x: float, radius: float) -> Part:
    """A dark disc in the top of the pod."""
    circle = superellipse((1.0, 1.0), 28, 1.0)
    top = profile.HEIGHT
    levels = [(radius, top - 0.02), (radius, top)]
    disc = tube(upright_rings(circle, levels), "trim", (True, True))
    return disc._replace(points=disc.points + np.array([POD_X + x, 0, 0]))
