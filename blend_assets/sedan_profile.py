"""Numbers and surfaces of the example sedan (metres, x forward, y left, z up).

The body is an implicit solid: a point is inside where `solid(points) < 0`. It is the smooth
union of a lower body and a greenhouse, each a smooth intersection of a few fair surfaces
(side, top, nose, tail, roof, windscreen, rear glass) that are drawn by spline curves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from curves import Array, Curve, bump, smooth_max, step

LENGTH = 4.70
WIDTH = 1.85
HEIGHT = 1.45
WHEEL_RADIUS = 0.33
TYRE_WIDTH = 0.225
TRACK = 1.58
AXLES = {"front": 1.49, "rear": -1.31}  # x of the wheel centres: wheelbase 2.80
# wheel opening: a circle seen from the side
ARCH_RADIUS = 0.368
ARCH_Z = 0.338
WELL_Y = 0.54  # inner wall of the wheel housings
SPINE_Z = 0.55  # height of the axis from which cross sections are sampled


# --- lower body -----------------------------------------------------------------------------
# Half width in plan view: a slight waist at the doors, haunches over the wheels.
PLAN = Curve((-2.40, 0.800), (-2.00, 0.872), (-1.35, 0.911), (-0.60, 0.898), (0.20, 0.894),
             (0.90, 0.902), (1.45, 0.911), (1.90, 0.885), (2.40, 0.790))  # fmt: skip
# How far the side lies inside the half width, over the height above the ground.
SIDE = Curve((0.05, 0.110), (0.17, 0.058), (0.28, 0.026), (0.42, 0.016), (0.56, 0.008),
             (0.68, 0.000), (0.76, 0.004), (0.84, 0.024), (0.94, 0.072), (1.06, 0.150))  # fmt: skip
# The waistline climbs towards the tail by this much.
WEDGE = Curve((-2.40, 0.085), (-1.30, 0.075), (0.00, 0.030), (1.40, 0.000), (2.40, -0.060))
# Top of the lower body along the centre line: bonnet, belt, boot lid with a small lip.
TOP = Curve((2.42, 0.655), (2.20, 0.765), (1.90, 0.838), (1.50, 0.900), (1.10, 0.948),
            (0.80, 0.975), (0.00, 0.990), (-0.80, 1.010), (-1.50, 1.045), (-1.90, 1.062),
            (-2.15, 1.066), (-2.40, 1.082))  # fmt: skip
TOP_CROWN = Curve((2.40, 0.090), (1.50, 0.055), (0.80, 0.050), (-0.80, 0.050), (-2.40, 0.065))
# Nose and tail: how far they lie inside the length, over the height and over the width.
NOSE = Curve((0.10, 0.130), (0.18, 0.055), (0.26, 0.017), (0.38, 0.006), (0.50, 0.007),
             (0.60, 0.020), (0.68, 0.054), (0.76, 0.115), (0.95, 0.330))  # fmt: skip
TAIL = Curve((0.10, 0.200), (0.22, 0.085), (0.34, 0.020), (0.48, 0.000), (0.60, 0.010),
             (0.72, 0.036), (0.86, 0.064), (0.96, 0.064), (1.06, 0.038), (1.20, 0.010))  # fmt: skip
NOSE_PLAN = Curve(
    (-0.30, 0.018), (0.00, 0.000), (0.30, 0.018), (0.55, 0.070), (0.75, 0.170), (0.95, 0.380)
)
TAIL_PLAN = Curve(
    (-0.30, 0.012), (0.00, 0.000), (0.30, 0.012), (0.55, 0.050), (0.75, 0.120), (0.95, 0.290)
)
FLOOR = Curve((-2.40, 0.240), (-1.60, 0.170), (0.00, 0.150), (1.60, 0.155), (2.40, 0.190))
# The shoulder: a crease along the flank, this high (before the wedge) and this proud.
CREASE_Z = 0.705
CREASE = 0.014

# --- greenhouse -----------------------------------------------------------------------------
ROOF = Curve((1.20, 1.230), (0.70, 1.352), (0.20, 1.429), (-0.25, 1.450), (-0.70, 1.432),
             (-1.20, 1.360), (-1.80, 1.200))  # fmt: skip
ROOF_CROWN = 0.085  # drop of the roof at 0.6 m from the centre line
BELT_PLAN = Curve((1.30, 0.660), (0.90, 0.735), (0.30, 0.782), (-0.30, 0.795), (-0.90, 0.775),
                  (-1.50, 0.690), (-2.10, 0.560))  # fmt: skip
TUMBLEHOME = 0.46  # inward lean of the side glass, metres per metre
WINDSCREEN = (1.03, 0.955, 0.560)  # foot x, foot z, slope dz / dx (29 degrees)
REAR_GLASS = (-1.86, 1.055, 0.430)
# Lower edge of the side windows, a little above the joint of greenhouse and lower body.
BELT = Curve((1.20, 0.948), (0.80, 0.951), (0.40, 0.956), (0.00, 0.957), (-0.30, 0.961),
             (-0.60, 0.972), (-0.90, 0.990), (-1.20, 1.022), (-1.50, 1.060),
             (-2.00, 1.120))  # fmt: skip


class Terms(NamedTuple):
    """Signed distances, about metres, negative inside."""

    lower: Array  # the whole lower body
    cabin: Array  # the whole greenhouse
    cabin_side: Array  # side glass and its pillars
    cabin_top: Array  # windscreen, roof and rear glass together


def body_side(x: Array, z: Array) -> Array:
    """Half width of the lower body at this length and height."""
    height = z - WEDGE(x)
    doors = step(x, -1.15, -0.55) * step(x, 1.20, 0.60)
    scallop = 0.022 * bump(height, 0.43, 0.13) * doors
    sill = 0.012 * bump(z, 0.22, 0.06) * doors
    crease = CREASE * step(np.abs(x), 2.15, 1.75) * np.exp(-np.abs(height - CREASE_Z) / 0.075)
    return PLAN(x) - SIDE(height) - scallop + sill + crease


def body_top(x: Array, y: Array) -> Array:
    """Height of the bonnet, the belt and the boot lid, with two soft folds in the bonnet."""
    crown = TOP_CROWN(x) * (np.abs(y) / 0.8) ** 2.2
    fold = 0.014 * step(np.abs(y), 0.62 - 0.06 * x, 0.46 - 0.06 * x) * step(x, 0.6, 1.2)
    return TOP(x) - crown + fold * step(x, 2.35, 1.9)


def ends(x: Array, y: Array, z: Array) -> Array:
    """The bumper faces, front and rear."""
    width = np.abs(y)
    nose = x - (LENGTH / 2 - NOSE(z) - NOSE_PLAN(width))
    tail = -x - (LENGTH / 2 - TAIL(z) - TAIL_PLAN(width))
    return 0.9 * np.maximum(nose, tail)


def lower_body(x: Array, y: Array, z: Array) -> Array:
    """The body below the windows."""
    side = np.abs(y) - body_side(x, z)
    shell = smooth_max(side, ends(x, y, z), 0.13)
    radius = 0.07 - 0.035 * step(x, 1.7, 2.1)
    return smooth_max(shell, z - body_top(x, y), radius)


def cabin_top(x: Array, y: Array, z: Array) -> Array:
    """Windscreen, roof and rear glass as one rounded surface."""
    roof = z - (ROOF(x) - ROOF_CROWN * (y / 0.6) ** 2)
    foot, height, slope = WINDSCREEN
    screen = slope * (x - foot + 0.20 * (y / 0.7) ** 2) + z - height
    rear_foot, rear_height, rear_slope = REAR_GLASS
    rear = rear_slope * (rear_foot + 0.16 * (y / 0.6) ** 2 - x) + z - rear_height
    front = smooth_max(roof, screen / np.hypot(1, slope), 0.06)
    return smooth_max(front, rear / np.hypot(1, rear_slope), 0.08)


def cabin_side(x: Array, y: Array, z: Array) -> Array:
    """The leaning, slightly bowed side windows."""
    height = np.maximum(z - 0.95, 0)
    bow = 0.10 * height * (0.45 - height)
    lean = np.hypot(1, TUMBLEHOME)
    return (np.abs(y) - (BELT_PLAN(x) - TUMBLEHOME * height + bow)) / lean


def terms(points: Array) -> Terms:
    """All named surfaces at points (n, 3)."""
    x, y, z = points.T
    side = cabin_side(x, y, z)
    top = cabin_top(x, y, z)
    hidden = 0.86 + 0.11 * step(x, -1.1, -1.7) - z  # the cabin ends inside the lower body
    cabin = smooth_max(smooth_max(side, top, 0.07), hidden, 0.02)
    return Terms(lower_body(x, y, z), cabin, side, top)


def solid(points: Array) -> Array:
    """Less than zero inside the car; the boot flows out of the rear pillars in a wide fillet."""
    part = terms(points)
    x = points[:, 0]
    fillet = 0.006 + 0.11 * step(x, -0.8, -1.6)
    return -smooth_max(-part.lower, -part.cabin, fillet)
