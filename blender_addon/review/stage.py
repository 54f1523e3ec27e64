"""A temporary scene for one picture, and text and lines in the plane of the picture.

Text, lines and plates are placed in pixels from the picture's top left. Nothing of the
scene remains.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ..engine import pe
from .picture_geometry import HFOV_DEG, Faces, View

BACKGROUND = (0.93, 0.94, 0.95)
STUDIO_LIGHT = "paint.sl"
"""The one that leaves colours of what faces the camera as they are."""
COLOR_STEPS = (255, 255, 255, 20)
"""Colours are rounded to these steps, as each needs a material."""
KINDS = (
    "scenes", "collections", "objects", "meshes", "curves", "materials", "cameras", "worlds",
    "fonts", "images",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Stage:
    """The temporary scene, and methods that add objects to it."""

    scene: bpy.types.Scene

    def add(self, name: str, data: bpy.types.ID) -> bpy.types.Object:
        """Add data to the scene as an object."""
        thing = bpy.data.objects.new(name, data)
        self.scene.collection.objects.link(thing)
        return thing

    def add_faces(self, name: str, faces: Faces, facing: View | None = None) -> None:
        """Add polygons with a material for each colour, lit as if they faced the view."""
        if not len(faces.corners):
            return
        count, corners = faces.corners.shape[:2]
        mesh = bpy.data.meshes.new(name)
        numbers = np.arange(count * corners).reshape(count, corners)
        mesh.from_pydata(faces.corners.reshape(-1, 3).tolist(), [], numbers.tolist())
        colors = np.round(faces.colors * COLOR_STEPS) / COLOR_STEPS
        used, which = np.unique(colors, axis=0, return_inverse=True)
        for color in used.tolist():
            mesh.materials.append(material(color))
        mesh.polygons.foreach_set("material_index", which.reshape(-1).astype(np.int32))
        if facing is not None:
            mesh.shade_smooth()
            mesh.normals_split_custom_set([facing.axes[2].tolist()] * (count * corners))
        self.add(name, mesh)

    def set_camera(self, view: View) -> None:
        """Set the camera of the picture."""
        camera = bpy.data.cameras.new("Review camera")
        camera.sensor_fit, camera.angle = "HORIZONTAL", np.radians(HFOV_DEG)
        camera.clip_start, camera.clip_end = 0.05, 1000.0
        thing = self.add("Review camera", camera)
        thing.matrix_world = Matrix(view.matrix.tolist())
        self.scene.camera = thing
        self.scene.render.resolution_x = view.frame.width
        self.scene.render.resolution_y = view.frame.height

    def render(self, path: Path) -> None:
        """Render the picture and write it atomically.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        partial = path.with_name(f".{path.stem}.partial.png")
        self.scene.render.filepath = str(partial)
        try:
            bpy.ops.render.render(write_still=True, scene=self.scene.name)
            partial.replace(path)
        except (OSError, RuntimeError) as error:  # Blender's own message ends in a line break
            found = str(error).strip().removeprefix("Error: ")
            raise pe.InputError(path, "picture", "a path that can be written", found) from None
        finally:
            with contextlib.suppress(OSError):
                partial.unlink()


@contextlib.contextmanager
def stage() -> Iterator[Stage]:
    """Yield an empty stage; at the end, remove everything that was added."""
    before = {kind: set(getattr(bpy.data, kind)) for kind in KINDS}
    try:
        scene = bpy.data.scenes.new("Perception review")
        set_up(scene)
        yield Stage(scene)
    finally:
        made = [block for kind in KINDS for block in set(getattr(bpy.data, kind)) - before[kind]]
        bpy.data.batch_remove(made)


def set_up(scene: bpy.types.Scene) -> None:
    """Set Workbench, soft light, unchanged colours, and a light background."""
    render, shading = scene.render, scene.display.shading
    render.engine, render.resolution_percentage = "BLENDER_WORKBENCH", 100
    render.image_settings.file_format, render.image_settings.color_mode = "PNG", "RGB"
    render.use_file_extension = False
    scene.display.render_aa = "16"
    scene.view_settings.view_transform = "Standard"
    shading.light, shading.color_type = "STUDIO", "MATERIAL"
    shading.studio_light = STUDIO_LIGHT
    shading.show_shadows = shading.show_cavity = shading.show_object_outline = False
    shading.show_specular_highlight = True
    scene.world = bpy.data.worlds.new("Review background")
    scene.world.color = linear(BACKGROUND)


