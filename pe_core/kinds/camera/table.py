"""A camera's table in a catalogue or a study, in degrees, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ...text.degrees import degrees_in_file
from ...text.values import Number
from .model import FOV, PIXELS, Camera

KEYS = frozenset({"width", "height", "hfov_deg"})
HFOV_DEG = Number(FOV.least, FOV.most, below=True, unit="degrees", noun="angle")


def read(name: str, table: Mapping[str, Any]) -> Camera:
    """Build a camera from its table."""
    width, height = (PIXELS.checked(name, k, table.get(k)) for k in ("width", "height"))
    hfov = HFOV_DEG.checked(name, "hfov_deg", table.get("hfov_deg"))
    return Camera(name, width, height, math.radians(hfov))


def write(model: Camera) -> dict[str, Any]:
    """Return a camera's table."""
    hfov = degrees_in_file(model.hfov)
    return {"width": model.width, "height": model.height, "hfov_deg": hfov}
