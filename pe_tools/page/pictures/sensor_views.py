"""What each sensor sees, as a figure: a row for each kind of sensor. A camera's image is rendered
through its own lens; a LiDAR's ranges are an image of channels and azimuths. Persons and cars of
known size stand in front of both. Of a kind without a row, the parameters are shown."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
from pe_core import scene
from pe_core import sensors as kinds
from pe_core.base.arrays import Floats
from pe_core.sensors.camera.model import camera_of
from pe_core.sensors.lidar.model import lidar_of

from ... import graphics
from ...templating import Markup
from ..markup import number, signed
from .painted_mesh import painted_vehicle
from .ray_scene import RayCamera, RayScene
from .reference_figures import DISTANCES, reference_figures
from .rendering import Environment, render
from .svg import LETTER_WIDTH, Canvas, LabelledPicture

# Size of a camera's image on the page [px]
MAX_WIDTH = 640
MAX_HEIGHT = 480
ROAD, RING, ZENITH, HORIZON = graphics.linear_of_srgb(
    np.array([(0.50, 0.51, 0.52), (0.93, 0.94, 0.95), (0.62, 0.74, 0.86), (0.90, 0.92, 0.93)])
)
RING_M = 0.05  # Half the width of a ring's line
MIN_LINE_PX = 0.6
FADED_M = (30.0, 160.0)  # Distances at which the ground begins and ends to fade into the horizon
CIRCLE_WIDTH = 720
MIN_ROWS_HEIGHT = 144
MAX_ROW_HEIGHT = 12
"""Size of a LiDAR's image [px]: a full circle, all rows at least, one row at most."""
SIDES = {"behind": -180.0, "right": -90.0, "ahead": 0.0, "left": 90.0, "behind ": 180.0}
"""Azimuths that are labelled [deg]; both ends of a full circle are behind."""
FIGURES_RAD = math.radians(80.0)
"""Half the azimuth range in which persons and cars stand before a LiDAR."""
FIELD_PX = 2  # Pixels for each range and azimuth of a picture of detections
KEY_WIDTH = 190.0
SMALL_BOX = scene.Housing("box", (0.05, 0.06, 0.05), (0.025, 0.0, 0.025))
"""About the size of a camera module."""


ViewFigure = tuple[Markup | list[str], str]


@dataclass(frozen=True, slots=True)
class SensorView:
    """How the page shows the sensors of one kind. `figure` returns a drawing (or lines of text) of
    what a sensor sees beside a vehicle or None, and a caption. `housing` is drawn where the
    catalogue knows no size. `image_field` returns width and height of a model's image [deg], or
    None."""

    figure: Callable[[pe.Sensor, pe.Vehicle | None], ViewFigure]
    housing: scene.Housing = SMALL_BOX
    image_field: Callable[[Any], tuple[float, float] | None] = lambda _model: None


def sensor_view(kind: str) -> SensorView:
    """Return how sensors of a kind are shown, by the kind's name."""
    return SENSOR_VIEWS.get(kind, OTHER_KIND)


def _parameter_figure(sensor: pe.Sensor, _vehicle: pe.Vehicle | None) -> ViewFigure:
    """Return the parameters of a sensor whose kind has no picture."""
    kind = kinds.kind_of(sensor)
    lines = [*kind.data_sheet(sensor.model), *kind.plot(sensor.model)]
    return lines, f"{kind.label}: no picture is available for this kind of sensor."


