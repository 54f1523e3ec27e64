"""Tables of a sensor's housing and data sheet in the catalogue; scan centres above bases."""

import re
from collections.abc import Mapping
from typing import Any

from ..base.errors import InputError, require_keys, shown
from ..base.values import A_TEXT, LENGTH, choice, vector
from ..scene.data_sheet import DataSheet
from ..scene.rig import NEAR, SHAPES, Housing

KEYS = {
    "cylinder": frozenset({"shape", "diameter", "height", "optical_height", "source"}),
    "box": frozenset({"shape", "size", "optical_center", "source"}),
}
SHEET_KEYS = frozenset({"mass", "power", "data_rate", "source"})
SCAN_ABOVE_BASE_M = {
    "VLP-16": 0.0377,
    "VLS-128": 0.06611,
    "HDL-32E": 0.09081,
    "Pandar40P": 0.047,
    "OT128": 0.09,
    "XT32": 0.0464,
    "QT128": 0.0582,
    "QT128C2X": 0.0582,
    "QT64": 0.0504,
}
"""By a word of the model's name: `base_scan_joint` of tier4's sensor_component_description
(03ba094) for Hesai, VLP-16 and VLS-128, of tier4's velodyne_simulator (daf518d) for HDL-32E."""
WORD = re.compile(r"[^\s()/]+")


def read_housing(name: str, table: Any) -> Housing:
    """Build a housing from its table; lengths in metres.

    Cylinder: ``shape = "cylinder"``, ``diameter``, ``height``, and ``optical_height``: the height
    of the optical centre above the base (default: half of the height). Box: ``shape = "box"``,
    ``size`` (3,), and ``optical_center`` (3,) relative to the middle of the base (default: the
    middle of the front). Both: ``source``, the source of the figures and assumptions.

    `InputError` when `table` is not a table, a key is unknown, or a value is not valid.
    """
    if not isinstance(table, Mapping):
        raise InputError(name, "housing", "a table", shown(table))
    shape = choice(name, "housing.shape", table.get("shape"), SHAPES)
    require_keys(name, "housing.", table, KEYS[shape])
    source = A_TEXT.checked(name, "housing.source", table.get("source"))
    size, center = (_box if shape == "box" else _cylinder)(name, table)
    return Housing(shape, size, center, source)


def read_data_sheet(name: str, table: Any) -> DataSheet:
    """Build figures from a table: ``mass`` [kg], ``power`` [W], ``data_rate`` [Mbit/s], ``source``.
    `InputError` when `table` is not a table, a key is unknown, or a value is not valid."""
    if not isinstance(table, Mapping):
        raise InputError(name, "data_sheet", "a table", shown(table))
    require_keys(name, "data_sheet.", table, SHEET_KEYS)
    A_TEXT.checked(name, "data_sheet.source", table.get("source"))
    try:
        return DataSheet(**{key: value for key, value in table.items() if key != "source"})
    except InputError as error:
        raise InputError(name, f"data_sheet.{error.field}", error.expected, error.found) from None


def _cylinder(name: str, table: Mapping[str, Any]) -> tuple[Any, Any]:
    """Return size (3,) and optical centre (3,) of a cylinder [m]."""
    diameter, height = (
        LENGTH.checked(name, f"housing.{key}", table.get(key)) for key in ("diameter", "height")
    )
    half = height / 2.0
    center = NEAR.checked(name, "housing.optical_height", table.get("optical_height", half))
    return (diameter, diameter, height), (0.0, 0.0, center)


def _box(name: str, table: Mapping[str, Any]) -> tuple[Any, Any]:
    """Return size (3,) and optical centre (3,) of a box [m]."""
    size = vector(name, "housing.size", table.get("size"), count=3, rule=LENGTH)
    front = (size[0] / 2.0, 0.0, size[2] / 2.0)
    given = table.get("optical_center", front)
    return size, vector(name, "housing.optical_center", given, count=3, rule=NEAR)


def scan_above_base(model: str | None) -> float:
    """Return the height of a model's scan centre above its base [m]; 0 if it is not known."""
    words = WORD.findall(model or "")
    return next((SCAN_ABOVE_BASE_M[word] for word in words if word in SCAN_ABOVE_BASE_M), 0.0)
