"""A camera in words."""

from __future__ import annotations

import math

from .model import Camera


def brief(camera: Camera) -> str:
    """Picture, field of view across and up."""
    across, up = math.degrees(camera.hfov), math.degrees(camera.vfov)
    return f"{camera.width} x {camera.height} px, {across:.0f} x {up:.0f} deg"


def figures(camera: Camera) -> list[str]:
    """Picture, field of view, focal length."""
    across, up = math.degrees(camera.hfov), math.degrees(camera.vfov)
    wide = f"{across:g}" if camera.lens is None else f"{across:.4g}"
    return [
        f"image           {camera.width} x {camera.height} px",
        f"field of view   {wide} x {up:.4g} deg",
        f"focal length    {camera.focal_px:.2f} px",
        *_lens(camera),
        *_ranges(camera),
    ]


def _lens(camera: Camera) -> list[str]:
    lens = camera.lens
    if lens is None:
        return []
    values = {key: value for key in lens.coefficients if (value := getattr(lens, key))}
    shown = ", ".join(f"{key} {value:g}" for key, value in values.items())
    return [
        f"principal point {lens.cx:g}, {lens.cy:g} px",
        f"lens            {lens.model}{': ' if shown else ''}{shown}",
    ]


def _ranges(camera: Camera) -> list[str]:
    if not (camera.min_range > 0.0 or camera.max_range < math.inf):
        return []
    most = f"{camera.max_range:g} m" if camera.max_range < math.inf else "any distance"
    return [f"range           {camera.min_range:g} m to {most}"]
