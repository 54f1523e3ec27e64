"""The picture of a rig on its vehicle: rendered, with numbered labels and a key. Sensors are drawn
in their colours, with housings of the size that data sheets state."""

import math
from typing import Any, NamedTuple

import numpy as np

import pe_core as pe
from pe_core import catalog, scene
from pe_core.base.arrays import Floats

from ... import advice, graphics, jobs
from ...templating import Markup
from ..report_context import MAX_TRIANGLES, ReportContext
from .brackets import painted_post, post_of
from .painted_mesh import PaintedMesh, lathe, painted_vehicle, rounded_box
from .ray_scene import RayScene, Viewpoint
from .rendering import Environment, render
from .sensor_views import sensor_view
from .svg import Canvas

SIZE = (960, 540)  # Width and height of the picture [px]
FOV_DEG = 26.0
VIEW_DIRECTION = np.array([0.80, -0.58, 0.29])
"""From the vehicle to the default viewpoint: ahead, on the right, a little above."""
KeyRow = tuple[int, str, str, str]
PAPER = graphics.linear_of_srgb(np.array([0.965, 0.97, 0.975]))
FLOOR = graphics.linear_of_srgb(np.array([0.905, 0.912, 0.92]))
NO_VEHICLE_BOUNDS = (np.array([-2.0, -1.0, 0.0]), np.array([2.0, 1.0, 1.5]))
"""Bounds that the picture shows without a vehicle [m]."""
SCALE = 5.0 / 3.0
LINE_PX = 24.0
"""Of the pixels in a picture's file; height of a line below it [px of `SIZE`]."""
HEAD = (
    '<svg xmlns="http://www.w3.org/2000/svg" font-family="Arial, Helvetica, sans-serif" '
    'font-size="15" fill="#1b1f24"'
)
STYLE = "<style>.number { fill: #fff; font-weight: bold }</style>"
LABEL_RISE = 46.0
RADIUS = 15.0
"""Distance of a number above its sensor, and radius of its disc [px]."""
LABEL_SPACING = 34.0
ROUNDS = 40  # Distance between two discs, and steps in which they are moved apart
BEHIND_M = 0.12  # A sensor farther than this behind the visible surface counts as hidden by it
PROUD_M = 0.0005  # Height of a window above the housing's surface
MARK_PX = 7.0
EDGE_COLOR = (0.1, 0.12, 0.14)
REGION_COLOR = "#1aa088"  # As the 3D view tints a free region
WINDOW = (0.02, 0.022, 0.025)


def vehicle_picture(
    vehicle: pe.Vehicle | None, rig: pe.Rig, size: tuple[int, int], *, marked: bool = False
) -> bytes:
    """Return a picture of a rig on its vehicle as a PNG file of a size (width, height) [px].
    Sensors are drawn in their housings, in default ones if their size is not known. The view is
    from ahead on the right, with the whole vehicle in the picture. In a small picture, discs mark
    the sensors, also those that the vehicle hides."""
    view = default_view(vehicle, rig, size)
    picture = rendered(vehicle, rig, size, view)
    if marked:
        _mark(picture, rig, view)
    return graphics.png_bytes(graphics.as_bytes(picture))


def _mark(picture: Floats, rig: pe.Rig, view: Viewpoint) -> None:
    """Draw a disc in a sensor's colour, with a dark edge, over each sensor of a picture."""
    height, width = picture.shape[:2]
    down, right = np.mgrid[:height, :width] + 0.5
    xs, ys = view.project(np.array([s.pose.position for s in rig]), (width, height))
    colors = graphics.sensor_colors_on_paper(rig).values()
    for x, y, color in zip(xs, ys, colors, strict=True):
        far = np.hypot(right - x, down - y)
        picture[far < MARK_PX] = EDGE_COLOR
        picture[far < MARK_PX - 1.5] = color


def rendered(
    vehicle: pe.Vehicle | None, rig: pe.Rig, size: tuple[int, int], view: Viewpoint
) -> Floats:
    """Return a picture of a rig on its vehicle as sRGB (H, W, 3), 0 to 1."""
    colors = graphics.sensor_colors_on_paper(rig)
    solids = [_solid(sensor, colors[sensor.name]) for sensor in rig]
    if vehicle is not None:
        posts = (post_of(vehicle, housing_of(sensor), sensor.pose) for sensor in rig)
        held = [painted_post(post) for post in posts if post is not None]
        solids = [painted_vehicle(vehicle), *solids, *held]
    bodies = RayScene(solids, vehicle is not None)
    return render(view.camera(size), bodies, _studio(_bounds(vehicle, rig)))


