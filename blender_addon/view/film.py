"""A drive-by as a film: bodies, lines, moments and strip as geometry of a scene of its own.

What the 3D view shows over its picture is drawn on the graphics card, and Blender's Render
Animation does not have it. So the same is built of meshes with keyframes, beside the objects of the
scene, and Workbench renders it: with a window or without, wherever OpenGL is, in software as well.
"""

import math
import tempfile
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .. import document
from ..engine import Floats, graphics, motion, pe, text

WEBM = ".webm"
FORMATS = {WEBM: ("WEBM", "WEBM"), ".mp4": ("MPEG4", "H264")}
"""Container and codec of FFmpeg by the file's suffix."""
NO_FILM = "FFmpeg in it, and OpenGL"
POLL_S = 0.5
TOLD_S = 8.0
"""How often a window looks whether a film is done, and how long it says so."""
SIZE_PX = 1280, 720
ENGINE = "BLENDER_WORKBENCH"
SHOWN = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "LIGHT"}
BACK = (0.055, 0.06, 0.066, 1.0)
GROUND = (0.12, 0.125, 0.135, 1.0)
DASH = (0.42, 0.43, 0.45, 1.0)
INK = (0.9, 0.9, 0.9, 1.0)
FAINT = (0.7, 0.7, 0.7, 1.0)
PLATE = (0.08, 0.085, 0.09, 1.0)
HIDES_ALPHA = 0.45
RAY_M = 0.035
POST_M = 0.06
DASH_M = 3.0
GAP_M = 6.0
LANE_M = 1.75
FAR_M = 240.0
FOV = math.radians(50.0)
SHIFT = -0.13
SIDE = 0.93
BASE = -0.5
ROW = 0.033
LETTER = 0.024
"""Of the strip: half its width, its lower edge, the height of a row and of letters, as shares of
half the picture's width."""
EXPOSURE = 1.3
"""What faces the camera gets back the light that the studio takes [stops]."""
NEAR_TO = 0.024  # Height of a name, as a share of its distance from the camera
GOP = 12  # Frames from one key frame to the next: a page jumps to any moment


def write_film(
    scene: bpy.types.Scene, study: pe.Study, scenario: motion.Scenario, path: Path
) -> None:
    """Render a scenario as a film, and write the file once it is complete; its scene is left.
    Render Animation renders that scene again. `InputError` where the suffix is none of
    `FORMATS`."""
    check_suffix(path)
    film = film_scene(scene, study, scenario)
    with tempfile.TemporaryDirectory() as folder:
        made = _rendered_to(film, folder, path.suffix)
        bpy.ops.render.render(animation=True, scene=film.name)
        if not made.is_file():
            raise pe.InputError("film", "Blender", NO_FILM, "no film")
        text.write_bytes(path, made.read_bytes())


class FilmRender:
    """A film that Blender renders beside its window, which shows how far it is; Esc ends it, and
    keeps the frames that are done. The file is written in the end."""

    def __init__(
        self, scene: bpy.types.Scene, study: pe.Study, scenario: motion.Scenario, path: Path
    ) -> None:
        check_suffix(path)
        film = film_scene(scene, study, scenario)
        self.path = path
        self._folder = tempfile.TemporaryDirectory()
        self._made = _rendered_to(film, self._folder.name, path.suffix)
        view = bpy.context.preferences.view
        display = view.render_display_type
        view.render_display_type = "NONE"  # else an image editor takes the view's place
        try:
            bpy.ops.render.render("INVOKE_DEFAULT", animation=True, scene=film.name)
        finally:
            view.render_display_type = display
        bpy.app.timers.register(self._poll, first_interval=POLL_S)

    def _poll(self) -> float | None:
        """Timer: write the file once nothing is rendered any more."""
        if bpy.app.is_job_running("RENDER"):
            return POLL_S
        is_made = self._made.is_file()
        if is_made:
            text.write_bytes(self.path, self._made.read_bytes())
        self._folder.cleanup()
        _tell(f"Wrote {self.path}" if is_made else f"No film: {NO_FILM}")
        return None


def _tell(line: str) -> None:
    """Show a line in the status bar for some time."""

    def clear() -> None:
        for workspace in bpy.data.workspaces[:1]:
            workspace.status_text_set(None)

    for workspace in bpy.data.workspaces[:1]:
        workspace.status_text_set(line)
    bpy.app.timers.register(clear, first_interval=TOLD_S)


