"""A camera's intrinsics: the pinhole and its picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ...errors import InputError
from ...scene.sensors import SensorModel


@dataclass(frozen=True, eq=False)
class Camera(SensorModel):
    """Intrinsics of a pinhole camera (eq. 2): square pixels, centred principal point.

    Parameters
    ----------
    name : str
        Catalogue name, or the user's own.
    width, height : int
        Active resolution [px].
    hfov : float
        Horizontal field of view [rad], below 180 degrees.

    Raises
    ------
    InputError
        When the resolution or the field of view is not possible.
    """

    kind: ClassVar[str] = "camera"
    sees_through_glass: ClassVar[bool] = True

    name: str
    width: int
    height: int
    hfov: float

    def __post_init__(self) -> None:
        for key in ("width", "height"):
            if not (isinstance(getattr(self, key), int) and getattr(self, key) > 0):
                raise InputError(self.name, key, "a whole number of pixels", getattr(self, key))
        if not 0.0 < self.hfov < math.pi:
            found = f"{math.degrees(self.hfov):g}"
            raise InputError(self.name, "hfov", "above 0 and below 180 degrees", found)

    @property
    def focal_px(self) -> float:
        """Focal length ``W / (2 tan(r_h / 2))`` [px], eq. 2."""
        return self.width / (2.0 * math.tan(self.hfov / 2.0))

    @property
    def vfov(self) -> float:
        """Vertical field of view [rad]."""
        return 2.0 * math.atan(self.height / (2.0 * self.focal_px))