def default_view(
    vehicle: pe.Vehicle | None, rig: pe.Rig, size: tuple[int, int] = SIZE
) -> Viewpoint:
    """Return the viewpoint from which a whole vehicle fits into a picture."""
    low, high = _bounds(vehicle, rig)
    target = (low + high) / 2.0
    corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij")).reshape(3, 8).T
    way = VIEW_DIRECTION / math.sqrt(float(VIEW_DIRECTION @ VIEW_DIRECTION))
    far = 2.0 * float(np.abs(high - low).max())
    for _ in range(4):  # each step comes nearer to filling the picture
        view = _view(target + way * far, target)
        right, down = view.project(corners, size)
        spans = (right.max() - right.min()) / size[0], (down.max() - down.min()) / size[1]
        far *= max(spans) / 0.84
    right, down = view.project(corners, size)
    return _view(target + way * far, target)


def _view(eye: Floats, target: Floats) -> Viewpoint:
    return Viewpoint(tuple(eye.tolist()), tuple(target.tolist()), FOV_DEG)


def _bounds(vehicle: pe.Vehicle | None, rig: pe.Rig) -> tuple[Floats, Floats]:
    places = np.array([sensor.pose.position for sensor in rig])
    low, high = NO_VEHICLE_BOUNDS if vehicle is None else vehicle.bounds
    return np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))


def _studio(bounds: tuple[Floats, Floats]) -> Environment:
    """Return a bright room without walls: the floor fades into the paper."""
    low, high = bounds
    middle = (low + high) / 2.0
    half = (high - low) / 2.0
    reach = float(np.hypot(half[0], half[1]))

    def ground(points: Floats, _rays: Floats, _pixel_m: Floats) -> Floats:
        away = np.hypot(points[:, 0] - middle[0], points[:, 1] - middle[1]) / reach
        part = np.clip((away - 1.0) / 1.6, 0.0, 1.0)
        faded = (part * part * (3.0 - 2.0 * part))[:, None]
        return np.asarray(FLOOR + faded * (PAPER - FLOOR))

    return Environment(ground, lambda rays: np.tile(PAPER, (len(rays), 1)))


class LabelledVehicle(NamedTuple):
    """The picture of a rig on its vehicle with numbered sensors, and the key of their numbers."""

    drawing: Markup
    key: list[KeyRow]


def labelled_picture(context: ReportContext, alt: str) -> LabelledVehicle:
    """Return the picture of a study; it is rendered once for all pages that show the study."""
    vehicle = context.display_vehicle[0]
    rig = context.rig
    png = context.cached("still", lambda: vehicle_picture(vehicle, rig, SIZE))
    width, height = map(float, SIZE)
    canvas = Canvas(width, height, alt)
    _draw(canvas, png, vehicle, rig)
    return LabelledVehicle(canvas.svg(), sensor_key(rig))


def region_picture(context: ReportContext, found: advice.FreeRegion, alt: str) -> Markup:
    """Return the picture of a study with a free region over it, as far as that faces the viewer."""
    vehicle = context.display_vehicle[0]
    png = context.cached("still", lambda: vehicle_picture(vehicle, context.rig, SIZE))
    width, height = map(float, SIZE)
    canvas = Canvas(width, height, alt)
    canvas.picture(png, (0.0, 0.0, width, height))
    view = default_view(vehicle, context.rig)
    patch = found.patch
    along = patch[:, 1:] - patch[:, :1]
    across = np.cross(along[:, 0], along[:, 1])
    outward = np.sign((across * found.outward(patch)).sum(axis=1))[:, None] * across
    facing = ((np.array(view.eye) - patch[:, 0]) * outward).sum(axis=1) > 0.0
    right, down = view.project(patch[facing].reshape(-1, 3), SIZE)
    corners = np.round(np.stack([right, down], axis=1), 1).reshape(-1, 6).tolist()
    parts = ("M{:g} {:g}L{:g} {:g}L{:g} {:g}Z".format(*each) for each in corners)
    canvas.add("path", d="".join(parts), fill=REGION_COLOR, fill_opacity=0.6)
    return canvas.svg()


