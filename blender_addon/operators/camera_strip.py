"""The pictures of all cameras along the lower edge of the 3D view, in a strip that takes clicks."""

from collections.abc import Sequence
from typing import Any

import bpy

from ..caches import sensor_cache
from ..engine import pe
from ..sensor_kinds import row_of
from ..view import plates, viewport
from ..view.plates import Plate, PlateSize, Room
from ..view.viewport import DrawRegion
from . import camera_pictures, sensor_pictures
from .declared import declared
from .sensor_pictures import PictureSize, has_room, sensor_of

STRIP_PX = 92.0
GAP_PX = 6.0
"""Height of the pictures of the strip and the gaps between them, at a scale of 1."""
MAX_SHARE = 0.14
"""Of the view's height that the pictures take at most, at any scale."""
SHARES = (1.0, 0.7, 0.5)
LEAST_PX = 24.0
"""Heights of the pictures where there is less room, and the least that shows anything."""
PLATE_NAME = "cameras"
_in_strip: dict[int, list[tuple[str, viewport.PlateBox]]] = {}
"""Sensors and their pictures in the strip, by the region's pointer."""


def clear() -> None:
    """Forget where pictures are."""
    _in_strip.clear()


def shown_cameras(context: bpy.types.Context) -> list[tuple[pe.Sensor, pe.Camera]]:
    """Return the visible cameras, where the view is to show the strip."""
    if not context.scene.perception_entropy.view.show_cameras or not has_room(context):
        return []
    visible = (each for each in sensor_cache.sensors(context.scene) if each.visible_get())
    possible = (sensor for each in visible if (sensor := sensor_of(each)) is not None)
    rows = ((sensor, row_of(sensor.kind).camera) for sensor in possible)
    return [(sensor, camera_of(sensor.model)) for sensor, camera_of in rows if camera_of]


def plates_of(context: bpy.types.Context, room: Room) -> list[Plate]:
    """Return the plate of all cameras' pictures in a row; folded, it is their number."""
    region = context.region.as_pointer()
    scale = room.scale
    _in_strip.pop(region, None)
    cameras = shown_cameras(context)
    camera_pictures.keep_only(region, PLATE_NAME, {sensor.name for sensor, _ in cameras})
    if not cameras:
        return []
    rows = rows_in(context.region, [(each.width, each.height) for _, each in cameras], room)
    title = f"{len(cameras)} cameras" if len(cameras) > 1 else cameras[0][0].name
    sizes = [size_of_row(row, scale) for row in rows]

    def draw(box: viewport.PlateBox, step: int) -> None:
        if step == len(rows):
            camera_pictures.keep_only(region, PLATE_NAME, ())
            sensor_pictures.draw_title((box[0], box[1]), title, scale, box[2])
        else:
            _in_strip[region] = draw_row(context, (box[0], box[1]), cameras, rows[step])

    return [Plate(plates.CAMERAS, (*sizes, sensor_pictures.title_size(title, room)), draw)]


def draw_row(
    context: bpy.types.Context,
    corner: tuple[float, float],
    cameras: Sequence[tuple[pe.Sensor, pe.Camera]],
    sizes: Sequence[PictureSize],
) -> list[tuple[str, viewport.PlateBox]]:
    """Draw the pictures of cameras from a corner on [px]; return their names and boxes."""
    scale = viewport.ui_scale()
    left, bottom = corner
    drawn = []
    for (sensor, model), size in zip(cameras, sizes, strict=True):
        look = camera_pictures.look_of(sensor.pose, model)
        camera = camera_pictures.picture(context, PLATE_NAME, sensor.name, look, size=size)
        if camera is not None:
            sensor_pictures.draw_picture(camera.texture, (left, bottom), size)
        box = sensor_pictures.draw_frame((left, bottom), size, sensor.name, scale)
        drawn.append((sensor.name, box))
        left += size.width + GAP_PX * scale
    return drawn


def size_of_row(row: Sequence[PictureSize], scale: float) -> PlateSize:
    """Return the size of a row of pictures with their titles [px]."""
    width = sum(size.width for size in row) + GAP_PX * scale * (len(row) - 1)
    return PlateSize(width, row[0].height + sensor_pictures.TITLE_PX * scale)


def rows_in(
    region: DrawRegion, pictures: list[tuple[int, int]], room: Room
) -> list[list[PictureSize]]:
    """Return the sizes of pictures of these proportions in a row, from the largest row to the
    smallest that shows anything."""
    highest = min(STRIP_PX * room.scale, MAX_SHARE * region.height)
    rows = [strip_sizes(room.width, share * highest, pictures, room.scale) for share in SHARES]
    return [row for row in rows if row[0].height >= LEAST_PX * room.scale]


def strip_sizes(
    width: float, highest: float, pictures: list[tuple[int, int]], scale: float
) -> list[PictureSize]:
    """Return the sizes of pictures of these proportions in a row, as high as the width allows and
    at most `highest` [px]."""
    ratios = [across / up for across, up in pictures]
    room = width - GAP_PX * scale * (len(ratios) - 1)
    height = max(min(highest, room / sum(ratios)), 2.0)
    return [PictureSize(max(int(ratio * height), 2), int(height)) for ratio in ratios]


def picture_at(region: int, location: tuple[float, float]) -> str:
    """Return the sensor whose picture in the strip is at a location in a region [px]; "": none."""
    x, y = location
    for name, (left, bottom, right, top) in _in_strip.get(region, ()):
        if left <= x <= right and bottom <= y <= top:
            return name
    return ""


@declared
class PE_GT_camera_strip(bpy.types.Gizmo):
    """Takes the clicks on pictures in the strip."""

    bl_idname = "PE_GT_camera_strip"

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw nothing: the pictures are there."""

    def test_select(self, context: bpy.types.Context, location: tuple[float, float]) -> int:
        """Whether the mouse is over a picture: 0, else -1."""
        return 0 if picture_at(context.region.as_pointer(), location) else -1

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Look through the camera under the mouse."""
        name = picture_at(context.region.as_pointer(), (event.mouse_region_x, event.mouse_region_y))
        if name and bpy.ops.pe.look_through.poll():
            bpy.ops.pe.look_through("INVOKE_DEFAULT", name=name)
        return {"FINISHED"}

    def modal(self, _context: bpy.types.Context, _event: Any, _tweak: set[str]) -> set[str]:
        """End: Blender invokes no gizmo without this."""
        return {"FINISHED"}


@declared
class PE_GGT_camera_strip(bpy.types.GizmoGroup):
    """The strip of cameras takes clicks while it is shown."""

    bl_idname = "PE_GGT_camera_strip"
    bl_label = "Camera Strip"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"PERSISTENT"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the strip is shown."""
        return bool(context.scene.perception_entropy.view.show_cameras)

    def setup(self, _context: bpy.types.Context) -> None:
        """Make the one gizmo."""
        self.gizmos.new(PE_GT_camera_strip.bl_idname)
