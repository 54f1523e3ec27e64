"""A camera's picture in Gazebo's sensor elements (SDF): size, intrinsics, Brown's distortion."""

from __future__ import annotations

import math
from xml.etree.ElementTree import Element, SubElement

from ..kinds.camera import BrownConrady
from ..text.values import SHARE, Number
from .figures import COEFFICIENT, FOCAL, PIXELS, PLACE
from .files import plain_number, spaced
from .gazebo_element import SensorElement
from .pictures import Picture, Size, picture_of_fov, pinhole_picture

BENT = ("k1", "k2", "k3", "p1", "p2")
INTRINSICS = ("fx", "fy", "cx", "cy")
NEAR_M, FAR_M = 0.01, 1000.0
"""Where Gazebo begins and ends to draw for a camera that has only one of its ranges."""
WIDEST = Number(0.0, 2.0 * math.pi, above=True, unit="rad", noun="angle")
"""Field of view of a camera in Gazebo, fisheyes included."""


def write_picture(element: Element, picture: Picture, size: Size) -> None:
    """Write a picture into a <camera>."""
    width, height = size
    across = 2.0 * math.atan(width / (2.0 * picture.fx))
    SubElement(element, "horizontal_fov").text = repr(across)
    image = SubElement(element, "image")
    SubElement(image, "width").text, SubElement(image, "height").text = str(width), str(height)
    if picture.is_plain:
        return
    lens = SubElement(SubElement(element, "lens"), "intrinsics")
    place = (picture.fx, picture.fy, *picture.center)
    for key, value in (*zip(INTRINSICS, place, strict=True), ("s", 0.0)):
        SubElement(lens, key).text = repr(value)
    if isinstance(picture.lens, BrownConrady):
        bent = SubElement(element, "distortion")
        for key in BENT:
            SubElement(bent, key).text = repr(getattr(picture.lens, key))
        cx, cy = picture.center
        SubElement(bent, "center").text = spaced((cx / width, cy / height))


def write_clip(element: Element, nearest: float | None, farthest: float | None) -> None:
    """Write a camera's ranges into a <camera>, where it has some; Gazebo wants both [m]."""
    if nearest is None and farthest is None:
        return
    clip = SubElement(element, "clip")
    SubElement(clip, "near").text = plain_number(max(nearest or 0.0, NEAR_M))
    SubElement(clip, "far").text = plain_number(FAR_M if farthest is None else farthest)


def picture_in(sensor: SensorElement) -> Picture | None:
    """Return the picture of a sensor; None where its figures are not all there.

    The centre of the distortion, in shares of the picture's size, is the principal point where no
    intrinsics say another one. A field of view of 180 degrees and more is no pinhole's: its lens is
    left to be chosen.

    Raises
    ------
    InputError
        When a number is none or impossible.
    """
    fov = sensor.number("camera/horizontal_fov", WIDEST)
    width, height = (sensor.whole(f"image/{key}", PIXELS) for key in ("width", "height"))
    focal = sensor.numbers(tuple(f"lens/intrinsics/{key}" for key in INTRINSICS[:2]), FOCAL)
    middle = sensor.numbers(tuple(f"lens/intrinsics/{key}" for key in INTRINSICS[2:]), PLACE)
    bent = [sensor.number(f"camera/distortion/{key}", COEFFICIENT) or 0.0 for key in BENT]
    center = sensor.pair("camera/distortion/center", SHARE)
    if fov is None or width is None or height is None or fov >= math.pi:
        return None
    picture = picture_of_fov(fov, (width, height))
    fx, fy = focal or (picture.fx, picture.fy)
    if middle is None and any(bent) and center is not None:
        middle = [center[0] * width, center[1] * height]
    cx, cy = middle or picture.center
    if not any(bent):
        return pinhole_picture(fx, fy, cx, cy, (width, height))
    values = dict(zip(BENT, bent, strict=True))
    return Picture(BrownConrady(fx, fy, cx, cy, None, **values), (width, height))
