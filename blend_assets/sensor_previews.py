"""The picture of a sensor in the asset browser: its housing from the side, and where it looks.

A LiDAR's channels are a fan in the plane ahead of it, a camera's view is a level wedge.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
import numpy as np
from curves import Array
from mathutils import Vector

PIXELS = 128
FROM = Vector((0.45, -1.0, 0.62)).normalized()
"""From where the camera looks at the sensor."""
WIDTH_M = {"lidar": 0.27, "camera": 0.115}
"""Width of the picture, by kind: LiDARs beside each other, and cameras, are to scale."""
AIM = np.array([0.12, 0.0, 0.0])
"""Middle of the picture, from the optical centre, in widths: what is ahead has room."""
FAN = np.array([0.25, 0.90, 0.94])
LINE_PX = 0.55
REACH = 0.62
"""How far rays are drawn, in widths."""


class Studio:
    """A scene of its own with a camera; one picture after the other."""

    def __init__(self) -> None:
        self.scene = bpy.data.scenes.new("studio")
        self.camera = bpy.data.objects.new("studio", bpy.data.cameras.new("studio"))
        self.camera.data.type = "ORTHO"
        self.camera.rotation_euler = (-FROM).to_track_quat("-Z", "Y").to_euler()
        self.scene.collection.objects.link(self.camera)
        self.scene.camera = self.camera
        _plain_look(self.scene)

    def close(self) -> None:
        """Leave nothing of it in the file."""
        camera = self.camera.data
        bpy.data.scenes.remove(self.scene)
        bpy.data.objects.remove(self.camera)
        bpy.data.cameras.remove(camera)
        for image in tuple(bpy.data.images):  # Blender keeps the last render
            bpy.data.images.remove(image)

    def picture(self, obj: bpy.types.Object, kind: str, rays: Array, is_wedge: bool) -> Array:
        """(PIXELS, PIXELS, 4) picture of an object at the origin, and of rays (R, 3) from there."""
        width = WIDTH_M.get(kind, WIDTH_M["lidar"])
        self.camera.data.ortho_scale = width
        aim = Vector(AIM * width)
        self.camera.location = aim + FROM * 2.0
        body = self._rendered(obj)
        frame = np.array(self.camera.rotation_euler.to_matrix())[:, :2]
        ends = (REACH * rays) @ frame
        start = -(np.array(aim) / width) @ frame
        under = wedge(start, ends) if is_wedge else fan(start, ends)
        return over(body, under)

    def _rendered(self, obj: bpy.types.Object) -> Array:
        """The object alone, the ground transparent."""
        self.scene.collection.objects.link(obj)
        with tempfile.TemporaryDirectory() as folder:
            self.scene.render.filepath = str(Path(folder, "picture.png"))
            bpy.ops.render.render(write_still=True, scene=self.scene.name)
            image = bpy.data.images.load(self.scene.render.filepath)
            pixels = np.empty(PIXELS * PIXELS * 4, np.float32)
            image.pixels.foreach_get(pixels)
            bpy.data.images.remove(image)
        self.scene.collection.objects.unlink(obj)
        return pixels.reshape(PIXELS, PIXELS, 4).astype(float)


def _plain_look(scene: bpy.types.Scene) -> None:
    render = scene.render
    shading = scene.display.shading
    render.engine = "BLENDER_WORKBENCH"
    render.resolution_x = render.resolution_y = PIXELS
    render.film_transparent = True
    scene.display.render_aa = "16"
    scene.view_settings.view_transform = "Standard"
    shading.light = "STUDIO"
    shading.color_type = "MATERIAL"
    shading.show_specular_highlight = True


def fan(start: Array, ends: Array) -> Array:
    """Rays (R, 2) from a point, in widths of the picture, as fine lines that fade away."""
    x, y = _grid()
    cover = np.zeros_like(x)
    strength = min(1.0, 24.0 / max(len(ends), 1)) ** 0.45
    for end in ends:
        size = max(float(np.hypot(*end)), 1e-9)
        along = ((x - start[0]) * end[0] + (y - start[1]) * end[1]) / size
        across = np.abs((x - start[0]) * end[1] - (y - start[1]) * end[0]) / size
        line = np.clip(LINE_PX + 0.5 - across * PIXELS, 0.0, 1.0) * (along > 0.0)
        cover = np.maximum(cover, line * np.clip(1.0 - along / size, 0.0, 1.0) * strength)
    return _tinted(cover)


def wedge(start: Array, ends: Array) -> Array:
    """The area between two rays (2, 2), its edges stronger."""
    x, y = _grid()
    (ax, ay), (bx, by) = ends
    area = ax * by - ay * bx
    u = ((x - start[0]) * by - (y - start[1]) * bx) / area
    v = (ax * (y - start[1]) - ay * (x - start[0])) / area
    inside = np.clip(np.minimum(u, v) * PIXELS + 0.5, 0.0, 1.0)
    fade = np.clip(1.0 - np.hypot(u, v), 0.0, 1.0)
    return np.maximum(_tinted(0.6 * inside * fade), fan(start, ends))


def over(top: Array, under: Array) -> Array:
    """One picture over another, both with straight alpha; as previews are: colour times alpha."""
    a = top[..., 3:]
    b = under[..., 3:]
    colour = top[..., :3] * a + under[..., :3] * b * (1.0 - a)
    return np.concatenate([colour, a + b * (1.0 - a)], axis=-1)


def _grid() -> tuple[Array, Array]:
    """Centres of the pixels from the picture's middle, in its widths; y is up."""
    at = (np.arange(PIXELS) + 0.5) / PIXELS - 0.5
    x, y = np.meshgrid(at, at)
    return x, y


def _tinted(cover: Array) -> Array:
    return np.concatenate([np.broadcast_to(FAN, (*cover.shape, 3)), cover[..., None]], axis=-1)
