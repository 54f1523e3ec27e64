"""`pe new`: a first study of a vehicle's mesh, with comments and a sensor on the roof."""

import argparse
import math
import os
import shlex
import sys
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from pe_core import catalog
from pe_core.base.errors import InputError
from pe_core.base.files import require_new, write_bytes
from pe_core.base.table_reader import dumps
from pe_core.scene import Pose, Rig, Sensor, Vehicle, vehicle_line
from pe_core.scene.mesh import AXIS_NAMES, BodyShape, fitting_units, require_vehicle_size
from pe_core.scene.vehicle_description import is_called
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_core.study import Study

from ..advice import warnings
from ..formats import Mesh, MeshAxes, axes_in_text, read_mesh, write_mesh
from .roof import MOUNT, RoofSensor, find_roof, roof_sensor
from .terminal import DONE, Answer, one_line, show, tell

MODEL = "Pandar64"
GLASS = ("glass", "window", "windshield", "windscreen")
NO_GLASS = ("frame", "trim", "seal", "wiper", "rubber", "washer")
"""Beginnings of words in the names of parts: glass, and parts of windows that are none."""
TEMPLATE = Path(__file__).with_name("first_study.toml.j2")
CAMERA, CAMERA_ABOVE_M = "Camera 60 deg", 0.1
"""Model of the camera that is proposed as a comment, and its height above the roof."""
PITCH_DEG = (-10.0, 10.0)
MAX_HEIGHT_STEP_M = 0.05
COLUMN = 30  # Column of the comments
LONG = 50  # A line with more characters has its comment above it


def add_new_verb(verbs: Any) -> None:
    """Add ``new``: the study of a mesh to begin with."""
    parser = verbs.add_parser("new", help="write a first study of a vehicle's mesh, with comments")
    parser.add_argument("file", metavar="MESH", help="mesh: .glb, .obj, .stl, .ply, .npz, ...")
    parser.add_argument("-o", "--output", required=True, metavar="STUDY", help="study to write")
    about = f"model of the sensor on the roof (default: {MODEL}; pe sensors lists them)"
    parser.add_argument("--sensor", default=MODEL, metavar="MODEL", help=about)
    for key in ("forward", "up"):
        about = f"the file's axis that points {key}, if it is not found: --{key}=-x"
        parser.add_argument(f"--{key}", choices=AXIS_NAMES, metavar="AXIS", help=about)
    about = "metres in a unit of the file, if it is not found: 0.0254 for inches"
    parser.add_argument("--scale", type=float, metavar="M", help=about)
    parser.add_argument("--replace", action="store_true", help="replace files that are there")
    parser.set_defaults(function=new_study)


def new_study(args: argparse.Namespace) -> Answer:
    """Write the study of a mesh, and tell what was found in the mesh."""
    mesh_path, output = Path(args.file), Path(args.output)
    area_path = output.parent / f"{output.stem}_roof.npz"
    model = catalog.load(args.sensor)
    mesh, scale, unit = read_in_metres(mesh_path, args.up, args.forward, args.scale)
    require_new(output, replace=args.replace)
    glass = tuple(name for name in mesh.part_names if is_called(name, GLASS, NO_GLASS))
    vehicle = Vehicle(mesh.triangles, mesh.parts, mesh.part_names, glass)
    show(
        f"{one_line(f'{mesh_path}: {vehicle_line(vehicle, mesh.axes, mesh.notes)}')}\n", sys.stderr
    )
    start = Sensor(MOUNT, model, Pose.from_degrees((0, 0, 0), (0, 0, 0)))
    roof = roof_sensor(vehicle, start, catalog.housing(args.sensor), area_path.name)
    # Folders that are links are followed first: `..` of a link is the folder that it leads to.
    full = mesh_path.parent.resolve() / mesh_path.name
    with suppress(ValueError):  # on another drive
        full = Path(os.path.relpath(full, output.parent.resolve()))
    first = FirstStudy(full.as_posix(), output.name, vehicle, mesh.axes, scale, unit, roof)
    written = [output]
    if roof.mount is not None and roof.mount.area is not None:  # no part of the vehicle
        require_new(area_path, replace=args.replace)
        faces = roof.mount.area.triangles
        write_mesh(area_path, Mesh(faces, np.zeros(len(faces), np.int32), (MOUNT,)))
        written.append(area_path)
    write_bytes(output, study_text(first).encode())
    study, file = first.study(), shlex.quote(str(output))
    for each in warnings((), study.vehicle, study.space, study.prior):
        tell(f"warning: {each.line}")  # sunk into the ground, far from the origin, odd sizes
    lines = [f"wrote {path}" for path in written]
    lines += [f"next: pe score {file}", f"      pe optimize {file} -o results"]
    return "\n".join(lines), DONE


def read_in_metres(
    path: Path, up: str | None, forward: str | None, scale: float | None
) -> tuple[Mesh, float, str]:
    """Read a mesh; without a scale find the unit in which it has the size of a vehicle. Return the
    mesh, metres in a unit of the file, and the name of the unit: empty for metres and for a scale
    that was asked for. `InputError` when the file cannot be read, or has a vehicle's size in no
    unit."""
    mesh = read_mesh(path, MeshAxes(up, forward, 1.0 if scale is None else scale))
    try:
        require_vehicle_size(str(path), mesh)
    except InputError:
        third, second, longest = sorted(BodyShape(mesh.triangles, mesh.parts, mesh.part_names).size)
        is_found = scale is None and longest > 0.0
        units = fitting_units(longest, second, third) if is_found else []
        if not units:
            raise
        (unit, factor), *others = units
        more = "".join(f"; --scale {each:g} if these are {name}" for name, each in others)
        tell(f"{path}: no vehicle in metres; taken as {unit}, scale {factor:g}{more}")
        return replace(mesh, triangles=mesh.triangles * factor), factor, unit
    return mesh, 1.0 if scale is None else scale, ""


@dataclass(frozen=True)
class FirstStudy:
    """What a first study is written from. The mesh file, relative to the study's folder, and the
    study's own; how the axes of the mesh were determined, as `Mesh.axes` has it; metres in a unit
    of it, and the name of a unit that was found (empty for metres)."""

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
