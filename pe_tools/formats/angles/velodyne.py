"""Channel angles in Velodyne's calibration: db.xml, or the ROS driver's YAML made from it.

The driver's beams point along ``rotation - rotCorrection``, and the rotation counts clockwise seen
from above (ros-drivers/velodyne, rawdata.cpp: ``sin(a - b)``, then x = y', y = -x'). So a
correction is counter-clockwise and keeps its sign. Angles are in degrees in db.xml, in radians in
YAML.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from xml.etree import ElementTree

from pe_core.base.errors import InputError
from pe_core.base.files import parse_number, quoted

from ..xml_text import parse_xml
from ..yaml_text import YamlText
from .columns import Channel, checked_channel, parse_id, sorted_by_id

FIRST_LASER = 0
DEGREES = 180.0 / math.pi
"""In a radian."""
XML_KEYS = ("id_", "vertCorrection_", "rotCorrection_")
YAML_KEYS = ("laser_id", "vert_correction", "rot_correction")


def read_xml(source: str, data: bytes) -> list[Channel]:
    """Read the enabled lasers of a db.xml.

    Another document, or a laser whose values are missing or invalid, raises `InputError`.
    """
    root = parse_xml(source, data.lstrip())
    lasers = []
    for number, px in enumerate(root.iter("px"), 1):
        values = {key: (px.findtext(key) or "").strip() for key in XML_KEYS}
        where = f"laser {values['id_'] or f'in <px> {number}'}"
        lasers.append(_laser(source, where, XML_KEYS, values, 1.0))
    if not lasers:
        found = f"<{quoted(root.tag)[1:-1]}> without any"
        raise InputError(source, "file", "Velodyne's db.xml, with lasers in <px>", found)
    lasers = sorted_by_id(source, lasers, FIRST_LASER)
    enabled = _enabled(source, root, len(lasers))
    return [laser for laser, on in zip(lasers, enabled, strict=True) if on]


def read_yaml(source: str, text: str) -> list[Channel]:
    """Read the lasers of the ROS driver's YAML.

    A text that is no YAML, or a laser whose values are missing or invalid, raises `InputError`.
    """
    yaml = YamlText(source, text)
    items = yaml.data["lasers"]
    if not isinstance(items, list) or not items:
        raise InputError(source, "lasers", "at least one laser", "none")
    lasers = []
    for k in range(len(items)):
        path = ("lasers", str(k))
        values = {key: yaml.word((*path, key)) for key in YAML_KEYS}
        lasers.append(_laser(source, f"line {yaml.line(path)}", YAML_KEYS, values, DEGREES))
    if stated := yaml.word(("num_lasers",)):
        count = parse_id(source, f"line {yaml.line(('num_lasers',))}", stated)
        if count != len(lasers):
            expected = f"{count} of them, as num_lasers says"
            raise InputError(source, "lasers", expected, len(lasers))
    return sorted_by_id(source, lasers, FIRST_LASER)


def _enabled(source: str, root: ElementTree.Element, count: int) -> list[bool]:
    """Whether each laser is enabled: all are, unless ``<enabled_>`` says otherwise."""
    node = root.find(".//enabled_")
    if node is None:
        return [True] * count
    flags = [(item.text or "").strip() for item in node.findall("item")]
    for flag in flags:
        if flag not in ("0", "1"):
            raise InputError(source, "enabled_", "0 or 1 for each laser", quoted(flag))
    if len(flags) < count:
        raise InputError(source, "enabled_", f"0 or 1 for each of {count} lasers", len(flags))
    if "1" in flags[count:]:
        number = flags.index("1", count)
        raise InputError(source, f"laser {number}", "angles, as it is enabled", "none")
    if "1" not in flags:
        raise InputError(source, "enabled_", "at least one laser enabled", "none")
    return [flag == "1" for flag in flags[:count]]


def _laser(
    source: str, where: str, keys: tuple[str, str, str], values: Mapping[str, str], degrees: float
) -> Channel:
    """Return a laser from its values in text; `degrees` is the file's unit of angles in degrees."""
    for key in keys:
        if not values.get(key):
            raise InputError(source, where, f"a value of {key}", "none")
    number = parse_id(source, where, values[keys[0]])
    elevation, offset = (parse_number(source, where, key, values[key]) for key in keys[1:])
    return checked_channel(source, where, number, elevation * degrees, offset * degrees)
