"""Channel angles in Velodyne's calibration: db.xml, or the ROS driver's YAML made from it.

The driver's beams point along ``rotation - rotCorrection``, and the rotation counts clockwise seen
from above (ros-drivers/velodyne, rawdata.cpp: ``sin(a - b)``, then x = y', y = -x'). So a
correction is counter-clockwise and keeps its sign. Angles are in degrees in db.xml, in radians in
YAML.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from xml.etree import ElementTree

from pe_core.base.errors import InputError
from pe_core.base.files import numbered_lines, parse_number, quoted

from ..xml_text import parse_xml
from .columns import Channel, checked_channel, parse_id, sorted_by_id

FIRST_LASER = 0
XML_KEYS = ("id_", "vertCorrection_", "rotCorrection_")
YAML_KEYS = ("laser_id", "vert_correction", "rot_correction")
LASERS = re.compile(r"^lasers[ \t]*:", re.MULTILINE)

YamlItem = tuple[int, list[str]]
"""Number of the line with the item's dash, and the item's lines without the dash."""


def read_xml(source: str, data: bytes) -> list[Channel]:
    """Read the enabled lasers of a db.xml.

    Raises
    ------
    InputError
        When it is no XML, has no ``<px>``, or a laser's values are missing or invalid.
    """
    root = parse_xml(source, data.lstrip())
    lasers = [_xml_laser(source, i, px) for i, px in enumerate(root.iter("px"))]
    if not lasers:
        found = f"<{quoted(root.tag)[1:-1]}> without any"
        raise InputError(source, "file", "Velodyne's db.xml, with lasers in <px>", found)
    lasers = sorted_by_id(source, lasers, FIRST_LASER)
    enabled = _enabled(source, root, len(lasers))
    return [laser for laser, on in zip(lasers, enabled, strict=True) if on]


def is_yaml(text: str) -> bool:
    """Whether a text is the ROS driver's calibration: it has a line ``lasers:``."""
    return LASERS.search(text) is not None


def read_yaml(source: str, text: str) -> list[Channel]:
    """Read the lasers of the ROS driver's YAML, in flow or block style.

    Raises
    ------
    InputError
        When a line has another layout, or a laser's values are missing or invalid.
    """
    items, count = _yaml_items(source, text)
    if not items:
        raise InputError(source, "lasers", "at least one laser", "none")
    lasers = [_yaml_laser(source, item) for item in items]
    if count is not None and count != len(lasers):
        raise InputError(source, "lasers", f"{count} of them, as num_lasers says", len(lasers))
    return sorted_by_id(source, lasers, FIRST_LASER)


def _xml_laser(source: str, index: int, px: ElementTree.Element) -> Channel:
    values = {key: (px.findtext(key) or "").strip() for key in XML_KEYS}
    where = f"laser {values['id_'] or f'in <px> {index + 1}'}"
    return _laser(source, where, XML_KEYS, values, 1.0)


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


def _yaml_items(source: str, text: str) -> tuple[list[YamlItem], int | None]:
    """Return the items below ``lasers:``, and the number of lasers if the file states it."""
    items: list[YamlItem] = []
    count, inside = None, False
    for number, line in numbered_lines(text):
        body, where = line.strip(), f"line {number}"
        if line[0] not in " \t-":
            key, _, value = (part.strip() for part in body.partition(":"))
            inside = key == "lasers"
            if inside and value:
                raise InputError(source, where, "each laser on its own line", quoted(value))
            count = parse_id(source, where, value) if key == "num_lasers" else count
        elif inside and (body == "-" or body.startswith("- ")):
            items.append((number, [body[1:].strip()]))
        elif inside and items:
            items[-1][1].append(body)
        elif inside:
            raise InputError(source, where, "a laser, after a dash", quoted(body))
    return items, count


def _yaml_laser(source: str, item: YamlItem) -> Channel:
    number, lines = item
    where, body = f"line {number}", " ".join(lines).strip()
    if body.startswith("{"):
        if not body.endswith("}"):
            raise InputError(source, where, "a laser between { and }", quoted(body))
        lines = body[1:-1].split(",")
    values: dict[str, str] = {}
    for pair in filter(str.strip, lines):
        key, colon, value = (part.strip() for part in pair.partition(":"))
        if not (colon and key) or key in values:
            raise InputError(source, where, "key: value, each key once", quoted(pair.strip()))
        values[key] = value
    return _laser(source, where, YAML_KEYS, values, 180.0 / math.pi)


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