def material(color: tuple[float, float, float, float]) -> bpy.types.Material:
    """Return a matt material of an sRGB colour with alpha."""
    made = bpy.data.materials.new("Review colour")
    made.diffuse_color = (*linear(color[:3]), color[3])
    made.roughness, made.metallic, made.specular_intensity = 1.0, 0.0, 0.0
    return made


def linear(color: tuple[float, float, float]) -> tuple[float, ...]:
    """Linear values of an sRGB colour (IEC 61966-2-1)."""
    return tuple(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color)


PLANE_M = 1.0
"""Distance of the texts before the camera: nearer than anything else."""
PLATE_M, LAYER_M = 1.05, 0.005
INK = (0.10, 0.12, 0.14, 1.0)
FAINT_INK = (0.36, 0.39, 0.42, 1.0)
Rgba = tuple[float, float, float, float]


@dataclass(slots=True)
class Lettering:
    """Writes text and draws shapes on a stage, in the plane of the picture."""

    stage: Stage
    view: View
    _materials: dict[Rgba, bpy.types.Material]

    @classmethod
    def on(cls, stage: Stage, view: View) -> Lettering:
        """Return an object without materials."""
        return cls(stage, view, {})

    def write(
        self, text: str, place: tuple[float, float], size_px: float, color: Rgba = INK,
        align: str = "LEFT",
    ) -> bpy.types.Object:  # fmt: skip
        """Write one line; `place` is the left, middle or right end of its baseline."""
        curve = bpy.data.curves.new("Review text", "FONT")
        curve.body, curve.align_x = text, align
        curve.size = size_px * self.view.frame.tangent_per_px * PLANE_M
        if color not in self._materials:
            self._materials[color] = material(color)
        curve.materials.append(self._materials[color])
        thing = self.stage.add("Review text", curve)
        matrix = self.view.matrix
        matrix[:3, 3] = self._points([place], PLANE_M)[0]
        thing.matrix_world = Matrix(matrix.tolist())
        return thing

    def rectangle(
        self, left: float, top: float, right: float, bottom: float, color: Rgba, layer: int = 0
    ) -> None:
        """Fill a rectangle behind the texts; higher layers are in front of lower ones."""
        self._fill([(left, bottom), (right, bottom), (right, top), (left, top)], color, layer)

    def disc(self, center: tuple[float, float], radius_px: float, color: Rgba, layer: int) -> None:
        """Fill a circle behind the texts."""
        angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        outline = np.column_stack([np.cos(angles), -np.sin(angles)]) * radius_px + center
        self._fill(outline, color, layer)

    def ring(self, center: tuple[float, float], radius_px: float, color: Rgba, layer: int) -> None:
        """Draw a circle, white inside."""
        self.disc(center, radius_px, color, layer)
        self.disc(center, radius_px * 0.6, (1.0, 1.0, 1.0, 1.0), layer + 1)

    def line(
        self, start: tuple[float, float], end: tuple[float, float], width_px: float, color: Rgba,
        layer: int,
    ) -> None:  # fmt: skip
        """Draw a line behind the texts."""
        ends = np.array([start, end], float)
        along = ends[1] - ends[0]
        across = along[::-1] * [1.0, -1.0] * width_px / max(np.hypot(*along), 1e-9) / 2.0
        corners = [ends[0] - across, ends[1] - across, ends[1] + across, ends[0] + across]
        self._fill(corners, color, layer)

    def _fill(self, places: object, color: Rgba, layer: int) -> None:
        points = self._points(places, PLATE_M - layer * LAYER_M)
        self.stage.add_faces("Review plate", Faces(points[None], np.array([color])), self.view)

    def _points(self, places: object, depth_m: float) -> NDArray[np.float64]:
        """(N, 3) points in the ground frame at positions (N, 2) in the picture and a depth."""
        frame = self.view.frame
        across = np.asarray(places, float) - [frame.width / 2, frame.height / 2]
        local = np.empty((len(across), 3))
        local[:, :2] = across * [1.0, -1.0] * frame.tangent_per_px * depth_m
        local[:, 2] = -depth_m
        return local @ self.view.axes + self.view.position
