"""A camera and its lens as a table of a catalogue or a study, in degrees, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ...base.degrees import degrees_in_file
from ...base.errors import InputError, shown
from ...base.values import Number, choice, listed
from ..field_of_view import NEAREST
from .lens import COEFFICIENT, FOCAL, PLACE, Lens
from .lens import FOV as LENS_FOV
from .lens_models import LENSES, FTheta, Pinhole
from .model import FOV, PIXELS, Camera

LENS_KEYS = frozenset({"fx", "fy", "cx", "cy", "distortion", "fov_deg"})
KEYS = frozenset({"width", "height", "hfov_deg", "min_range_m", "max_range_m"}) | LENS_KEYS
HFOV_DEG = Number(FOV.minimum, FOV.maximum, below=True, unit="degrees", noun="angle")


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


FOV_DEG = Number(LENS_FOV.minimum, LENS_FOV.maximum, unit="degrees", noun="angle")
LISTED = "coefficients"
"""Key of a list of coefficients in the order of OpenCV and ROS, instead of names."""
LENGTHS = {"brown-conrady": (4, 5, 8), "kannala-brandt": (4,), "f-theta": (1, 2, 3, 4, 5, 6)}


def read_lens(name: str, table: Mapping[str, Any]) -> Lens:
    """Build a lens from a camera's table.

    Raises
    ------
    InputError
        When a number is missing or not possible, or there is no such model.
    """
    own = table.get("distortion", {})
    if not isinstance(own, Mapping):
        raise InputError(name, "distortion", "a table", shown(own))
    model = choice(name, "distortion.model", own.get("model", Pinhole.model), LENSES)
    lens = LENSES[model]
    fx, fy = _focal_lengths(name, table, lens)
    cx, cy = (PLACE.checked(name, key, table.get(key)) for key in ("cx", "cy"))
    values = _coefficients(name, own, lens)
    if lens is FTheta and not values.get("k1"):
        raise InputError(name, "distortion.k1", "pixels a radian on the axis", "none")
    fov = None
    if "fov_deg" in table:
        fov = math.radians(FOV_DEG.checked(name, "fov_deg", table["fov_deg"]))
    return lens(fx, fy, cx, cy, fov, **values)


def lens_table(lens: Lens) -> dict[str, Any]:
    """Return the keys of a camera's table that `read_lens` turns into this lens again."""
    table: dict[str, Any] = {"fx": lens.fx, "fy": lens.fy, "cx": lens.cx, "cy": lens.cy}
    if lens.fov is not None:
        table["fov_deg"] = degrees_in_file(lens.fov)
    if not isinstance(lens, Pinhole):
        values = {key: value for key in lens.coefficients if (value := getattr(lens, key))}
        table["distortion"] = {"model": lens.model, **values}
    return table


def _focal_lengths(name: str, table: Mapping[str, Any], lens: type[Lens]) -> tuple[float, float]:
    """Focal lengths: `fy` defaults to `fx`; both default to 1 for an f-theta lens."""
    fx = table.get("fx", 1.0 if lens is FTheta else None)
    return FOCAL.checked(name, "fx", fx), FOCAL.checked(name, "fy", table.get("fy", fx))


def _coefficients(name: str, own: Mapping[str, Any], lens: type[Lens]) -> dict[str, float]:
    known = ("model", LISTED, *lens.coefficients) if lens.coefficients else ("model",)
    for key in own:
        if key not in known:
            expected = f"one of {', '.join(known)}"
            raise InputError(name, f"distortion.{key}", expected, "an unknown key")
    found = {k: own[k] for k in lens.coefficients if k in own}
    if LISTED in own:
        if found:
            raise InputError(name, f"distortion.{LISTED}", "a list or names", "both")
        found = dict(zip(lens.coefficients, _listed(name, own[LISTED], lens), strict=False))
    return {k: COEFFICIENT.checked(name, f"distortion.{k}", v) for k, v in found.items()}


def _listed(name: str, values: Any, lens: type[Lens]) -> list[Any]:
    lengths = LENGTHS[lens.model]
    found = listed(values, 20)
    if found is None or len(found) not in lengths:
        few = ", ".join(map(str, lengths[:-1]))
        expected = f"{few} or {lengths[-1]} numbers" if few else f"{lengths[-1]} numbers"
        count = shown(values) if found is None else len(found)
        raise InputError(name, f"distortion.{LISTED}", expected, count)
    return found