def _rendered_to(film: bpy.types.Scene, folder: str, suffix: str) -> Path:
    """Have a film rendered into a folder; return its file."""
    made = Path(folder) / f"film{suffix}"
    film.render.filepath = str(made)
    film.render.ffmpeg.format, film.render.ffmpeg.codec = FORMATS[suffix]
    return made


def check_suffix(path: Path) -> None:
    """`InputError` where a film's suffix is none of `FORMATS`."""
    if path.suffix not in FORMATS:
        raise pe.InputError("film", "file", f"a name that ends in {' or '.join(FORMATS)}", path)


def film_scene(
    scene: bpy.types.Scene, study: pe.Study, scenario: motion.Scenario
) -> bpy.types.Scene:
    """Return a new scene that shows a scenario as the rig of a study sees it."""
    driven = study.drive_by(scenario)
    render = scene.render
    moving = graphics.BodiesInTime.of(driven, study.vehicle, render.fps / render.fps_base)
    film = bpy.data.scenes.new(f"Drive-by {scenario.name}")
    for obj in scene.objects:
        shown = obj.type in SHOWN or obj.instance_type == "COLLECTION"
        shown = shown and not document.in_surroundings(obj)
        if shown and not obj.hide_render and obj.visible_get(view_layer=scene.view_layers[0]):
            film.collection.objects.link(obj)
    stage = _Stage(film, scene.frame_start, len(moving.times))
    _set_up(film, scene, driven, len(moving.times))
    camera = stage.camera(scene, driven, moving, study.vehicle)
    _street(stage, scenario)
    places = {sensor.name: Vector(sensor.pose.position) for sensor in study.rig}
    for body in moving.bodies:
        _body(stage, camera, moving, body, places=places)
    _strip(stage, camera, graphics.time_strip(driven), moving.times)
    return film


def _set_up(
    film: bpy.types.Scene, scene: bpy.types.Scene, driven: motion.DriveBy, count: int
) -> None:
    """Set how a film is rendered: by Workbench, with what identifies the drive-by in the file."""
    render = film.render
    shading = film.display.shading
    render.engine = ENGINE
    render.fps = scene.render.fps
    render.fps_base = scene.render.fps_base
    render.resolution_x, render.resolution_y = SIZE_PX
    film.frame_end = scene.frame_start + count - 1
    film.frame_start = scene.frame_start
    if hasattr(render.image_settings, "media_type"):  # since 5.0
        render.image_settings.media_type = "VIDEO"
    render.image_settings.file_format = "FFMPEG"
    render.ffmpeg.constant_rate_factor = "HIGH"
    render.ffmpeg.gopsize = GOP
    film.view_settings.view_transform = "Standard"
    film.view_settings.exposure = EXPOSURE
    film.display.render_aa = "FXAA"  # samples take four times as long in software
    shading.light = "STUDIO"
    shading.color_type = "MATERIAL"
    shading.show_shadows = True
    shading.shadow_intensity = 0.35
    shading.show_specular_highlight = False
    film.world = bpy.data.worlds.new("Film")
    film.world.color = BACK[:3]
    render.use_stamp_note = True
    render.stamp_note_text = graphics.digest(driven)


