"""The text of a first study: TOML with a comment on each key that a newcomer changes."""

from __future__ import annotations

import math
import shlex
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pe_core.base.serialization import dumps
from pe_core.scene import Rig, Vehicle, vehicle_line
from pe_core.scene.mesh import MeshAxes
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_core.study import Study

from ..formats import axes_in_text
from .roof import MOUNT, RoofSensor, find_roof

TEMPLATE = Path(__file__).with_name("first_study.toml.j2")
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
    from jinja2 import Environment, StrictUndefined  # other verbs start without it

    study, sensor, roof = first.study(), first.roof.sensor, find_roof(first.vehicle)
    axes, top = study.axes, sensor.pose.position[2] + 0.1
    named = axes.up is not None and axes.forward is not None
    environment = Environment(trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined)
    text: str = environment.from_string(TEMPLATE.read_text("utf-8")).render(
        row=_row,
        line=_line,
        study=study,
        file=_printable(shlex.quote(first.file)),
        space=Study(Rig([sensor])).space,
        vehicle=_printable(vehicle_line(first.vehicle, first.faces)),
        found=axes_in_text(first.faces) if named else None,
        back=(axes.forward or "").translate(str.maketrans("+-", "-+")),
        unit=first.unit,
        glass=list(first.vehicle.glass),
        sensor=sensor,
        mount=first.roof.mount,
        mount_name=MOUNT,
        free=list(study.search.free[sensor.name]),
        pitch=list(PITCH_DEG),
        camera=CAMERA,
        camera_position=[round(roof.front, 2), 0.0, round(roof.level + CAMERA_ABOVE_M, 2)],
        highest=round(math.ceil(top / MAX_HEIGHT_STEP_M) * MAX_HEIGHT_STEP_M, 2),
    )
    return f"{text.rstrip()}\n"


def _row(key: str, value: Any, comment: str = "", *, off: bool = False) -> str:
    """Return a line `key = value  # comment`; with `off` the line is a comment itself."""
    return _line(f"{'# ' if off else ''}{dumps({key: value}).strip()}", comment)


def _line(text: str, comment: str) -> str:
    """Return a line with its comment behind it; above it, if the line is long."""
    if len(text) > LONG:
        return f"# {comment}\n{text}" if comment else text
    return f"{text:{COLUMN - 2}}  # {comment}" if comment else text


def _printable(text: str) -> str:
    """Return a text that a TOML comment may hold."""
    return "".join(c if c.isprintable() else "?" for c in text)
