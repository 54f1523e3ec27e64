"""A camera's table in a catalogue or a study, in degrees, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ...errors import InputError
from ...text.degrees import degrees_in_file
from ...text.values import Number
from ..ranges import NEAREST
from .lens.table import LENS_KEYS, lens_table, read_lens
from .model import FOV, PIXELS, Camera

KEYS = frozenset({"width", "height", "hfov_deg", "min_range_m", "max_range_m"}) | LENS_KEYS
HFOV_DEG = Number(FOV.least, FOV.most, below=True, unit="degrees", noun="angle")


def read(name: str, table: Mapping[str, Any]) -> Camera:
    """Build a camera from its table."""
    width, height = (PIXELS.checked(name, k, table.get(k)) for k in ("width", "height"))
    ranges = table.get("min_range_m", NEAREST), table.get("max_range_m", math.inf)
    if not LENS_KEYS & set(table):
        hfov = HFOV_DEG.checked(name, "hfov_deg", table.get("hfov_deg"))
        return Camera(name, width, height, math.radians(hfov), None, *ranges)
    if "hfov_deg" in table:
        key = sorted(LENS_KEYS & set(table))[0]
        raise InputError(name, "hfov_deg", f"either hfov_deg or a lens ({key})", "both")
    return Camera(name, width, height, None, read_lens(name, table), *ranges)  # type: ignore[arg-type]


def write(model: Camera) -> dict[str, Any]:
    """Return a camera's table."""
    table: dict[str, Any] = {"width": model.width, "height": model.height}
    if model.lens is None:
        table["hfov_deg"] = degrees_in_file(model.hfov)
    else:
        table |= lens_table(model.lens)
    if model.min_range > NEAREST:
        table["min_range_m"] = model.min_range
    if model.max_range < math.inf:
        table["max_range_m"] = model.max_range
    return table
