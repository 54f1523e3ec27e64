"""A camera's table in a catalogue or a study, in degrees, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ..fields import number
from .model import Camera

KEYS = frozenset({"width", "height", "hfov_deg"})


def read(name: str, table: Mapping[str, Any]) -> Camera:
    """Build a camera from its table."""
    width, height = (int(number(name, k, table.get(k))) for k in ("width", "height"))
    hfov = math.radians(number(name, "hfov_deg", table.get("hfov_deg")))
    return Camera(name, width, height, hfov)


def write(model: Camera) -> dict[str, Any]:
    """Return a camera's table."""
    hfov = round(math.degrees(model.hfov), 9)
    return {"width": model.width, "height": model.height, "hfov_deg": hfov}
