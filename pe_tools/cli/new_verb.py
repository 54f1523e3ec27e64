"""`pe new`: a first study of a vehicle's mesh, with comments and a sensor on the roof."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pe_core import catalog
from pe_core.base.errors import InputError
from pe_core.base.files import require_new, write_bytes
from pe_core.scene import Pose, Sensor, Vehicle, vehicle_line
from pe_core.scene.body_shape import BodyShape, fitting_units, require_vehicle_size
from pe_core.scene.mesh import AXIS_NAMES
from pe_core.scene.orientation import is_called

from ..advice import warnings
from ..formats import Mesh, MeshAxes, read_mesh, write_mesh
from .first_study import FirstStudy, study_text
from .roof import MOUNT, roof_sensor
from .terminal import DONE, Answer, one_line, show, tell

MODEL = "Pandar64"
GLASS = ("glass", "window", "windshield", "windscreen")
NO_GLASS = ("frame", "trim", "seal", "wiper", "rubber", "washer")
"""Beginnings of words in the names of parts: glass, and parts of windows that are none."""


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
    require_new(output, replace=args.replace, inputs=[mesh_path])
    area_path = output.parent / f"{output.stem}_roof.npz"
    model = catalog.load(args.sensor)
    mesh, scale, unit = read_in_metres(mesh_path, args.up, args.forward, args.scale)
    glass = tuple(name for name in mesh.part_names if is_called(name, GLASS, NO_GLASS))
    vehicle = Vehicle(mesh.triangles, mesh.parts, mesh.part_names, glass)
    show(f"{one_line(f'{mesh_path}: {vehicle_line(vehicle, mesh.axes)}')}\n", sys.stderr)
    start = Sensor(MOUNT, model, Pose.from_degrees((0, 0, 0), (0, 0, 0)))
    roof = roof_sensor(vehicle, start, catalog.housing(args.sensor), area_path.name)
    found = (output.name, vehicle, mesh.axes, scale, unit, roof)
    first = FirstStudy(_relative(mesh_path, output.parent), *found)
    written = [output]
    if roof.mount is not None and roof.mount.area is not None:  # no part of the vehicle
        require_new(area_path, replace=args.replace, inputs=[mesh_path])
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


def _relative(mesh: Path, folder: Path) -> str:
    """Return the path of a mesh from the study's folder; the full path from another drive.

    Folders that are links are followed first: `..` of a link is the folder that it leads to.
    """
    full = mesh.parent.resolve() / mesh.name
    try:
        return Path(os.path.relpath(full, folder.resolve())).as_posix()
    except ValueError:
        return full.as_posix()


def read_in_metres(
    path: Path, up: str | None, forward: str | None, scale: float | None
) -> tuple[Mesh, float, str]:
    """Read a mesh; without a scale find the unit in which it has the size of a vehicle.

    Return the mesh, metres in a unit of the file, and the name of the unit: empty for metres and
    for a scale that was asked for. `InputError` when the file cannot be read, or has a vehicle's
    size in no unit.
    """
    mesh = read_mesh(path, MeshAxes(up, forward, 1.0 if scale is None else scale))
    try:
        require_vehicle_size(str(path), mesh)
    except InputError:
        sides = sorted(BodyShape(mesh.triangles, mesh.parts, mesh.part_names).size)
        units = fitting_units(sides[2], sides[1]) if scale is None and sides[2] > 0.0 else []
        if not units:
            raise
        (unit, factor), *others = units
        more = "".join(f"; --scale {each:g} if these are {name}" for name, each in others)
        tell(f"{path}: no vehicle in metres; taken as {unit}, scale {factor:g}{more}")
        return replace(mesh, triangles=mesh.triangles * factor), factor, unit
    return mesh, 1.0 if scale is None else scale, ""
