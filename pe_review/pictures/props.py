"""People and cars of known size, to see how large they are in a sensor's picture."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..engine import pe
from .painted import GLASS, TAIL, TYRE, Paint, PaintedBody
from .shapes import capped, lathe

Floats = NDArray[np.float64]

PERSON_M = (0.5, 0.5, 1.75)
"""Length, width and height of a person."""
CAR_M = (4.5, 1.8, 1.5)
"""And of a car; about the mean of those on the road."""
SKIN, COAT = Paint((0.55, 0.36, 0.25)), Paint((0.80, 0.36, 0.02))
TROUSERS = Paint((0.10, 0.11, 0.14))
CAR_PAINT = Paint((0.03, 0.14, 0.38), 0.6)
ROUND = 16
PaintedParts = tuple[tuple[Floats, Paint], ...]


def person(x: float, y: float, heading: float) -> PaintedBody:
    """Return a person standing at a place [m], facing a heading [rad]."""
    legs = [_limb(side * 0.09, ((0.0, 0.07), (0.45, 0.065), (0.88, 0.09))) for side in (1, -1)]
    arm = ((0.74, 0.04), (1.1, 0.047), (1.36, 0.06), (1.44, 0.03))
    arms = [_limb(side * 0.225, arm) for side in (1, -1)]
    shape = ((0.82, 0.12, 0.17), (1.05, 0.11, 0.16), (1.35, 0.13, 0.21), (1.46, 0.09, 0.17))
    torso = capped([_oval(*ring) for ring in (*shape, (1.52, 0.06, 0.06))])
    head = _ball(1.625, 0.10, 0.125)
    groups = (
        (head, SKIN),
        (np.concatenate([torso, *arms]), COAT),
        (np.concatenate(legs), TROUSERS),
    )
    return _placed(groups, x, y, heading)


def car(x: float, y: float, heading: float) -> PaintedBody:
    """Return a car whose middle is at a place [m], heading that way [rad]."""
    lower = ((0.22, 2.15, 0.78), (0.34, 2.25, 0.88), (0.72, 2.23, 0.90), (0.90, 2.12, 0.84))
    body = capped([_rounded(z, x0, y0, 0.0) for z, x0, y0 in lower])
    upper = ((0.88, 1.45, 0.80), (1.44, 0.98, 0.64), (1.43, 0.99, 0.65), (1.5, 0.80, 0.52))
    cabin, roof = (
        capped([_rounded(*ring, -0.25) for ring in pair]) for pair in (upper[:2], upper[2:])
    )
    wheels = np.concatenate([_wheel(x0, y0) for x0 in (1.35, -1.35) for y0 in (0.80, -0.80)])
    lamps = np.concatenate([_lamp(y0) for y0 in (0.62, -0.62)])
    painted = np.concatenate([body, roof])
    groups = ((painted, CAR_PAINT), (cabin, GLASS), (wheels, TYRE), (lamps, TAIL))
    return _placed(groups, x, y, heading)


def _placed(groups: PaintedParts, x: float, y: float, heading: float) -> PaintedBody:
    c, s = math.cos(heading), math.sin(heading)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    triangles = np.concatenate([each for each, _ in groups])
    placed = np.einsum("ij,fkj->fki", turn, triangles) + np.array([x, y, 0.0])
    parts = np.repeat(np.arange(len(groups)), [len(each) for each, _ in groups])
    names = [f"part {k}" for k in range(len(groups))]
    return PaintedBody(pe.Vehicle(placed, parts, names), tuple(paint for _, paint in groups))


def _oval(z: float, deep: float, wide: float) -> Floats:
    turn = np.arange(ROUND) * 2.0 * np.pi / ROUND
    return np.column_stack([deep * np.cos(turn), wide * np.sin(turn), np.full(ROUND, z)])


def _limb(y: float, rings: tuple[tuple[float, float], ...]) -> Floats:
    return capped([_oval(z, r, r) for z, r in rings]) + np.array([0.0, y, 0.0])


def _ball(z: float, radius: float, high: float) -> Floats:
    turn = np.linspace(-np.pi / 2.0, np.pi / 2.0, 9)
    return lathe([(radius * math.cos(t), z + high * math.sin(t)) for t in turn.tolist()], ROUND)


def _rounded(z: float, long: float, wide: float, x: float) -> Floats:
    """A ring round a car at a height: between an oval and a rectangle."""
    turn = (np.arange(2 * ROUND) + 0.5) * np.pi / ROUND
    c, s = np.cos(turn), np.sin(turn)
    right, left = (np.sign(w) * np.abs(w) ** 0.4 for w in (c, s))
    return np.column_stack([right * long + x, left * wide, np.full(len(turn), z)])


def _wheel(x: float, y: float) -> Floats:
    disc = lathe([(0.0, -0.1), (0.33, -0.1), (0.33, 0.1), (0.0, 0.1)], ROUND)
    return np.stack([disc[..., 0] + x, disc[..., 2] + y, disc[..., 1] + 0.33], axis=-1)


def _lamp(y: float) -> Floats:
    ring = np.array([[0.0, 0.14, 0.0], [0.0, -0.14, 0.0], [-0.03, -0.14, 0.0], [-0.03, 0.14, 0.0]])
    rings = [ring + np.array([-2.2, y, z]) for z in (0.68, 0.82)]
    return capped(rings)