class _Stage(NamedTuple):
    """What makes objects of a film with their keyframes."""

    film: bpy.types.Scene
    start: int
    frames: int

    def mesh(
        self, name: str, corners: Any, faces: Sequence[Sequence[int]], color: graphics.Rgba
    ) -> bpy.types.Object:
        """Return a mesh of one colour."""
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([tuple(map(float, c)) for c in corners], [], [list(f) for f in faces])
        obj = self._add(name, mesh)
        mesh.materials.append(_material(name, color))
        return obj

    def box(self, name: str, color: graphics.Rgba) -> bpy.types.Object:
        """Return a cube with sides of 1 m."""
        return self.mesh(name, graphics.CORNERS, graphics.FACES, color)

    def words(
        self, words: str, size: float, color: graphics.Rgba, align: str = "LEFT"
    ) -> bpy.types.Object:
        """Return a line of text."""
        curve = bpy.data.curves.new(words, "FONT")
        curve.body = words
        curve.size = size
        curve.align_x = align
        curve.materials.append(_material(words, color))
        return self._add(words, curve)

    def _add(self, name: str, data: Any) -> bpy.types.Object:
        obj = bpy.data.objects.new(name, data)
        obj.display.show_shadows = False
        self.film.collection.objects.link(obj)
        return obj

    def keys(self, owner: Any, path: str, values: Sequence[Any]) -> None:
        """Set a keyframe at each frame."""
        for k, value in enumerate(values):
            setattr(owner, path, value)
            owner.keyframe_insert(path, frame=self.start + k)

    def camera(
        self,
        scene: bpy.types.Scene,
        driven: motion.DriveBy,
        moving: graphics.BodiesInTime,
        vehicle: pe.Vehicle | None,
    ) -> bpy.types.Object:
        """Return the scene's own camera; else one behind the vehicle, across from the bodies."""
        own = scene.camera
        if own is not None and not own.perception_entropy.is_view:
            self.film.collection.objects.link(own)
            self.film.camera = own
            return own
        data = bpy.data.cameras.new("Film")
        data.angle = FOV
        data.clip_start = 0.05
        way = -1.0 if driven.scenario.speed < 0.0 else 1.0
        seen = [body.positions for body in moving.bodies if body.seen is not None]
        side = -1.0 if float(np.mean([at[:, 1].mean() for at in seen])) > 0.0 else 1.0
        reach = 2.4 if vehicle is None else float(np.abs(np.array(vehicle.bounds)[:, 0]).max())
        data.shift_y = SHIFT  # the strip is below
        eye = Vector((-way * (reach + 8.0), side * 4.5, 5.4))
        target = Vector((way * (reach + 5.5), -side * 1.0, 0.0))
        camera = self._add("Film", data)
        turn = (target - eye).to_track_quat("-Z", "Y")
        camera.matrix_world = Matrix.LocRotScale(eye, turn, None)
        self.film.camera = camera
        return camera


def _material(name: str, color: graphics.Rgba) -> bpy.types.Material:
    """Return a material of a colour; Blender takes linear light."""
    made = bpy.data.materials.new(name)
    made.diffuse_color = _linear(color)
    return made


def _linear(color: graphics.Rgba) -> tuple[float, ...]:
    return (*graphics.linear_of_srgb(np.array(color[:3])).tolist(), color[3])


def _street(stage: _Stage, scenario: motion.Scenario) -> None:
    """Add the ground, and dashes that go by with the vehicle's own speed."""
    corners = [(-FAR_M, -FAR_M, -0.03), (FAR_M, -FAR_M, -0.03), (FAR_M, FAR_M, -0.03)]
    stage.mesh("ground", [*corners, (-FAR_M, FAR_M, -0.03)], [(0, 1, 2, 3)], GROUND)
    dash = np.array([(0.0, -0.06, -0.02), (DASH_M, -0.06, -0.02), (DASH_M, 0.06, -0.02)])
    dash = np.vstack([dash, (0.0, 0.06, -0.02)])
    starts = product(np.arange(-FAR_M, FAR_M, DASH_M + GAP_M), (-LANE_M, LANE_M))
    dashes = np.concatenate([np.add(dash, (x, y, 0.0)) for x, y in starts])
    faces = np.arange(len(dashes)).reshape(-1, 4).tolist()
    lines = stage.mesh("lane", dashes, faces, DASH)
    rate = -scenario.start_s / max(stage.frames - 1, 1)
    gone = [-scenario.speed * rate * k for k in range(stage.frames)]
    stage.keys(lines, "location", [(math.fmod(x, DASH_M + GAP_M), 0.0, 0.0) for x in gone])


