"""A LiDAR's scan in Gazebo's sensor elements (SDF): channels and azimuths at even distances."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from ..errors import InputError
from .carried import Scan
from .figures import AZIMUTH, CHANNELS, ELEVATION, MIN_RANGE, RANGE, STEPS
from .gazebo_element import SensorElement

ENDS = ("min_angle", "max_angle")


def write_scan(element: Element, scan: Scan) -> None:
    """Write a scan into a <lidar>."""
    block = SubElement(element, "scan")
    ranges = (
        ("horizontal", scan.azimuths, *scan.fov),
        ("vertical", scan.channels, scan.low, scan.high),
    )
    for name, samples, least, most in ranges:
        part = SubElement(block, name)
        for key, value in (("samples", samples), *zip(ENDS, (least, most), strict=True)):
            SubElement(part, key).text = repr(value)
    reach = SubElement(element, "range")
    if scan.min_range:
        SubElement(reach, "min").text = repr(scan.min_range)
    SubElement(reach, "max").text = repr(scan.max_range)


def scan_in(sensor: SensorElement) -> Scan | None:
    """Return the scan of a sensor; None where it has none. Without <vertical> it is one channel.

    Raises
    ------
    InputError
        When a number is none or impossible, or angles end before they begin.
    """
    azimuths = sensor.whole("horizontal/samples", STEPS)
    across = sensor.numbers(tuple(f"horizontal/{end}" for end in ENDS), AZIMUTH)
    max_range = sensor.number("range/max", RANGE)
    if azimuths is None or across is None or max_range is None:
        return None
    channels = sensor.whole("vertical/samples", CHANNELS) or 1
    low, high = sensor.numbers(tuple(f"vertical/{end}" for end in ENDS), ELEVATION) or (0.0, 0.0)
    for name, (least, most) in (("horizontal", across), ("vertical", (low, high))):
        if least > most:
            field = f"sensor of {sensor.name}, {name}"
            raise InputError(
                sensor.path, field, f"{ENDS[0]} up to {ENDS[1]}", f"{least:g}, {most:g}"
            )
    near = sensor.number("range/min", MIN_RANGE) or 0.0
    return Scan(channels, low, high, azimuths, (across[0], across[1]), max_range, min_range=near)
