"""A camera's intrinsics: the pinhole and its picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ...scene.sensors import SensorModel
from ...text.values import A_NAME, Angle, Whole

PIXELS = Whole(1, 1_000_000, "pixels")
FOV = Angle(0.001, 180.0, below=True)


@dataclass(frozen=True, eq=False)
class Camera(SensorModel):
    """Intrinsics of a pinhole camera (eq. 3): square pixels, centred principal point.

    Parameters
    ----------
    name : str
        Catalogue name, or the user's own.
    width, height : int
        Active resolution [px].
    hfov : float
        Horizontal field of view [rad], below 180 degrees; as a file's degrees give it back.

    Raises
    ------
    InputError
        When the name, the resolution or the field of view is not possible.
    """

    kind: ClassVar[str] = "camera"
    sees_through_glass: ClassVar[bool] = True

    name: str
    width: int
    height: int
    hfov: float

    def __post_init__(self) -> None:
        name = A_NAME.checked("camera", "name", self.name)
        for key, rule in (("width", PIXELS), ("height", PIXELS), ("hfov", FOV)):
            object.__setattr__(self, key, rule.checked(name, key, getattr(self, key)))

    @property
    def focal_px(self) -> float:
        """Focal length ``W / (2 tan(r_h / 2))`` [px], for eq. 3."""
        return self.width / (2.0 * math.tan(self.hfov / 2.0))

    @property
    def vfov(self) -> float:
        """Vertical field of view [rad]."""
        return 2.0 * math.atan(self.height / (2.0 * self.focal_px))