def _draw(canvas: Canvas, png: bytes, vehicle: pe.Vehicle | None, rig: pe.Rig) -> None:
    """Draw a picture with the number of each sensor."""
    canvas.picture(png, (0.0, 0.0, float(SIZE[0]), float(SIZE[1])))
    for label in labels(vehicle, rig, default_view(vehicle, rig)):
        # Draw a disc with a number, and a line to its sensor: dashed if the vehicle hides it.
        end = label.end
        disc = label.disc
        color = graphics.color_text(label.color)
        line = f"M{disc[0]:.1f} {disc[1]:.1f}L{end[0]:.1f} {end[1]:.1f}"
        dashes = "4 4" if label.is_hidden else "none"
        canvas.add("path", d=line, stroke="#1b1f24", stroke_width=1.5, stroke_dasharray=dashes)
        if label.is_hidden:
            canvas.add("circle", cx=end[0], cy=end[1], r=4.0, fill=color, stroke="#1b1f24")
        canvas.add("circle", cx=disc[0], cy=disc[1], r=RADIUS, fill=color, stroke="#1b1f24")
        canvas.text(disc[0], disc[1] + 6.0, str(label.number), text_anchor="middle", css="number")


def picture_file(study: pe.Study, outcome: jobs.Outcome | None = None) -> bytes:
    """Return the picture of a study's rig on its vehicle as an SVG file, with numbers and their
    key; above it the figures of an outcome."""
    vehicle = study.vehicle
    rig = study.rig
    if vehicle is not None:
        vehicle, _ = graphics.simplified(vehicle, MAX_TRIANGLES)
    width, height = map(float, SIZE)
    canvas = Canvas(width, height + LINE_PX * (len(rig) + 1), "The vehicle with its sensors")
    canvas.add("rect", width=width, height=canvas.height, fill="#fff")
    size = round(SCALE * SIZE[0]), round(SCALE * SIZE[1])
    _draw(canvas, vehicle_picture(vehicle, rig, size), vehicle, rig)
    for number, name, model, color in sensor_key(rig):
        down = height + LINE_PX * number
        canvas.add("circle", cx=LINE_PX, cy=down - 5.0, r=6.0, fill=color, stroke="#1b1f24")
        canvas.text(2.0 * LINE_PX, down, f"{number}  {name} ({model})")
    for number, line in enumerate([] if outcome is None else _figures(outcome), 1):
        canvas.text(LINE_PX, LINE_PX * (number + 0.5), line)
    return str(canvas.svg()).replace("<svg", HEAD, 1).replace(">", f">{STYLE}", 1).encode()


def picture_output(request: Any) -> tuple[dict[str, bytes], list[str]]:
    """Return the picture of an `OutputRequest`, which has no figures, as files by name."""
    return {"picture.svg": picture_file(request.study)}, []


def _figures(outcome: jobs.Outcome) -> list[str]:
    """Return entropy and coverage, of a search before and after; first what it searched for."""
    both = [outcome.before, outcome.after][outcome.kind == "score" :]
    arrow = " \N{RIGHTWARDS ARROW} "
    lines = [] if outcome.in_traffic is None else [f"{each.ap:.3f}" for each in outcome.in_traffic]
    lines = [f"Expected AP in traffic {arrow.join(lines)} (higher is better)"] if lines else []
    if (own := outcome.own) is not None:
        lines.append(f"{own.figure.label} {own.before:.3f}{arrow}{own.after:.3f} (lower is better)")
    entropy = [f"{s.entropy:.3f}" for s in both]
    coverage = [f"{s.coverage:.1%}" for s in both]
    lines.append(f"Perception entropy {arrow.join(entropy)} nats (lower is better)")
    return [*lines, f"Coverage {arrow.join(coverage)}"]


class NumberLabel(NamedTuple):
    """The number of a sensor in a picture: positions [px of `SIZE`], and whether it is hidden."""

    number: int
    end: Floats
    disc: Floats
    color: graphics.Rgb
    is_hidden: bool


