"""Beams that return: what of a body's box is open, and which pulses are too weak.

m as the paper has it is a number of beams. Of a LiDAR whose `returns` are "road", m is the expected
number of points. A beam through the box of a body of class c ends on it with probability `fill`,
else it goes on to what is behind. A pulse that ends at a distance R returns with ``P ~ rho / R^2``
(the lidar equation, as in `sensors.weather`), and is found while P is above the threshold of the
receiver. With log-normal reflectivities rho that is ``Phi(2 ln(half / R) / SPREAD)`` of the pulses;
`half` is the distance from which half of them return.

Both are fitted to the points of two LiDARs in real traffic (docs/validity/road): of bodies by
class, of voxels and of other classes for all bodies together.
"""

import math

import numpy as np

from ...base.arrays import Floats, Ints
from ...scene.objects import Objects

ANY = ""  # Any class
SURFACES = {
    ANY: (0.45, 63.1),
    "car": (0.525, 50.1),
    "truck": (0.6, 141.3),
    "pedestrian": (0.3, 100.0),
    "cyclist": (0.325, 1000.0),
    "cone": (0.45, 63.1),
    "bollard": (0.35, 1000.0),
    "sign": (0.2, 1000.0),
}
"""`fill` and `half` [m] by class, fitted to three logs: docs/validity/road/results.json."""
SPREAD = 1.5
"""Standard deviation of ln rho: reflectivities of 3 to 60 % are two of them apart."""
LEAST = 0.5
"""An object of which a LiDAR expects fewer points is not seen: bodies let some beams through."""
NEAREST_M = 1e-3
STEPS = np.linspace(-6.0, 6.0, 1201)
PHI = np.array([0.5 * math.erfc(-x / math.sqrt(2.0)) for x in STEPS.tolist()])
"""The normal distribution, of which values between are interpolated."""


def return_probability(distance: Floats, half: Floats | float) -> Floats:
    """Return the share (...) of the pulses that return from distances (...) [m]."""
    power = 2.0 * np.log(half / np.maximum(distance, NEAREST_M))
    return np.interp(power / SPREAD, STEPS, PHI)


def surfaces(objects: Objects) -> tuple[Floats, Floats]:
    """Return `fill` (N,) and `half` (N,) [m] of objects."""
    known = np.array([SURFACES.get(name, SURFACES[ANY]) for name in objects.class_names])
    fill, half = known[objects.labels].T
    return fill, half


def share_of_points(offsets: Floats, objects: Objects | None = None) -> Floats:
    """Return the points (V,) that a beam is worth in voxels or cells at offsets (V, 3) [m]."""
    fill, half = SURFACES[ANY] if objects is None else surfaces(objects)
    return fill * return_probability(np.sqrt((offsets * offsets).sum(axis=-1)), half)


def expected_points(
    hits: tuple[Ints, Ints, Floats], objects: Objects, scenes: Ints, min_range: float
) -> Floats:
    """Return the expected points (N,) on objects of beams that enter them. `hits` (H,) each are
    box, beam, and the distance at which it enters [m]; `scenes` (N,): objects of one scene take
    beams from each other. Below `LEAST` no point is expected, and it is 0."""
    box, beam, enter = hits
    fill, half = surfaces(objects)
    reaching = passed(box, beam, enter, scenes=scenes, fill=fill[box])
    points = reaching * fill[box] * return_probability(enter, half[box])
    points[enter < min_range] = 0.0
    found = np.bincount(box, points, len(objects)).astype(float)
    found[found < LEAST] = 0.0
    return found


def passed(box: Ints, beam: Ints, enter: Floats, scenes: Ints, fill: Floats) -> Floats:
    """Return the share (H,) of each beam that nearer boxes of its scene have let through. A beam
    enters a box at a distance, (H,) each; `scenes` (N,) are those of the boxes, `fill` (H,)."""
    order = np.lexsort((box, enter, beam, scenes[box]))
    beam = beam[order]
    scene = scenes[box][order]
    kept = 1.0 - fill[order]
    same = np.zeros(len(order), bool)
    same[1:] = (beam[1:] == beam[:-1]) & (scene[1:] == scene[:-1])
    index = np.arange(len(order))
    rank = index - np.maximum.accumulate(np.where(same, 0, index))
    share = np.ones(len(order))
    for k in range(1, int(rank.max(initial=0)) + 1):
        now = np.flatnonzero(rank == k)
        share[now] = share[now - 1] * kept[now - 1]
    result = np.empty(len(order))
    result[order] = share
    return result
