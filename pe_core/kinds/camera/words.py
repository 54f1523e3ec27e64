"""A camera in words."""

from __future__ import annotations

import math

from .model import Camera


def figures(camera: Camera) -> list[str]:
    """Picture, field of view, focal length."""
    return [
        f"image           {camera.width} x {camera.height} px",
        f"field of view   {math.degrees(camera.hfov):g} x {math.degrees(camera.vfov):.4g} deg",
        f"focal length    {camera.focal_px:.2f} px",
    ]
