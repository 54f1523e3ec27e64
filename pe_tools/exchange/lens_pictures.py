"""Camera intrinsics for exchange: reduction to what a format can express, and conversions."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, shown
from pe_core.sensors.camera import BrownConrady, FTheta, KannalaBrandt, Lens, Pinhole

Size = tuple[int, int]
SKEW_PX = 1e-3  # Skew of K that is told: it moves a pixel by as much at 45 degrees down
ALIKE_PX = 1e-6  # Tolerance below which two lens parameters are equal [px]


@dataclass(frozen=True, slots=True)
class Picture:
    """A camera's intrinsics: its lens, and its image size [px], None if the format has no size."""

    lens: Lens
    size: Size | None = None

    @property
    def fx(self) -> float:
        """Horizontal focal length on the optical axis [px]."""
        return self.lens.fx * self._on_axis

    @property
    def fy(self) -> float:
        """Vertical focal length on the optical axis [px]."""
        return self.lens.fy * self._on_axis

    @property
    def center(self) -> tuple[float, float]:
        """Principal point (cx, cy), from the upper left corner to the right and down [px]."""
        return self.lens.cx, self.lens.cy

    @property
    def is_plain(self) -> bool:
        """Whether the lens is a pinhole with square pixels and a centred principal point."""
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


def pinhole_of(source: object, field: str, matrix: Floats) -> tuple[Pinhole, str]:
    """Return the pinhole of a matrix K (3, 3), and a note on its skew, which no lens here has. A
    matrix of another form raises `InputError`."""
    (fx, skew, cx), (zero, fy, cy), last = matrix.tolist()
    if zero != 0.0 or last != [0.0, 0.0, 1.0] or not (fx > 0.0 and fy > 0.0):
        expected = "rows fx, skew, cx; 0, fy, cy; 0, 0, 1 with focal lengths above 0"
        raise InputError(source, field, expected, shown(matrix.tolist()))
    note = f"its skew, {skew:.3g} px, is left out" if abs(skew) > SKEW_PX else ""
    return Pinhole(fx, fy, cx, cy), note


KeptPicture = Callable[[Picture], Picture]
"""Function that reduces intrinsics to what a format can express."""


def picture_of_fov(fov: float, size: Size, fov_down: float | None = None) -> Picture:
    """Return a centred pinhole's picture by its field of view [rad]."""
    width, height = size
    fx = width / (2.0 * math.tan(fov / 2.0))
    fy = fx if fov_down is None else height / (2.0 * math.tan(fov_down / 2.0))
    return Picture(Pinhole(fx, fy, width / 2.0, height / 2.0), size)


def straight(p: Picture) -> Picture:
    """Return the pinhole with the same focal lengths on the axis and principal point."""
    return p if p.lens.is_straight else Picture(Pinhole(p.fx, p.fy, *p.center), p.size)


def centred(p: Picture) -> Picture:
    """Return the pinhole with the same focal lengths on the axis and a centred principal point."""
    if p.size is None:
        return straight(p)
    width, height = p.size
    return Picture(Pinhole(p.fx, p.fy, width / 2.0, height / 2.0), p.size)


def square(p: Picture) -> Picture:
    """Return the centred pinhole with square pixels and the same horizontal focal length."""
    if p.size is None:
        return straight(p)
    return Picture(Pinhole(p.fx, p.fx, p.size[0] / 2.0, p.size[1] / 2.0), p.size)


def opencv(p: Picture) -> Picture:
    """Return a lens of OpenCV and ROS, without its image circle; a pinhole for others."""
    if isinstance(p.lens, BrownConrady | KannalaBrandt):
        return replace(p, lens=replace(p.lens, fov=None))
    return straight(p)


def opencv_of_five(p: Picture) -> Picture:
    """Return the Brown-Conrady lens if k1, k2, p1, p2, k3 describe it; a pinhole for others."""
    if isinstance(p.lens, BrownConrady) and not (p.lens.k4 or p.lens.k5 or p.lens.k6):
        return opencv(p)
    return straight(p)


def of_driveworks(p: Picture) -> Picture:
    """Return a lens of DriveWorks: Brown-Conrady with k1, k2, k3 alone, or f-theta of square pixels
    and degree 5 at most, its focal length multiplied in. Others become a pinhole."""
    lens = p.lens
    if isinstance(lens, BrownConrady) and not (lens.p1 or lens.p2):
        return opencv_of_five(p)
    if not isinstance(lens, FTheta) or lens.fx != lens.fy or lens.k6:
        return straight(p)
    scaled = {key: lens.fx * getattr(lens, key) for key in lens.coefficients}
    return Picture(replace(lens, fx=1.0, fy=1.0, fov=None, **scaled), p.size)


def lost(p: Picture, kept: Picture) -> list[str]:
    """Return descriptions of the properties of `p` that the reduced intrinsics `kept` lack."""
    lines = []
    if kept.lens.model != p.lens.model and not p.lens.is_straight:
        lines.append(f"distortion ({p.lens.model})")
    elif p.lens.fov is not None and kept.lens.fov is None:
        lines.append(f"edge of its image, {math.degrees(p.lens.fov):.5g} deg across,")
    if math.dist(p.center, kept.center) > ALIKE_PX:
        lines.append(f"principal point ({p.center[0]:.6g}, {p.center[1]:.6g})")
    if abs(p.fy - kept.fy) > ALIKE_PX:
        lines.append(f"focal length down, {p.fy:.6g} px,")
    return lines


def alike(a: Picture, b: Picture) -> bool:
    """Whether two cameras have the same intrinsics within rounding."""
    if a.size != b.size:
        return False
    if a.lens.model == b.lens.model and (a.lens.fov is None) == (b.lens.fov is None):
        keys = ("fx", "fy", "cx", "cy", *a.lens.coefficients)
        pairs = [(getattr(a.lens, key), getattr(b.lens, key)) for key in keys]
        pairs.append((a.lens.fov or 0.0, b.lens.fov or 0.0))
    elif a.lens.is_straight and b.lens.is_straight:
        pairs = list(zip((a.fx, a.fy, *a.center), (b.fx, b.fy, *b.center), strict=True))
    else:
        return False
    return all(abs(x - y) <= ALIKE_PX for x, y in pairs)
