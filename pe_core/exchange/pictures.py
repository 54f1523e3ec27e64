"""A camera's picture on its way between programs: its lens and size, and what formats can say."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..kinds.camera import BrownConrady, FTheta, KannalaBrandt, Lens, Pinhole

Size = tuple[int, int]
ALIKE_PX = 1e-6
"""Figures of a lens that differ by less are the same."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A camera's picture: its lens, and its size [px], None where a format does not say it."""

    lens: Lens
    size: Size | None = None

    @property
    def fx(self) -> float:
        """Focal length on the axis [px], across."""
        return self.lens.fx * self._on_axis

    @property
    def fy(self) -> float:
        """Focal length on the axis [px], down."""
        return self.lens.fy * self._on_axis

    @property
    def center(self) -> tuple[float, float]:
        """Principal point, right and down from the upper left corner [px]."""
        return self.lens.cx, self.lens.cy

    @property
    def is_plain(self) -> bool:
        """Whether it is a pinhole with square pixels and its principal point in the middle."""
        width, height = self.size or (0, 0)
        centred = (2.0 * self.lens.cx, 2.0 * self.lens.cy) == (width, height)
        return self.lens.is_straight and self.fx == self.fy and centred

    @property
    def matrix(self) -> list[list[float]]:
        """K, the 3 x 3 matrix of the camera on its axis."""
        (cx, cy) = self.center
        return [[self.fx, 0.0, cx], [0.0, self.fy, cy], [0.0, 0.0, 1.0]]

    @property
    def _on_axis(self) -> float:
        return float(self.lens.slope(np.zeros(1))[0])


KeptPicture = Callable[[Picture], Picture]
"""What a format keeps of a picture."""


def pinhole_picture(
    fx: float, fy: float, cx: float, cy: float, size: Size | None = None
) -> Picture:
    """Return a pinhole's picture."""
    return Picture(Pinhole(fx, fy, cx, cy), size)


def picture_of_fov(fov: float, size: Size, fov_down: float | None = None) -> Picture:
    """Return a centred pinhole's picture by its field of view [rad]."""
    width, height = size
    fx = width / (2.0 * math.tan(fov / 2.0))
    fy = fx if fov_down is None else height / (2.0 * math.tan(fov_down / 2.0))
    return pinhole_picture(fx, fy, width / 2.0, height / 2.0, size)


def whole(p: Picture) -> Picture:
    """All of it."""
    return p


def straight(p: Picture) -> Picture:
    """The pinhole with its focal lengths on the axis, and its principal point."""
    return p if p.lens.is_straight else pinhole_picture(p.fx, p.fy, *p.center, p.size)


def centred(p: Picture) -> Picture:
    """The pinhole with its focal lengths on the axis, in the middle of the picture."""
    if p.size is None:
        return straight(p)
    width, height = p.size
    return pinhole_picture(p.fx, p.fy, width / 2.0, height / 2.0, p.size)


def square(p: Picture) -> Picture:
    """The pinhole with its focal length across, in the middle of the picture."""
    if p.size is None:
        return straight(p)
    return pinhole_picture(p.fx, p.fx, p.size[0] / 2.0, p.size[1] / 2.0, p.size)


def opencv(p: Picture) -> Picture:
    """Lenses that OpenCV and ROS know, without the edge of their image."""
    if isinstance(p.lens, BrownConrady | KannalaBrandt):
        return replace(p, lens=replace(p.lens, fov=None))
    return straight(p)


def opencv_of_five(p: Picture) -> Picture:
    """Brown's and Conrady's distortion with k1, k2, p1, p2, k3."""
    if isinstance(p.lens, BrownConrady) and not (p.lens.k4 or p.lens.k5 or p.lens.k6):
        return opencv(p)
    return straight(p)


def f_theta_of_five(p: Picture) -> Picture:
    """An f-theta lens up to the fifth power, with square pixels; its scale in the coefficients."""
    lens = p.lens
    if not isinstance(lens, FTheta) or lens.fx != lens.fy or lens.k6:
        return straight(p)
    scaled = [lens.fx * getattr(lens, key) for key in lens.coefficients]
    return Picture(FTheta(1.0, 1.0, *p.center, None, *scaled), p.size)


def lost(p: Picture, kept: Picture) -> list[str]:
    """Say what of a picture is not in what was kept of it."""
    said = []
    if kept.lens.model != p.lens.model and not p.lens.is_straight:
        said.append(f"distortion ({p.lens.model})")
    elif p.lens.fov is not None and kept.lens.fov is None:
        said.append(f"edge of its image, {math.degrees(p.lens.fov):.5g} deg across,")
    if math.dist(p.center, kept.center) > ALIKE_PX:
        said.append(f"principal point ({p.center[0]:.6g}, {p.center[1]:.6g})")
    if abs(p.fy - kept.fy) > ALIKE_PX:
        said.append(f"focal length down, {p.fy:.6g} px,")
    return said


def alike(a: Picture, b: Picture) -> bool:
    """Whether two pictures are the same, but for rounding."""
    if (
        a.size != b.size
        or a.lens.model != b.lens.model
        or (a.lens.fov is None) != (b.lens.fov is None)
    ):
        return a.size == b.size and _straight_alike(a, b)
    keys = ("fx", "fy", "cx", "cy", *a.lens.coefficients)
    apart = [abs(getattr(a.lens, key) - getattr(b.lens, key)) for key in keys]
    return max(*apart, abs((a.lens.fov or 0.0) - (b.lens.fov or 0.0))) <= ALIKE_PX


def _straight_alike(a: Picture, b: Picture) -> bool:
    """Whether both are pinholes, by whatever name, and the same."""
    if not (a.lens.is_straight and b.lens.is_straight):
        return False
    figures = zip((a.fx, a.fy, *a.center), (b.fx, b.fy, *b.center), strict=True)
    return all(abs(x - y) <= ALIKE_PX for x, y in figures)