def labels(vehicle: pe.Vehicle | None, rig: pe.Rig, view: Viewpoint) -> list[NumberLabel]:
    """Return the label of each sensor, in a picture of `SIZE`."""
    positions = np.array([sensor.pose.position for sensor in rig])
    ends = np.stack(view.project(positions, SIZE), axis=1)
    rays = positions - np.array(view.eye)
    distance = np.sqrt((rays * rays).sum(axis=1))
    hidden = np.zeros(len(rays), bool)
    if vehicle is not None:
        hits = vehicle.first_hit_from(np.array(view.eye), rays / distance[:, None])
        hidden = np.asarray(hits.distance < distance - BEHIND_M)
    discs = spread_apart(ends - [0.0, LABEL_RISE])
    colors = graphics.sensor_colors_on_paper(rig).values()
    numbers = range(1, len(ends) + 1)
    rows = zip(numbers, ends, discs, colors, hidden.tolist(), strict=True)
    return [NumberLabel._make(row) for row in rows]


def sensor_key(rig: pe.Rig) -> list[KeyRow]:
    """Return number, name, model and colour of each sensor."""
    colors = graphics.sensor_colors_on_paper(rig)
    return [
        (number, sensor.name, sensor.model.name, graphics.color_text(colors[sensor.name]))
        for number, sensor in enumerate(rig, 1)
    ]


def spread_apart(positions: Floats) -> Floats:
    """(N, 2) positions moved until all are `LABEL_SPACING` apart and inside the picture [px]."""
    moved = positions.copy()
    for _ in range(ROUNDS):
        apart = moved[:, None] - moved[None]
        distance = np.sqrt((apart * apart).sum(axis=2))
        # Two labels at one position are moved to the left and the right, by their numbers.
        sides = np.sign(np.subtract.outer(np.arange(len(moved)), np.arange(len(moved))))
        apart[distance < 1e-6, 0] = sides[distance < 1e-6]
        push = np.maximum(LABEL_SPACING - distance, 0.0) * (sides != 0)
        length = np.maximum(distance, 1.0)
        moved = moved + (apart / length[..., None] * push[..., None]).sum(axis=1) / 2.0
        moved = np.clip(moved, RADIUS + 2.0, np.array(SIZE) - RADIUS - 2.0)
    return moved


def housing_of(sensor: pe.Sensor) -> scene.Housing:
    """Return a sensor's housing; the default of its kind if the catalogue knows no size."""
    return catalog.housing(sensor.model.name) or sensor_view(sensor.kind).housing


def _solid(sensor: pe.Sensor, rgb: tuple[float, float, float]) -> PaintedMesh:
    housing = housing_of(sensor)
    paint = tuple(graphics.linear_of_srgb(np.array(rgb)).tolist())
    shape = _cylinder_parts if housing.shape == "cylinder" else _box_parts
    parts = shape(np.array(housing.size))
    triangles = np.concatenate(parts) + housing.center
    placed = scene.rotate(sensor.pose.ground_from_sensor, triangles.reshape(-1, 3))
    placed = placed + np.array(sensor.pose.position)
    numbers = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    mesh = pe.Vehicle(placed.reshape(-1, 3, 3), numbers, [f"part {k}" for k in range(len(parts))])
    return PaintedMesh(mesh, (paint, WINDOW)[: len(parts)])


def _cylinder_parts(size: Floats) -> list[Floats]:
    """Return a cylinder around the origin, and the window around it."""
    r = size[0] / 2.0
    h = size[2] / 2.0
    body = [(0.0, -h), (r, -h), (r, -0.35 * h), (0.94 * r, -0.35 * h)]
    upper = [(0.94 * r, 0.55 * h), (r, 0.55 * h), (r, 0.9 * h), (0.9 * r, h), (0.0, h)]
    window = [(0.94 * r, -0.35 * h), (0.94 * r, 0.55 * h)]
    return [np.concatenate([lathe(body), lathe(upper)]), lathe(window)]


def _box_parts(size: Floats) -> list[Floats]:
    """Return a box around the origin, and a round window at its front."""
    box = rounded_box(size / 2.0)
    radius = 0.36 * float(min(size[1], size[2]))
    disc = lathe([(radius, 0.0), (0.8 * radius, 0.004), (0.0, 0.004)])
    front = np.stack([disc[..., 2], disc[..., 0], disc[..., 1]], axis=-1)
    return [box, front + np.array([size[0] / 2.0 + PROUD_M, 0.0, 0.0])]
