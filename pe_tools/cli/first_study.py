"""The text of a first study: TOML with a comment on each key that a newcomer changes."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from pe_core.base.serialization import dumps
from pe_core.scene import Rig, Vehicle, vehicle_line
from pe_core.scene.mesh import MeshAxes
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_core.search import SurfaceMount
from pe_core.study import Study

from ..formats import axes_in_text
from .roof import MOUNT, RoofSensor, find_roof

CAMERA, CAMERA_ABOVE_M = "Camera 60 deg", 0.1
"""Model of the camera that is proposed as a comment, and its height above the roof."""
PITCH_DEG = (-10.0, 10.0)
MAX_HEIGHT_STEP_M = 0.05
COLUMN = 30
"""Column of the comments."""
LONG = 50
"""A line with more characters has its comment above it."""


@dataclass(frozen=True)
class FirstStudy:
    """What a first study is written from.

    The mesh file, relative to the study's folder, and the study's own; how the axes of the mesh
    were determined, as `Mesh.axes` has it; metres in a unit of it, and the name of a unit that was
    found (empty for metres).
    """

    mesh: str
    file: str
    vehicle: Vehicle
    faces: str
    scale: float
    unit: str
    roof: RoofSensor

    @property
    def axes(self) -> MeshAxes:
        """The keys of the mesh file's axes in the study."""
        if not self.faces:
            return MeshAxes(scale=self.scale)
        found = axes_in_text(self.faces)
        return MeshAxes(found.up, found.forward, self.scale)

    def study(self) -> Study:
        """Return the study that the text is read as."""
        name = self.roof.sensor.name
        search = self.roof.search()
        limits = {name: {"pitch": (math.radians(PITCH_DEG[0]), math.radians(PITCH_DEG[1]))}}
        return Study(
            Rig([self.roof.sensor]),
            self.vehicle,
            search=replace(search, limits=limits),
            samples=FIRST_SAMPLES,
            mesh=self.mesh,
            axes=self.axes,
        )


def study_text(first: FirstStudy) -> str:
    """Return the study file's text: keys with comments, in the order a newcomer asks."""
    sections = (_head, _space, _vehicle, _sensor, _camera, _search, _mount)
    texts = ("\n".join(section(first)) for section in sections)
    return "\n\n".join(text for text in texts if text) + "\n"


def _row(key: str, value: Any, comment: str = "", *, off: bool = False) -> str:
    """Return a line `key = value  # comment`; with `off` the line is a comment itself."""
    return _line(f"{'# ' if off else ''}{dumps({key: value}).strip()}", comment)


def _line(text: str, comment: str) -> str:
    """Return a line with its comment behind it; above it, if the line is long."""
    if len(text) > LONG:
        return f"# {comment}\n{text}" if comment else text
    return f"{text:{COLUMN - 2}}  # {comment}" if comment else text


def _inline(table: Mapping[str, Any]) -> str:
    """Return an inline table."""
    rows = (dumps({key: value}).strip() for key, value in table.items())
    return f"{{ {', '.join(rows)} }}"


def _head(first: FirstStudy) -> Iterator[str]:
    file = _safe(shlex.quote(first.file))
    yield "# A study: a vehicle, its sensors, and how to search for a better placement."
    yield f"#   pe score {file}                  how good the placement is"
    yield f"#   pe optimize {file} -o results    look for a better one"
    yield "# Lengths in metres, angles in degrees; x forward, y left, z up; the origin is on the"
    yield "# ground under the vehicle. Keys that are left out have their defaults: docs/study.md"
    yield ""
    yield _row("samples", FIRST_SAMPLES, "voxels that a score evaluates; 0: all, exact and slower")


def _space(first: FirstStudy) -> Iterator[str]:
    space = Study(Rig([first.roof.sensor])).space
    yield _line("[space]", "where objects are expected, divided into voxels")
    yield _row("x", list(space.x), "behind and ahead")
    yield _row("y", list(space.y), "right and left")
    yield _row("z", list(space.z))
    yield ""
    yield "[prior]"
    yield _row("model", "road", 'how objects are distributed: or "highway", "uniform"')


