"""The sensor that is being placed by pointing: its pose under the mouse, its picture, its score.

Its state is in this module, not in the scene: the file does not change before it is placed. The
picture is drawn from arrays and lines of text. The engine computes the score on a small sample.
"""

import math
from dataclasses import replace
from itertools import count
from typing import Any

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from .. import document
from ..choices import free_name
from ..engine import catalog, graphics, kinds, pe
from ..overlay.regions import box_edges
from ..panel_text import draw_label
from ..processes import engine_calls, engine_process
from ..processes.engine_calls import Gain
from ..sensor_kinds import mount_for
from ..view import viewport
from . import modes, running_job
from .surface_pose import (
    MAX_STAND_OFF_M,
    Stance,
    SurfaceSpot,
    parts_of,
    pulls_to_middle,
    ray_of,
    spot_beside,
    spot_on_ray,
    vehicle_box,
    vehicle_center,
    view_under,
)

LENGTH_M = 2.0
RING_M = 0.12
ALOFT_M = 100.0
STEM_COLOR = (1.0, 1.0, 1.0, 0.8)
HELD_PALETTE = replace(graphics.VIEWPORT, free=(1.0, 0.93, 0.55, 0.5), other=(1.0, 0.93, 0.55, 0.9))
"""Lighter than sensors that are there."""
POINT_AT = "Point at the vehicle"
LINE_PX = 1.5
OFF = -1
ALONG = 0.5
"""Numbers are typed for the stand-off; of a normal: along this axis the body goes on."""
FARTHEST_M = 100.0
CENTERED_M = 5e-4
TOPIC = "held sensor"
_numbers = count()
"""Of studies that sensors are held in."""