def _body(
    stage: _Stage,
    camera: bpy.types.Object,
    moving: graphics.BodiesInTime,
    body: graphics.MovingBody,
    places: dict[str, Vector],
) -> None:
    """Add a body, lines from the sensors that see it, its name and its moments."""
    alpha = HIDES_ALPHA if body.seen is None else 1.0
    name = body.actor.name
    middle = body.height
    box = stage.box(name, graphics.UNSEEN)
    box.scale = body.actor.box
    box.display.show_shadows = True
    centers = [Vector((float(x), float(y), middle)) for x, y in body.positions]
    stage.keys(box, "location", centers)
    stage.keys(box, "rotation_euler", [(0.0, 0.0, float(turn)) for turn in body.headings])
    shades = [_linear(graphics.with_alpha(graphics.color_of_ap(ap), alpha)) for ap in body.ap]
    stage.keys(box.data.materials[0], "diffuse_color", shades)
    if body.seen is None:
        return
    eye = camera.matrix_world.translation
    turn = camera.matrix_world.to_euler()
    label = stage.words(name, NEAR_TO, INK, "CENTER")
    above = Vector((0.0, 0.0, middle + 0.3))
    label.rotation_euler = turn
    stage.keys(label, "location", [center + above for center in centers])
    stage.keys(label, "scale", [[(center - eye).length] * 3 for center in centers])
    for sensor, found in body.by_sensor.items():
        if not found.any():
            continue
        ray = stage.box(f"{sensor} {name}", graphics.UNSEEN)
        start = places[sensor]
        ray.rotation_mode = "QUATERNION"
        ways = [center - start for center in centers]
        stage.keys(ray, "location", [start + way / 2.0 for way in ways])
        stage.keys(ray, "rotation_quaternion", [way.to_track_quat("X", "Z") for way in ways])
        thick = [RAY_M if ap > 0.0 else 0.0 for ap in found]
        stage.keys(ray, "scale", [(w.length, t, t) for w, t in zip(ways, thick, strict=True)])
        shades = [_linear(graphics.color_of_ap(ap)) for ap in found]
        stage.keys(ray.data.materials[0], "diffuse_color", shades)
    for row, mark in enumerate(graphics.marks_of(moving.driven.scenario, body.seen)):
        k = min(int(np.searchsorted(moving.times, mark.time_s - 1e-6)), stage.frames - 1)
        post = stage.box(mark.text, mark.color)
        post.scale = (POST_M, POST_M, 2.0 * middle)
        post.location = centers[k]
        words = stage.words(mark.text, NEAR_TO, mark.color, "CENTER")
        away = (centers[k] - eye).length
        words.location = centers[k] + 1.6 * above + Vector((0.0, 0.0, 1.5 * NEAR_TO * away * row))
        words.rotation_euler = turn
        words.scale = [away] * 3


def _strip(
    stage: _Stage, camera: bpy.types.Object, strip: graphics.TimeStrip, times: Floats
) -> None:
    """Add the strip in front of the camera, 1 m away; `times` (K,) are those of its cursor [s]."""
    half = math.tan(camera.data.angle / 2.0)
    aside = 2.0 * camera.data.shift_x
    up = 2.0 * camera.data.shift_y
    rows = len(strip.names)
    low = BASE + 2.6 * ROW
    high = BASE + (2.6 + rows) * ROW
    left = -SIDE + 0.36
    right = SIDE - 0.02
    plate_z = -1.001

    def placed(obj: bpy.types.Object, x: float = 0.0, y: float = 0.0, z: float = -0.999) -> None:
        obj.parent = camera
        obj.location = ((x + aside) * half, (y + up) * half, z)

    def square(name: str, box: Sequence[float], color: graphics.Rgba) -> bpy.types.Object:
        a, b, c, d = (v * half for v in box)
        return stage.mesh(name, [(a, b, 0), (c, b, 0), (c, d, 0), (a, d, 0)], [range(4)], color)

    placed(square("plate", (-SIDE, BASE, SIDE, high + 1.6 * ROW), PLATE), z=plate_z)
    size = np.array([right - left, high - low, 0.0]) * half
    points = np.asarray(strip.cells.faces.points, float) * size
    colors, index = np.unique(strip.cells.faces.colors[::3], axis=0, return_inverse=True)
    for k, color in enumerate(colors.tolist()):
        corners = points.reshape(-1, 3, 3)[index.ravel() == k].reshape(-1, 3)
        faces = np.arange(len(corners)).reshape(-1, 3).tolist()
        placed(stage.mesh("cells", corners, faces, tuple(color)), left, low, -1.0)
    for number, name in enumerate(strip.names):
        words = stage.words(name, LETTER * half, FAINT, "RIGHT")
        placed(words, left - 0.02, high - (number + 0.75) * ROW)
    placed(stage.words(strip.title, 1.2 * LETTER * half, INK), -SIDE + 0.02, high + 0.5 * ROW)
    for k, mark in enumerate(strip.marks):
        x = left + strip.share(mark.time_s) * (right - left)
        line = (-0.002, low - 0.3 * ROW, 0.002, high)
        placed(square("moment", line, mark.color), x)
        align = "RIGHT" if x > right - 0.2 else "CENTER"
        y = low - (1.1 + (k % 2)) * ROW
        placed(stage.words(mark.text, LETTER * half, mark.color, align), x, y)
    cursor = square("cursor", (-0.002, low, 0.002, high), INK)
    cursor.parent = camera
    shares = [strip.share(float(time)) for time in times]
    ways = [((left + s * (right - left) + aside) * half, up * half, -0.998) for s in shares]
    stage.keys(cursor, "location", ways)
