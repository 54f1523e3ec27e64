"""Gazebo's cameras and LiDARs in SDF. A missing value is None. One that violates its rule raises
`InputError`: the author of the file did not mean it to be missing."""

import math
from xml.etree.ElementTree import Element, SubElement

from pe_core.base.errors import InputError
from pe_core.base.values import SHARE, Number
from pe_core.sensors.camera import BrownConrady, Pinhole

from . import foreign_values as values
from .foreign_values import ForeignNumbers, plain_number
from .lens_pictures import Picture, Size, picture_of_fov
from .portable import Scan

BENT = ("k1", "k2", "k3", "p1", "p2")
INTRINSICS = ("fx", "fy", "cx", "cy")
ENDS = ("min_angle", "max_angle")
CENTER = "camera/distortion/center"
NEAR_M = 0.01
FAR_M = 1000.0
"""Clip distances [m] written when a camera has only a minimum or only a maximum range."""
WIDEST = Number(0.0, 2.0 * math.pi, above=True, unit="rad", noun="angle")
"""Field of view of a camera in Gazebo, fisheyes included."""


def write_picture(element: Element, picture: Picture, size: Size) -> None:
    """Write a camera's intrinsics into a ``<camera>`` element."""
    width, height = size
    across = 2.0 * math.atan(width / (2.0 * picture.fx))
    SubElement(element, "horizontal_fov").text = repr(across)
    image = SubElement(element, "image")
    SubElement(image, "width").text = str(width)
    SubElement(image, "height").text = str(height)
    if picture.is_plain:
        return
    intrinsics_element = SubElement(SubElement(element, "lens"), "intrinsics")
    intrinsics = (picture.fx, picture.fy, *picture.center)
    for key, value in (*zip(INTRINSICS, intrinsics, strict=True), ("s", 0.0)):
        SubElement(intrinsics_element, key).text = repr(value)
    if isinstance(picture.lens, BrownConrady):
        distortion = SubElement(element, "distortion")
        for key in BENT:
            SubElement(distortion, key).text = repr(getattr(picture.lens, key))
        cx, cy = picture.center
        SubElement(distortion, "center").text = values.spaced((cx / width, cy / height))


def write_clip(element: Element, nearest: float | None, farthest: float | None) -> None:
    """Write a camera's minimum and maximum range [m] into a ``<camera>`` element. Nothing is
    written if both are None. Gazebo requires both, so a missing one gets a default."""
    if nearest is None and farthest is None:
        return
    clip = SubElement(element, "clip")
    SubElement(clip, "near").text = plain_number(max(nearest or 0.0, NEAR_M))
    SubElement(clip, "far").text = plain_number(FAR_M if farthest is None else farthest)


def picture_in(sensor: ForeignNumbers) -> Picture | None:
    """Return a camera's intrinsics; None if its field of view or its image size is missing. Without
    intrinsics in the file, the principal point is the centre of the distortion, which is given as a
    fraction of the image size. A field of view of 180 degrees or more is not that of a pinhole; the
    result is None and the user has to choose a model."""
    fov = sensor.number("camera/horizontal_fov", WIDEST)
    width, height = (sensor.whole(f"image/{key}") for key in ("width", "height"))
    intrinsics = [f"lens/intrinsics/{key}" for key in INTRINSICS]
    focal = sensor.numbers(intrinsics[:2], values.FOCAL)
    principal_point = sensor.numbers(intrinsics[2:], values.PRINCIPAL_POINT)
    keys = [f"camera/distortion/{key}" for key in BENT]
    distortion = [sensor.number(key, values.COEFFICIENT) or 0.0 for key in keys]
    text = sensor.get(CENTER)
    field = sensor.field(CENTER)
    center = (
        None if text is None else values.figures(sensor.source, field, text, count=2, rule=SHARE)
    )
    if fov is None or width is None or height is None or fov >= math.pi:
        return None
    picture = picture_of_fov(fov, (width, height))
    fx, fy = focal or (picture.fx, picture.fy)
    if principal_point is None and any(distortion) and center is not None:
        principal_point = [center[0] * width, center[1] * height]
    cx, cy = principal_point or picture.center
    if not any(distortion):
        return Picture(Pinhole(fx, fy, cx, cy), (width, height))
    bent = dict(zip(BENT, distortion, strict=True))
    return Picture(BrownConrady(fx, fy, cx, cy, fov=None, **bent), (width, height))


def write_scan(element: Element, scan: Scan) -> None:
    """Write a scan into a ``<lidar>`` element."""
    block = SubElement(element, "scan")
    parts = {
        "horizontal": (scan.azimuths, *(scan.ends or scan.fov)),
        "vertical": (scan.channels, scan.low, scan.high),
    }
    for name, numbers in parts.items():
        part = SubElement(block, name)
        for key, value in zip(("samples", *ENDS), numbers, strict=True):
            SubElement(part, key).text = repr(value)
    range_element = SubElement(element, "range")
    if scan.min_range:
        SubElement(range_element, "min").text = repr(scan.min_range)
    SubElement(range_element, "max").text = repr(scan.max_range)


def scan_in(sensor: ForeignNumbers) -> Scan | None:
    """Return a LiDAR's scan; None if it is incomplete. Without ``<vertical>`` it has one channel.
    Its first and last azimuth are at both ends: N samples are N - 1 steps apart.
    Angles that end before they begin raise `InputError`."""
    azimuths = sensor.whole("horizontal/samples", values.STEPS)
    across = sensor.numbers([f"horizontal/{end}" for end in ENDS], values.AZIMUTH)
    max_range = sensor.number("range/max", values.RANGE)
    if azimuths is None or across is None or max_range is None:
        return None
    channels = sensor.whole("vertical/samples", values.CHANNELS) or 1
    ends = [f"vertical/{end}" for end in ENDS]
    low, high = sensor.numbers(ends, values.ELEVATION) or (0.0, 0.0)
    for name, (min_angle, max_angle) in (("horizontal", across), ("vertical", (low, high))):
        if min_angle > max_angle:
            expected = f"{ENDS[0]} up to {ENDS[1]}"
            found = f"{min_angle:g}, {max_angle:g}"
            raise InputError(sensor.source, sensor.field(name), expected, found)
    nearest = sensor.number("range/min", values.MIN_RANGE) or 0.0
    fov = (across[0], across[1])
    return Scan(
        channels, low, high, azimuths, fov=fov, max_range=max_range, min_range=nearest, ends=fov
    )