class HeldSensor:
    """One sensor that is held under the mouse, until it is placed or cancelled. Its lines and faces
    are drawn in all 3D views, its text in the view under the mouse."""

    def __init__(
        self,
        context: bpy.types.Context,
        model: Any,
        stance: Stance,
        moved: bpy.types.Object | None = None,
    ) -> None:
        self.model = model
        self.kind = kinds.kind_of(model)
        self.mirrored = False
        self.name = "" if moved is None else moved.name
        self._is_linked = moved is not None and bool(moved.perception_entropy.mirror_of)
        self._own = None if moved is None else moved.matrix_world.to_euler().to_matrix().to_4x4()
        self._axis = OFF
        self._given = dict[int, float]()
        self.mount = mount_for(model)
        self.stance = stance
        self.matrix: Matrix | None = None
        self.text: tuple[str, ...] = ()
        self.lines = self._faces = graphics.Primitives.empty()
        self.score = self._typed = ""
        self._spot: SurfaceSpot | None = None
        self._is_near = False
        self._region = 0
        self._mouse = (0, 0)
        self._handlers = viewport.DrawHandlers()
        self._shape = sensor_shape(self.kind.label, model)
        depsgraph = context.evaluated_depsgraph_get()
        vehicle = context.scene.perception_entropy.vehicle
        self._parts = parts_of(vehicle, depsgraph)
        self._middle = vehicle_center(vehicle)
        self._box = vehicle_box(vehicle)
        self._scored = self._scored_in(context.scene, depsgraph)
        self._workspace = context.workspace.name
        self._handlers.show((self._draw, "POST_VIEW"), (self._draw_text, "POST_PIXEL"))
        self.show_keys()

    def point(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        """Follow the mouse; over anything but a 3D view there is no spot."""
        view = view_under(context, event)
        spot = None
        if view is not None:
            depsgraph = context.evaluated_depsgraph_get()
            spot = spot_on_ray(context.scene, depsgraph, self._parts, *ray_of(view))
            self._region = view.region.as_pointer()
            self._mouse = view.mouse
        self._is_near = False
        if view is not None and spot is not None:
            self._is_near = pulls_to_middle(view, spot.point, viewport.ui_scale())
        self.stance = replace(self.stance, magnet=not event.ctrl)
        self.put(spot)

    def stand(self, stance: Stance) -> None:
        """Change the stance of the sensor at its present spot. One that is moved keeps its own
        angles until it is turned."""
        if replace(stance, stand_off_m=self.stance.stand_off_m) != self.stance:
            self._own = None
        self.stance = stance
        self.put(self._spot)
        self.show_keys()

    def mirror(self) -> None:
        """Have a mirror image placed with the sensor, or no longer."""
        self.mirrored = not self.mirrored
        self.stand(self.stance)

    def type_into(self, axis: int) -> None:
        """Have numbers typed for a coordinate of the sensor; again: for its stand-off."""
        self._axis = OFF if axis == self._axis else axis
        self._typed = ""
        self.show_keys()

    def typed(self, letter: str) -> None:
        """Append a character to the typed number; "" removes the last one."""
        self._typed = self._typed + letter if letter else self._typed[:-1]
        try:
            value = float(self._typed) if self._typed else None
        except ValueError:  # not yet a number, such as a point alone
            self.show_keys()
            return
        stance = self.stance
        if self._axis == OFF:
            value = self.mount.stand_off_m if value is None else value
            stance = replace(stance, stand_off_m=min(max(value, 0.0), MAX_STAND_OFF_M))
        elif value is None:
            self._given.pop(self._axis, None)
        else:
            self._given[self._axis] = min(max(value, -FARTHEST_M), FARTHEST_M)
        self.stand(stance)

    def step(self, by_m: float) -> None:
        """Change the stand-off by a distance [m]."""
        self._axis = OFF
        self._typed = ""
        self.stand(self.stance.changed(by_m))

    @property
    def angles(self) -> tuple[float, float]:
        """Yaw and pitch [deg] of the held sensor; those of its stance without a spot."""
        if self.matrix is None:
            return self.stance.yaw_deg, self.stance.pitch_deg
        _, pitch, yaw = self.matrix.to_euler()
        return round(math.degrees(yaw), 1) + 0.0, round(math.degrees(pitch), 1) + 0.0

    @property
    def typed_text(self) -> str:
        """Return what numbers are typed for as text: a coordinate, or the stand-off."""
        if self._axis != OFF:
            return f"{'XYZ'[self._axis]} {self._typed or '...'} m"
        return f"Stand-off {self._typed or format(self.stance.stand_off_m, 'g')} m"

    def more(self, context: bpy.types.Context) -> None:
        """Hold another sensor of the same model; its score includes the sensor just placed."""
        scene = context.scene
        depsgraph = context.evaluated_depsgraph_get()
        self._scored = self._scored_in(scene, depsgraph)
        self.score = ""
        self._axis = OFF
        self._typed = ""
        self._given.clear()
        self.put(None)

    def show_keys(self) -> None:
        """Show the keys in the status bar."""
        workspace = bpy.data.workspaces.get(self._workspace)
        if workspace is not None:
            workspace.status_text_set(draw_status)

    def end(self) -> None:
        """Remove the picture, the status text and the score."""
        self._handlers.hide()
        engine_process.drop(TOPIC)
        for workspace in bpy.data.workspaces:
            workspace.status_text_set(None)
        viewport.redraw_editors()

    def put(self, spot: SurfaceSpot | None) -> None:
        """Put the sensor on a spot, or nowhere; request its approximate score there."""
        self._spot = spot
        self.matrix = None
        self.lines = self._faces = graphics.Primitives.empty()
        if spot is not None:
            wanted = self._wanted()
            spot = self._moved_to(spot, wanted)
            self.matrix = self.stance.placed(spot, self.mount, self._middle)
            if self._own is not None:
                self.matrix = Matrix.Translation(self.matrix.translation) @ self._own
            for axis, value in wanted.items():
                self.matrix.translation[axis] = value
            pose = document.pose_of_matrix(np.array(self.matrix, dtype=float))
            stem = graphics.Primitives.of([spot.point, pose.position], STEM_COLOR)
            is_two = self.mirrored and not document.in_the_middle(pose)
            poses = [pose, document.mirrored_pose(pose)] if is_two else [pose]
            lines, faces = ([moved_to(shape, at) for at in poses] for shape in self._shape)
            self.lines = graphics.Primitives.joined([*lines, stem])
            self._faces = graphics.Primitives.joined(faces)
            if self._scored is not None:
                given = (*self._scored, pose)
                lane = engine_process.FOLLOWS_MOUSE
                engine_process.ask(
                    TOPIC, engine_calls.gain, given, self._tell, fail=self._tell, lane=lane
                )
        self._write()

    def _wanted(self) -> dict[int, float]:
        """Return the typed coordinates; near the centre line, the magnet's too: not of one of a
        pair, which would meet the other there."""
        is_pulled = self.stance.magnet and not self._is_linked
        return ({1: 0.0} if is_pulled and self._is_near else {}) | self._given

    def _moved_to(self, spot: SurfaceSpot, wanted: dict[int, float]) -> SurfaceSpot:
        """Return the spot with those coordinates that run along the body."""
        along = {axis: v for axis, v in wanted.items() if abs(spot.normal[axis]) < ALONG}
        if not along:
            return spot
        scene = bpy.context.scene
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return spot_beside(scene, depsgraph, self._parts, spot, wanted=along)

    def _tell(self, gain: Gain | Exception) -> None:
        """Show the score that the engine found, or why there is none."""
        if isinstance(gain, Exception) and not isinstance(gain, pe.InputError | MemoryError):
            raise gain
        self.score = str(gain) if isinstance(gain, Gain) else f"no score: {gain}"
        self._write()

    def _write(self) -> None:
        """Set the lines of text to draw."""
        self.text = self.model.name, POINT_AT
        if self._spot is not None:
            stands = "along the normal" if self.stance.along_normal else "upright"
            where = f"{self.stance.stand_off_m:g} m from {self._spot.part}, {stands}"
            if self.stance.is_turned:
                where += ", yaw {:g}°, pitch {:g}°".format(*self.angles)
            self.text = self.model.name, where, self._distances(), self.score
        viewport.redraw_editors()

    def _distances(self) -> str:
        """Return distances from the vehicle's box and the ground; outside of the box negative."""
        (rear, right, _), (front, left, _) = self._box.tolist()
        x, y, z = (0.0, 0.0, 0.0) if self.matrix is None else self.matrix.translation
        beside = f"left {left - y:.3f}" if y > 0.0 else f"right {y - right:.3f}"
        text = f"front {front - x:.3f}, rear {x - rear:.3f}, {beside}, ground {z:.3f} m"
        if abs(y) < CENTERED_M:
            return text.replace(beside, "on the centre line")
        return f"{text}, mirrored" if self.mirrored else text

    def _scored_in(
        self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph
    ) -> tuple[int, pe.Study, str] | None:
        """Return what it is scored in: a number, the study, its name; None, with the error as text,
        if the scene has no study."""
        objects = [obj for obj in document.sensor_objects(scene) if obj.name != self.name]
        sensors = document.possible_sensors(objects, depsgraph)
        name = free_name(self.kind.label, {sensor.name for sensor in sensors})
        try:
            rig = pe.Rig([*sensors, pe.Sensor(name, self.model)])
            return next(_numbers), document.study_of_rig(scene, depsgraph, rig), name
        except (pe.InputError, MemoryError) as error:
            self.score = f"no score: {error}"
            return None

    def _draw(self) -> None:
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("LESS_EQUAL")
        gpu.state.depth_mask_set(False)
        try:
            for name, kind, primitives in (
                ("SMOOTH_COLOR", "TRIS", self._faces),
                ("POLYLINE_SMOOTH_COLOR", "LINES", self.lines),
            ):
                if len(primitives.points):
                    shader = viewport.shader(name)
                    if kind == "LINES":
                        width = LINE_PX * bpy.context.preferences.system.pixel_size
                        shader = viewport.line_shader(name, bpy.context.region, width)
                    arrays = {"pos": primitives.points, "color": primitives.colors}
                    batch_for_shader(shader, kind, arrays).draw(shader)
        finally:
            gpu.state.depth_mask_set(True)
            gpu.state.depth_test_set("NONE")
            gpu.state.blend_set("NONE")

    def _draw_text(self) -> None:
        region = bpy.context.region
        if region is None or region.as_pointer() != self._region:
            return
        modes.draw_at_mouse(self._mouse, self.text)


current: HeldSensor | None = None


def busy() -> bool:
    """Whether a sensor is being placed or a job runs: only one of them may use Esc."""
    return current is not None or running_job.current is not None


def begin(
    context: bpy.types.Context, model: Any, stance: Stance, moved: bpy.types.Object | None = None
) -> None:
    """Start to hold a new sensor under the mouse, or one that is there and is moved."""
    global current
    modes.end()
    current = HeldSensor(context, model, stance, moved)


def end() -> None:
    """Stop holding the sensor; does nothing if there is none."""
    global current
    if current is not None:
        ended = current
        current = None
        ended.end()


def sensor_shape(name: str, model: Any) -> tuple[graphics.Primitives, graphics.Primitives]:
    """Return lines and faces of a sensor in its own frame, computed once for all moves. They are
    computed high above the ground, because lines end at the ground, and moved back down."""
    sensor = pe.Sensor(name, model, pe.Pose((0.0, 0.0, ALOFT_M)))
    drawing = graphics.drawing_of(sensor.kind)
    lines = [
        drawing.lines(sensor, LENGTH_M, HELD_PALETTE),
        graphics.ring_lines(sensor, RING_M, HELD_PALETTE),
    ]
    if (housing := catalog.housing(model.name)) is not None:  # the room that its body takes
        half = np.array(housing.size) / 2.0
        middle = np.array([0.0, 0.0, half[2] + ALOFT_M]) - housing.optical_center
        edges = box_edges(middle - half, middle + half)
        lines.append(graphics.Primitives.of(edges, HELD_PALETTE.other))
    low = np.array([0.0, 0.0, ALOFT_M], np.float32)
    both = graphics.Primitives.joined(lines), drawing.faces(sensor, LENGTH_M, HELD_PALETTE)
    moved = [graphics.Primitives(primitives.points - low, primitives.colors) for primitives in both]
    return moved[0], moved[1]


def moved_to(shape: graphics.Primitives, pose: pe.Pose) -> graphics.Primitives:
    """Return a shape, given in the sensor's frame, at a pose of the sensor."""
    turned = shape.points @ pose.ground_from_sensor.T.astype(np.float32)
    return graphics.Primitives(turned + np.array(pose.position, np.float32), shape.colors)


def draw_status(header: bpy.types.Header, _context: bpy.types.Context) -> None:
    """Draw the keys in the status bar, in place of Blender's own hints."""
    if current is None:
        return
    row = header.layout.row()
    angles = "Yaw {:g}°, Pitch {:g}°".format(*current.angles)
    other = "Upright" if current.stance.along_normal else "Along Normal"
    keys = (
        (("MOUSE_LMB",), "Place"),
        (("EVENT_SHIFT", "MOUSE_LMB"), "Place More"),
        (("EVENT_RETURN",), "   Place"),
        (("EVENT_R",), "On the Roof"),
        (("EVENT_N",), other),
        (("EVENT_M",), "One Side" if current.mirrored else "Both Sides"),
        (("EVENT_CTRL",), "   No Magnet"),
        (("MOUSE_MMB",), f"Wheel, X Y Z, Digits: {current.typed_text}"),
        (("DRIVER_ROTATIONAL_DIFFERENCE",), f"Arrows (Shift: 1°): {angles}"),
        (("EVENT_ESC",), "   Leave"),
    )
    for icons, text in keys:
        pair = row.row(align=True)
        for icon in icons[:-1]:
            pair.label(text="", icon=icon)
        draw_label(pair, text, icons[-1])
    row.separator_spacer()
