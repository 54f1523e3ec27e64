"""A camera's picture in Gazebo's sensor elements (SDF): size, intrinsics, Brown's distortion."""

from __future__ import annotations

import math
from xml.etree.ElementTree import Element, SubElement

from ..kinds.camera import BrownConrady
from .pictures import Picture, Size, picture_of_fov, pinhole_picture

BENT = ("k1", "k2", "k3", "p1", "p2")
INTRINSICS = ("fx", "fy", "cx", "cy")


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
        SubElement(bent, "center").text = "0.5 0.5"


def picture_in(sensor: Element | None) -> Picture | None:
    """Return the picture of a sensor; None where its figures are not all there."""
    numbers = numbers_in(sensor, ("camera/horizontal_fov", "image/width", "image/height"))
    if numbers is None or not 0.0 < numbers[0] < math.pi:
        return None
    size = int(numbers[1]), int(numbers[2])
    place = numbers_in(sensor, tuple(f"lens/intrinsics/{key}" for key in INTRINSICS))
    bent = numbers_in(sensor, tuple(f"camera/distortion/{key}" for key in BENT))
    if place is None:
        picture = picture_of_fov(numbers[0], size)
    else:
        picture = pinhole_picture(place[0], place[1], place[2], place[3], size)
    if bent is None or not any(bent):
        return picture
    own = picture.lens
    values = dict(zip(BENT, bent, strict=True))
    return Picture(BrownConrady(own.fx, own.fy, own.cx, own.cy, None, **values), size)


def numbers_in(sensor: Element | None, keys: tuple[str, ...]) -> list[float] | None:
    """Return numbers inside a Gazebo sensor, by where they are; None unless all are there."""
    try:
        texts = [None if sensor is None else sensor.findtext(f".//{key}") for key in keys]
        return [float(text or "") for text in texts]
    except ValueError:
        return None
