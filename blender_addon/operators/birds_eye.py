"""The bird's-eye view: a plate over the 3D view with the ground as the cameras show it, from above.

Every picture is taken from its camera's place straight down, with a projection whose picture plane
is the ground of the plate. So it lies on the plate as it is, however wide the lens, and nothing is
bent: which camera paints a square of the ground, and which squares are blind, the engine says, by
the camera's lens, range and what the vehicle hides. The vehicle is a picture from above.
"""

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from .. import document
from ..engine import pe
from ..overlay import scheduler
from ..overlay.batches import Batches
from ..overlay.birds_eye import FROM_ABOVE, BirdsEye
from ..overlay.layer_cache import shown_of
from ..overlay.layers import BIRDS_EYE, WHOLE_RIG
from ..view import plates, viewport
from ..view.plates import Plate, PlateSize, Room
from . import camera_pictures, sensor_pictures
from .camera_pictures import NEAR_M, Exposure
from .sensor_pictures import PictureSize

PLATE_NAME = "bird's-eye view"
UNSEEN: viewport.Rgba = (0.05, 0.05, 0.05, 0.9)
ABOVE_M = 200.0
TALL_M = 20.0
BELOW_M = 1.0
"""Height of the eye that sees the vehicle, by rays that are all but parallel; how far above and
below the ground pictures reach."""
RAISED_M = 0.009
"""The drawn road is raised to below that of *Surroundings*: what lies lower is shown farther out,
less from a higher camera, and would not fit at seams."""
SHARES = (1.0, 0.8, 0.6, 0.45, 0.3)
"""How far the picture shrinks where there is less room, before it folds into its title."""
BAR_M = 5.0
BAR_PX = 2.0
LINE_PX = 1.4
"""Length and thickness of the bar that tells the scale; width of outlines."""

_uploaded: list[tuple[BirdsEye, dict[str, gpu.types.GPUBatch], Batches]] = []
"""What was drawn last, on the graphics card."""


def clear() -> None:
    """Keep nothing on the graphics card."""
    _uploaded.clear()


def plates_of(context: bpy.types.Context, room: Room) -> list[Plate]:
    """Return the plate, if it is switched on and the engine has said who sees what."""
    region = context.region.as_pointer()
    scene = context.scene
    item = shown_of(scene.name, BIRDS_EYE).get(WHOLE_RIG)
    is_on = scene.perception_entropy.view.show_birds_eye and sensor_pictures.has_room(context)
    if item is None or not is_on:
        camera_pictures.keep_only(region, PLATE_NAME, ())
        return []
    shape = item.shape
    assert isinstance(shape, BirdsEye)
    title = title_of(shape)
    if scheduler.is_preview(scene.name, BIRDS_EYE, WHOLE_RIG, item):
        title += " (preview)"
    proportions = shape.y[1] - shape.y[0], shape.x[1] - shape.x[0]
    largest = sensor_pictures.size_in(context.region, proportions, room)
    folded = sensor_pictures.title_size(title, room)
    pictures = [
        PictureSize(max(int(share * largest.width), 2), max(int(share * largest.height), 2))
        for share in SHARES
    ]
    sizes = [
        PlateSize(max(size.width, folded.width), size.height + folded.height) for size in pictures
    ]

    def draw(box: viewport.PlateBox, step: int) -> None:
        left, bottom, right, top = box
        scale = room.scale
        sensor_pictures.draw_title((left, top - folded.height), title, scale, right)
        if step == len(pictures):
            camera_pictures.keep_only(region, PLATE_NAME, ())
            return
        size = pictures[step]
        picture = left, bottom, left + size.width, bottom + size.height
        viewport.fill_box(picture, UNSEEN)
        _draw_ground(context, shape, size, picture)
        viewport.draw_outline(picture, sensor_pictures.EDGE)
        _draw_ruler((left, bottom), size.width * BAR_M / proportions[0], scale)

    return [Plate(plates.BIRDS_EYE, (*sizes, folded), draw)]


