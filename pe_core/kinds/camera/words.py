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
    return [
        f"image           {camera.width} x {camera.height} px",
        f"field of view   {math.degrees(camera.hfov):g} x {math.degrees(camera.vfov):.4g} deg",
        f"focal length    {camera.focal_px:.2f} px",
    ]
