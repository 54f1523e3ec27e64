"""The camera as a kind: its row of the registry, its table in degrees, and its figures in text."""

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import Floats
from ...base.errors import InputError, require_keys, shown
from ...base.values import Number, choice, degrees_in_file, listed
from ...metric.entropy import RTM3D
from ...scene.rig import Sensor
from ..field_of_view import NEAREST, limited
from ..kernels import DefinedSample
from ..kind import OUT_OF_RANGE, OUT_OF_VIEW, Kind, derived_object_curves
from ..weather import camera_range
from .definition import count_pixels, is_ranged, out_of_range
from .kernels import CameraGrid, CameraGround, CameraObjects, sampled_pixels
from .lens import COEFFICIENT, FOCAL, LENSES, PLACE, FTheta, Lens, Pinhole
from .lens import FOV as LENS_FOV
from .model import FOV, PIXELS, Camera, camera_of, picture_occlusion, picture_patch, picture_rays
from .object_definition import count_object_pixels

LENS_KEYS = frozenset({"fx", "fy", "cx", "cy", "distortion", "fov_deg"})
KEYS = frozenset({"width", "height", "hfov_deg", "min_range_m", "max_range_m"}) | LENS_KEYS
HFOV_DEG = Number(FOV.minimum, FOV.maximum, below=True, unit="degrees", noun="angle")
FOV_DEG = Number(LENS_FOV.minimum, LENS_FOV.maximum, unit="degrees", noun="angle")
LISTED = "coefficients"
"""Key of a list of coefficients in the order of OpenCV and ROS, instead of names."""
LENGTHS = {"brown-conrady": (4, 5, 8), "kannala-brandt": (4,), "f-theta": (1, 2, 3, 4, 5, 6)}


def read(name: str, table: Mapping[str, Any], folder: Path) -> Camera:
    """Build a camera from its table."""
    width, height = (PIXELS.checked(name, k, table.get(k)) for k in ("width", "height"))
    min_range = table.get("min_range_m", NEAREST)
    max_range = table.get("max_range_m", math.inf)
    if not LENS_KEYS & set(table):
        hfov = HFOV_DEG.checked(name, "hfov_deg", table.get("hfov_deg"))
        return Camera(
            name,
            width,
            height,
            math.radians(hfov),
            lens=None,
            min_range=min_range,
            max_range=max_range,
        )
    if "hfov_deg" in table:
        key = sorted(LENS_KEYS & set(table))[0]
        raise InputError(name, "hfov_deg", f"either hfov_deg or a lens ({key})", "both")
    return Camera(
        name,
        width,
        height,
        hfov=None,  # type: ignore[arg-type]  # of the lens
        lens=read_lens(name, table),
        min_range=min_range,
        max_range=max_range,
    )


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


def read_lens(name: str, table: Mapping[str, Any]) -> Lens:
    """Build a lens from a camera's table. `InputError` when a number is missing or not possible, or
    there is no such model."""
    own = table.get("distortion", {})
    if not isinstance(own, Mapping):
        raise InputError(name, "distortion", "a table", shown(own))
    model = choice(name, "distortion.model", own.get("model", Pinhole.model), LENSES)
    lens = LENSES[model]
    fx = table.get("fx", 1.0 if lens is FTheta else None)  # `fy` defaults to it
    fx, fy = (FOCAL.checked(name, k, table.get(k, fx)) for k in ("fx", "fy"))
    cx, cy = (PLACE.checked(name, key, table.get(key)) for key in ("cx", "cy"))
    values = _coefficients(name, own, lens)
    if lens is FTheta and not values.get("k1"):
        raise InputError(name, "distortion.k1", "pixels a radian on the axis", "none")
    fov = None
    if "fov_deg" in table:
        fov = math.radians(FOV_DEG.checked(name, "fov_deg", table["fov_deg"]))
    return lens(fx, fy, cx, cy, fov=fov, **values)


def lens_table(lens: Lens) -> dict[str, Any]:
    """Return the keys of a camera's table that `read_lens` turns into this lens again."""
    table: dict[str, Any] = {"fx": lens.fx, "fy": lens.fy, "cx": lens.cx, "cy": lens.cy}
    if lens.fov is not None:
        table["fov_deg"] = degrees_in_file(lens.fov)
    if not isinstance(lens, Pinhole):
        values = {key: value for key in lens.coefficients if (value := getattr(lens, key))}
        table["distortion"] = {"model": lens.model, **values}
    return table


def _coefficients(name: str, own: Mapping[str, Any], lens: type[Lens]) -> dict[str, float]:
    known = ("model", LISTED, *lens.coefficients) if lens.coefficients else ("model",)
    require_keys(name, "distortion.", own, known)
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


def summary(camera: Camera) -> str:
    """Return the resolution, and the field of view across and up, in one line."""
    across = math.degrees(camera.hfov)
    up = math.degrees(camera.vfov)
    return f"{camera.width} x {camera.height} px, {across:.0f} x {up:.0f} deg"


def figures(camera: Camera) -> list[str]:
    """Picture, field of view, focal length."""
    across = math.degrees(camera.hfov)
    up = math.degrees(camera.vfov)
    wide = f"{across:g}" if camera.lens is None else f"{across:.4g}"
    lines = [
        f"image           {camera.width} x {camera.height} px",
        f"field of view   {wide} x {up:.4g} deg",
        f"focal length    {camera.focal_px:.2f} px",
    ]
    if (lens := camera.lens) is not None:
        own = ", ".join(f"{key} {v:g}" for key in lens.coefficients if (v := getattr(lens, key)))
        lines.append(f"principal point {lens.cx:g}, {lens.cy:g} px")
        lines.append(f"lens            {lens.model}{': ' if own else ''}{own}")
    if is_ranged(camera):
        most = f"{camera.max_range:g} m" if camera.max_range < math.inf else "any distance"
        lines.append(f"range           {camera.min_range:g} m to {most}")
    return lines


def missed(sensor: Sensor, center: Floats, side: float) -> str:
    """Return one of: out of range, out of view."""
    offset = np.asarray(center)[None] - np.asarray(sensor.pose.position)
    out = out_of_range(camera_of(sensor), offset)[0]
    return OUT_OF_RANGE if out else OUT_OF_VIEW


CAMERA = Kind(
    name="camera",
    label="Camera",
    plural="Cameras",
    unit="pixels",
    model=Camera,
    curve=RTM3D,
    object_curves=derived_object_curves(RTM3D),
    keys=KEYS,
    pixels_per_radian=lambda model: model.pixels_per_radian,
    has_top=True,
    shows_parts=True,
    occlusion_text="picture occluded",
    measure=count_pixels,
    measure_objects=count_object_pixels,
    measure_parts=lambda sensor, parts, vehicle: count_object_pixels(
        sensor, parts.cells, vehicle, False
    ),
    read=read,
    write=write,
    in_weather=lambda model, weather: limited(model, camera_range(model.max_range, weather)),
    data_sheet=figures,
    summary=summary,
    rays=picture_rays,
    missed=missed,
    view=picture_patch,
    on_grid=CameraGrid,
    on_sample=partial(DefinedSample, sampled_pixels, occlusion=picture_occlusion),
    on_ground=CameraGround,
    on_objects=CameraObjects,
)