def _vehicle(first: FirstStudy) -> Iterator[str]:
    yield _line("[vehicle]", _safe(vehicle_line(first.vehicle, first.faces)))
    yield _row("mesh", first.mesh, "relative to this file")
    yield from _axes(first)
    glass = list(first.vehicle.glass)
    yield _row("glass", glass, "parts that cameras see through", off=not glass)


def _safe(text: str) -> str:
    """Return a text that a TOML comment may hold."""
    return "".join(c if c.isprintable() else "?" for c in text)


def _axes(first: FirstStudy) -> Iterator[str]:
    axes, found = first.axes, axes_in_text(first.faces)
    if axes.up is not None and axes.forward is not None:
        yield _row("up", axes.up, f"the file's axis that points up ({found.up_by})")
        back = axes.forward.translate(str.maketrans("+-", "-+"))
        comment = f'the axis to the front ({found.forward_by}); "{back}" turns the vehicle round'
        yield _row("forward", axes.forward, comment)
    comment = f"the file is in {first.unit}" if first.unit else "metres in a unit of the file"
    yield _row("scale", axes.scale, comment, off=axes.scale == 1.0)


def _sensor(first: FirstStudy) -> Iterator[str]:
    sensor, is_mounted = first.roof.sensor, first.roof.mount is not None
    yield _line("[[sensor]]", "one or more")
    yield _row("name", sensor.name)
    yield _row("model", sensor.model.name, "pe sensors lists the models")
    yield _row("position", list(sensor.pose.position), "of its optical centre")
    yield _row("rotation", list(sensor.pose.rotation_deg), "roll, pitch, yaw; + pitch: nose down")
    if is_mounted:
        yield _row("mount", MOUNT, "the search moves it on this mount, see below")
    free = list(first.study().search.free[sensor.name])
    more = "besides its position on the mount" if is_mounted else "of x, y, z, roll, pitch, yaw"
    yield _row("free", free, f"what the search changes, {more}")
    yield f"bounds = {_inline({'pitch': list(PITCH_DEG)})}"


def _camera(first: FirstStudy) -> Iterator[str]:
    roof = find_roof(first.vehicle)
    position = [round(roof.front, 2), 0.0, round(roof.level + CAMERA_ABOVE_M, 2)]
    yield '# One more sensor: remove the "# " of these lines.'
    yield "# [[sensor]]"
    yield _row("name", "front camera", off=True)
    yield _row("model", CAMERA, off=True)
    yield _row("position", position, off=True)
    yield _row("free", ["x", "z", "pitch"], off=True)


def _search(first: FirstStudy) -> Iterator[str]:
    search, top = first.study().search, first.roof.sensor.pose.position[2] + 0.1
    yield _line("[optimize]", "how pe optimize searches")
    yield _row("samples", search.samples, "voxels that a candidate is evaluated on")
    yield _row("evaluations", 0, "placements to evaluate; 0: as many as the method takes")
    yield _row("seed", search.seed, "the same seed finds the same placement")
    highest = round(math.ceil(top / MAX_HEIGHT_STEP_M) * MAX_HEIGHT_STEP_M, 2)
    yield _row("max_height", highest, "no housing's top is above this", off=True)
    yield _row("min_distance", 0.3, "between two sensors", off=True)


def _mount(first: FirstStudy) -> Iterator[str]:
    mount = first.roof.mount
    if not isinstance(mount, SurfaceMount):
        return
    yield _line("[[optimize.mount]]", "a surface that sensors may be moved on")
    yield _row("name", MOUNT)
    if mount.area is None:
        yield _row("parts", list(mount.parts), "parts of the mesh; pe score names them all")
    else:
        yield _row("area", mount.area.file, "faces of the roof, written by pe new")
    yield _row("standoff", mount.standoff, "height of the bracket under the housing")
    yield _row("orientation", mount.orientation, 'or "normal": level with the surface')