def title_of(shape: BirdsEye) -> str:
    """Return what a plate says of the ground that it shows."""
    ahead = f"{shape.x[1]:.0f} m ahead"
    if not shape.blind_m2:
        return f"Cameras see all ground to {ahead}"
    return f"Cameras alone: {shape.blind_m2:.1f} m² unseen to {ahead}"


def _draw_ruler(corner: tuple[float, float], long: float, scale: float) -> None:
    """Draw a bar that tells the scale."""
    text = f"{BAR_M:g} m"
    small = viewport.SMALL * scale
    pad = sensor_pictures.PAD_PX * scale
    left = corner[0] + pad
    bottom = corner[1] + pad
    right = left + long + 2.0 * pad + viewport.text_size(text, small)[0]
    plate = corner[0], corner[1], right, bottom + small + pad / 2.0
    viewport.fill_box(plate, viewport.PLATE)
    viewport.fill_box((left, bottom, left + long, bottom + BAR_PX * scale), viewport.INK)
    viewport.draw_text(text, left + long + pad, bottom, small, color=viewport.INK)


def _draw_ground(
    context: bpy.types.Context,
    shape: BirdsEye,
    size: sensor_pictures.PictureSize,
    box: viewport.PlateBox,
) -> None:
    """Draw what the pictures show, blind ground and the outline of the vehicle over it."""
    image = viewport.shader("IMAGE")
    if not _uploaded or _uploaded[0][0] is not shape:
        painted = {
            name: batch_for_shader(image, "TRIS", {"pos": corners, "texCoord": corners})
            for name, corners in shape.painted.items()
        }
        _uploaded[:] = [(shape, painted, Batches.of(shape.over))]
    _, painted, over = _uploaded[0]
    looks = looks_of(context.scene, shape)
    camera_pictures.keep_only(context.region.as_pointer(), PLATE_NAME, looks)
    gpu.state.blend_set("NONE")
    with viewport.in_box(box):
        for name, look in looks.items():
            camera = camera_pictures.picture(context, PLATE_NAME, name, look, size=size)
            if camera is not None:
                image.bind()
                image.uniform_sampler("image", camera.texture)
                painted[name].draw(image)
        with viewport.blended():
            over.draw_lines(context.region, LINE_PX, edged=False)


def looks_of(scene: bpy.types.Scene, shape: BirdsEye) -> dict[str, Exposure]:
    """Return from where each picture is taken, by name; none of a camera below the ground."""
    middle = (sum(shape.x) / 2.0, sum(shape.y) / 2.0, ABOVE_M)
    eyes = {FROM_ABOVE: pe.Pose(middle)}
    for name in shape.painted:
        if name != FROM_ABOVE and (obj := scene.objects.get(name)) is not None:
            eyes[name] = document.pose_of_matrix(np.array(obj.matrix_world, dtype=float))
    return {
        name: look_down(eye, shape)
        for name, eye in eyes.items()
        if name in shape.painted and eye.position[2] > NEAR_M
    }


def look_down(eye: pe.Pose, shape: BirdsEye) -> Exposure:
    """Return the exposure straight down from an eye whose picture is the ground of a plate."""
    ex, ey, height = eye.position
    camera_from_ground = Matrix(((0, -1, 0, ey), (1, 0, 0, -ex), (0, 0, 1, -height), (0, 0, 0, 1)))
    across = (ey - shape.y[1], ey - shape.y[0])
    up = (shape.x[0] - ex, shape.x[1] - ex)
    near = max(NEAR_M, height - TALL_M)
    left, right, bottom, top = (near / height * w for w in (*across, *up))
    clip = camera_pictures.frustum(left, right, bottom, top, near=near, far=height + BELOW_M)
    return Exposure(eye, camera_from_ground, clip, RAISED_M)
