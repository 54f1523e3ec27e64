"""A camera's intrinsics: picture, lens and range."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.values import A_NAME, Angle, Number, Whole
from ...scene.rig import SensorModel
from ..field_of_view import NEAREST, SHORTEST_RANGE_M, checked_ranges
from .lens import Lens, Pinhole, field_outline, reaching

PIXELS = Whole(1, 1_000_000, "pixels")
FOV = Angle(0.001, 180.0, below=True)
FARTHEST = Number(SHORTEST_RANGE_M, cap=1e9, unit="m", noun="length", infinite=True)
"""Maximum range; a camera as a rule has none."""


@dataclass(frozen=True, eq=False)
class Camera(SensorModel):
    """Intrinsics of a camera: an ideal pinhole (eq. 3) with a field of view, or any `Lens`.

    Parameters
    ----------
    name : str
        Catalogue name, or the user's own.
    width, height : int
        Active resolution [px].
    hfov : float, optional
        Horizontal field of view [rad] of a pinhole with square pixels and a centred principal
        point, below 180 degrees; stored as a file in degrees gives it back. With a lens it is
        computed: the angle between the ends of the row through the principal point.
    lens : Lens, optional
        Instead of `hfov`. The edge of its field is set for this picture.
    min_range, max_range : float
        A voxel with a centre nearer or farther is not visible [m].

    Raises
    ------
    InputError
        When the name, the resolution, the field of view, a range or the lens is not possible. A
        lens must be invertible in all of the picture, with its principal point inside.
    """

    kind: ClassVar[str] = "camera"
    sees_through_glass: ClassVar[bool] = True

    name: str
    width: int
    height: int
    hfov: float = None  # type: ignore[assignment]  # of the lens
    lens: Lens | None = None
    min_range: float = NEAREST
    max_range: float = math.inf

    def __post_init__(self) -> None:
        name = A_NAME.checked("camera", "name", self.name)
        for key in ("width", "height"):
            object.__setattr__(self, key, PIXELS.checked(name, key, getattr(self, key)))
        ranges = checked_ranges(name, self.min_range, self.max_range, FARTHEST)
        object.__setattr__(self, "min_range", ranges[0])
        object.__setattr__(self, "max_range", ranges[1])
        if self.lens is None:
            object.__setattr__(self, "hfov", FOV.checked(name, "hfov", self.hfov))
        else:
            self._fit(name)

    def _fit(self, name: str) -> None:
        """Set the lens's edge for this picture, and the field of view."""
        if not isinstance(self.lens, Lens):
            raise InputError(name, "lens", "a lens", type(self.lens).__name__)
        for key, most in (("cx", self.width), ("cy", self.height)):
            if not 0.0 <= getattr(self.lens, key) <= most:
                found = f"{getattr(self.lens, key):g}"
                raise InputError(name, key, f"a place in the picture, 0 to {most}", found)
        object.__setattr__(self, "lens", reaching(self.lens, name, self.width, self.height))
        hfov = self._across((0.0, self.width), (self.projection.cy, self.projection.cy))
        if self.hfov is not None and abs(self.hfov - hfov) > 1e-9:
            raise InputError(name, "hfov", "either a field of view or a lens", "both")
        object.__setattr__(self, "hfov", hfov)

    @cached_property
    def projection(self) -> Lens:
        """The lens; for an ideal camera, the pinhole with its field of view."""
        if self.lens is not None:
            return self.lens
        f = self.width / (2.0 * math.tan(self.hfov / 2.0))
        return Pinhole(f, f, self.width / 2.0, self.height / 2.0)

    @property
    def focal_px(self) -> float:
        """Focal length ``W / (2 tan(r_h / 2))`` [px], for eq. 3; with a lens, mean of fx and fy."""
        lens = self.projection
        return lens.fx if lens.fx == lens.fy else math.sqrt(lens.fx * lens.fy)

    @property
    def vfov(self) -> float:
        """Vertical field of view [rad], along the column through the principal point."""
        if self.lens is None:
            return 2.0 * math.atan(self.height / (2.0 * self.focal_px))
        return self._across((self.lens.cx, self.lens.cx), (0.0, self.height))

    def outline(self, places: int = 16) -> NDArray[np.float64]:
        """(4 places, 3) unit directions, forward, left, up, on the border of the view.

        From the upper left corner clockwise, as the camera sees it.
        """
        return field_outline(self.projection, self.width, self.height, places)

    def _across(self, right: tuple[float, float], down: tuple[float, float]) -> float:
        """Sum of the angles from the axis to two image positions [rad], each at most the edge."""
        depth = self.projection.unproject(np.array(right), np.array(down))[:, 0]
        angles = np.where(np.isnan(depth), self.projection.edge, np.arccos(np.clip(depth, -1, 1)))
        return float(angles.sum())