def camera_figure(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> ViewFigure:
    """Return a camera's image with a caption."""
    camera = camera_of(sensor)
    lens = camera.projection.model.replace("_", " ")
    alt = f"Image of {sensor.name}: persons on the left and cars on the right"
    caption = f"{camera.width} × {camera.height} px, {lens} lens, rendered through this lens."
    return camera_picture(sensor, vehicle).svg(alt), caption


def lidar_figure(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> ViewFigure:
    """Return a LiDAR's range image with its key and a caption."""
    lidar = lidar_of(sensor)
    alt = f"Ranges of {sensor.name} by azimuth: persons left of ahead and cars right of it"
    drawing = lidar_picture(sensor, vehicle).svg(alt) + range_key(lidar.max_range)
    min_range = f"{number(lidar.min_range, 1)} to " if lidar.min_range >= 0.1 else ""
    caption = (
        f"A row for each channel ({len(lidar.elevations)}), a column for each azimuth; "
        f"range {min_range}{lidar.max_range:g} m."
    )
    return drawing, caption


def camera_picture(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> LabelledPicture:
    """Return the image of a camera with persons and cars in front of it."""
    rays, scale = ray_camera(sensor)
    figures = reference_figures(sensor, camera_of(sensor).hfov / 2.0, vehicle)
    solids = [] if vehicle is None else [painted_vehicle(vehicle)]
    road = RayScene([*solids, *(target.painted for target in figures)], vehicle is not None)
    image = render(rays, road, _road_environment(sensor))
    png = graphics.png_bytes(graphics.as_bytes(image))
    lens = camera_of(sensor).projection
    labels = []
    for target in figures:  # labels are above heads and roofs, where these are in the image
        offset = np.subtract(target.top, sensor.pose.position)[None]
        ahead, left, up = scene.rotate(sensor.pose.ground_from_sensor.T, offset).T
        if math.atan2(math.hypot(left[0], up[0]), ahead[0]) < lens.edge:
            x, y = (float(v[0]) * scale for v in lens.project(ahead, left, up))
            if 0.0 <= x <= rays.width and 0.0 <= y <= rays.height:
                labels.append((round(x, 1), round(y, 1), target.label))
    return LabelledPicture(png, rays.width, rays.height, tuple(labels))


def ray_camera(sensor: pe.Sensor) -> tuple[RayCamera, float]:
    """Return the rays of a camera's image, reduced to the page's size, and the scale of it."""
    camera = camera_of(sensor)
    scale = min(1.0, MAX_WIDTH / camera.width, MAX_HEIGHT / camera.height)
    width, height = (max(1, round(n * scale)) for n in (camera.width, camera.height))
    across = camera.width / width
    down = camera.height / height
    lens = camera.projection
    ground_from_sensor = sensor.pose.ground_from_sensor

    def rays_through(x: Floats, y: Floats) -> Floats:
        return scene.rotate(ground_from_sensor, lens.unproject(x * across, y * down))

    middle = np.array([width / 2.0, width / 2.0 + 1.0])
    one, two = rays_through(middle, np.full(2, height / 2.0))
    pixel_rad = math.sqrt(float(((two - one) ** 2).sum()))
    eye = np.array(sensor.pose.position)
    return RayCamera(
        eye, width, height, rays_through, pixel_rad=pixel_rad, from_sensor=True
    ), 1.0 / across


def _road_environment(sensor: pe.Sensor) -> Environment:
    """Return a road with rings around the sensor, under a clear sky."""
    foot = np.array(sensor.pose.position[:2])

    def ground(points: Floats, rays: Floats, pixel_m: Floats) -> Floats:
        away = np.hypot(points[:, 0] - foot[0], points[:, 1] - foot[1])
        half = np.maximum(RING_M, MIN_LINE_PX / 2.0 * pixel_m)
        line = np.zeros(len(points))
        for radius in DISTANCES:
            inside = half + pixel_m / 2.0 - np.abs(away - radius)
            line = np.maximum(line, np.clip(inside / np.maximum(pixel_m, 1e-6), 0.0, 1.0))
        road = ROAD + 0.75 * line[:, None] * (RING - ROAD)
        part = np.clip((away - FADED_M[0]) / (FADED_M[1] - FADED_M[0]), 0.0, 1.0)
        faded = (part**0.7)[:, None]
        return np.asarray(road + faded * (sky(rays) - road))

    def sky(rays: Floats) -> Floats:
        up = np.clip(rays[:, 2], 0.0, 1.0)[:, None] ** 0.6
        return np.asarray(HORIZON * (1.0 - up) + ZENITH * up)

    return Environment(ground, sky)


def lidar_picture(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> LabelledPicture:
    """Return the ranges of a LiDAR with persons and cars in front of it."""
    lidar = lidar_of(sensor)
    half = min(FIGURES_RAD, (lidar.horizontal_fov[1] - lidar.horizontal_fov[0]) / 2.0)
    figures = reference_figures(sensor, half, vehicle)
    joint = None
    if figures:  # one mesh, a part for each
        meshes = [target.painted.mesh.triangles for target in figures]
        parts = np.repeat(np.arange(len(meshes)), [len(triangles) for triangles in meshes])
        names = [f"thing {k}" for k in range(len(meshes))]
        joint = pe.Vehicle(np.concatenate(meshes), parts, names)
    ranges = kinds.range_picture(sensor, vehicle, joint)
    columns = _pixel_azimuths(ranges)
    channels = len(ranges.elevations)
    row_px = int(np.clip(math.ceil(MIN_ROWS_HEIGHT / channels), 1, MAX_ROW_HEIGHT))
    rows = np.repeat(np.arange(channels), row_px)
    colors = graphics.range_colors(ranges, lidar.max_range)[np.ix_(rows, columns)]
    png = graphics.png_bytes(graphics.as_bytes(colors))
    labels = []  # figures that no beam meets have none
    for index, target in enumerate(figures):
        down, across = np.nonzero(ranges.things[:, columns] == index)
        if len(down):
            place = float(np.median(across)) + 0.5, float(down.min() * row_px)
            labels.append((*place, target.label))
    width = len(columns)
    height = len(rows)
    return LabelledPicture(png, width, height, tuple(labels), *_axis_labels(ranges, width, height))


def _axis_labels(
    ranges: kinds.RangePicture, width: int, height: int
) -> tuple[tuple[tuple[float, str], ...], tuple[tuple[float, str], ...]]:
    """Return the sides along a range image, and the elevations of its first and last channel."""
    left, right = np.degrees(ranges.azimuths[[0, -1]]).tolist()
    top, bottom = np.degrees(ranges.elevations[[0, -1]]).tolist()
    ends = ((0.0, f"{signed(top, 0)}°"), (float(height), f"{signed(bottom, 0)}°"))
    sides: dict[str, float] = {}
    if left > right:
        sides = {side: (left - at) / (left - right) * width for side, at in SIDES.items()}
    shown = ((round(x, 1), side) for side, x in sides.items() if -1.0 < x < width + 1.0)
    return tuple(shown), ends if len(ranges.elevations) > 1 else ends[:1]


def _pixel_azimuths(ranges: kinds.RangePicture) -> NDArray[np.int64]:
    """(W,) index of the azimuth that each pixel shows. It is the nearest one; if a pixel stands for
    several, the first that meets a figure."""
    if len(ranges.azimuths) == 1:
        return np.zeros(1, np.int64)
    nearest = graphics.even_angles(ranges.azimuths, CIRCLE_WIDTH / 360.0)
    ends = np.append(nearest[1:], len(ranges.azimuths))
    met = (ranges.things >= 0).any(axis=0)
    for pixel in np.flatnonzero(ends > nearest + 1):
        meeting = np.flatnonzero(met[nearest[pixel] : ends[pixel]])
        if len(meeting):
            nearest[pixel] += meeting[0]
    return nearest


def field_figure(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> ViewFigure:
    """Return what a radar or an ultrasonic sensor detects by range and azimuth, with a caption."""
    kind = kinds.kind_of(sensor)
    picture = kind.field_picture(sensor, vehicle)
    assert picture is not None
    colors = graphics.field_colors(picture)
    colors = np.repeat(np.repeat(colors, FIELD_PX, axis=0), FIELD_PX, axis=1)
    height, width = colors.shape[:2]
    png = graphics.png_bytes(graphics.as_bytes(colors))
    degrees = np.degrees(picture.azimuths[[0, len(picture.azimuths) // 2, -1]]).tolist()
    places = (0.0, width / 2.0, float(width))
    bottom = tuple((x, f"{signed(a, 0)}°") for x, a in zip(places, degrees, strict=True))
    far = float(picture.ranges[0] + picture.ranges[-1])  # they are middles of equal steps
    left = (0.0, f"{far:.3g} m"), (height / 2.0, f"{far / 2.0:.3g} m")
    shown = LabelledPicture(png, width, height, labels=(), bottom_labels=bottom, left_labels=left)
    alt = f"What {sensor.name} detects by range and azimuth"
    caption = (
        f"Range upwards, azimuth across, left is left: {kind.unit} of a {picture.target} whose "
        f"middle is {picture.height_m:.2f} m high. Bright is many; orange: occluded by the "
        "vehicle; grey: not detected."
    )
    return shown.svg(alt), caption


def range_key(far_m: float) -> Markup:
    """Return the key of a range image: its colours from near to far."""
    alt = f"Key: near is bright, {far_m:g} m is dark; orange is the own body"
    canvas = Canvas(640.0, 34.0, alt)
    scale = graphics.RANGES
    width = KEY_WIDTH / 24
    for k in range(24):
        fill = graphics.color_text(graphics.on_scale(k / 23.0, scale).tolist())
        canvas.add("rect", x=k * width, y=0.0, width=width + 0.4, height=10.0, fill=fill)
    canvas.text(0.0, 27.0, "0.5 m and nearer", css="mark")
    canvas.text(KEY_WIDTH, 27.0, f"{far_m:g} m", text_anchor="end", css="mark")
    at = KEY_WIDTH + 30.0
    for color, name in ((graphics.BODY_NEAR, "own body"), (graphics.NO_ECHO, "no return")):
        canvas.add("rect", x=at, y=0.0, width=14.0, height=14.0, fill=graphics.color_text(color))
        canvas.text(at + 20.0, 12.0, name, css="mark")
        at += 44.0 + LETTER_WIDTH * len(name)
    return canvas.svg()


SENSOR_VIEWS = {
    "lidar": SensorView(
        lidar_figure, housing=scene.Housing("cylinder", (0.11, 0.11, 0.08), (0.0, 0.0, 0.04))
    ),
    "camera": SensorView(
        camera_figure,
        image_field=lambda camera: (math.degrees(camera.hfov), math.degrees(camera.vfov)),
    ),
    "radar": SensorView(
        field_figure, housing=scene.Housing("box", (0.03, 0.13, 0.09), (0.015, 0.0, 0.0))
    ),
    "ultrasonic": SensorView(
        field_figure, housing=scene.Housing("box", (0.02, 0.03, 0.03), (0.01, 0.0, 0.0))
    ),
}  # A row for each kind of sensor, by its name
OTHER_KIND = SensorView(_parameter_figure)  # Of kinds that have no row
