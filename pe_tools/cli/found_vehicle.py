"""The vehicle of a mesh file as a first study has it: axes, unit and glass are found."""

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, one_of
from pe_core.base.files import quoted, require_new
from pe_core.scene import Vehicle, vehicle_line
from pe_core.scene.mesh import BodyShape, fitting_units, require_vehicle_size
from pe_core.scene.vehicle_description import is_called

from ..formats import Mesh, MeshAxes, axes_in_text, read_mesh
from ..sweep import read_changes
from .terminal import one_line, show, tell

GLASS = ("glass", "window", "windshield", "windscreen")
NO_GLASS = ("frame", "trim", "seal", "wiper", "rubber", "washer")
"""Beginnings of words in the names of parts: glass, and parts of windows that are none."""
SCALE = "vehicle.scale"
OF_MESH = ("vehicle.up", "vehicle.forward", SCALE)
"""Keys that ``--set`` has for what is not found in a mesh, or is found wrong."""


def asked_keys(args: argparse.Namespace, known: Sequence[str]) -> dict[str, Any]:
    """Return the values of ``--set`` by key; `InputError` for a key that is not known here."""
    values = {".".join(change.path): change.value for change in read_changes(args.set)}
    for key in values:
        if key not in known:
            expected = f"{one_of(known, key)}; `pe set` changes other keys"
            raise InputError("command line", "--set", expected, quoted(key))
    return values


@dataclass(frozen=True)
class FoundVehicle:
    """The vehicle of a mesh file: the file relative to the study's folder; how the axes of the mesh
    were determined, as `Mesh.axes` has it; metres in a unit of it, and the name of a unit that was
    found (empty for metres)."""

    mesh: str
    vehicle: Vehicle
    faces: str
    scale: float
    unit: str

    @property
    def axes(self) -> MeshAxes:
        """The keys of the mesh file's axes in the study."""
        if not self.faces:
            return MeshAxes(scale=self.scale)
        found = axes_in_text(self.faces)
        return MeshAxes(found.up, found.forward, self.scale)


def find_vehicle(args: argparse.Namespace, asked: Mapping[str, Any]) -> FoundVehicle:
    """Read the vehicle of a mesh file and print what was found; `asked` has keys of [vehicle].
    `InputError` where the study to write is there already."""
    path = Path(args.file)
    up, forward, scale = (asked.get(key) for key in OF_MESH)
    mesh, scale, unit = read_in_metres(path, up, forward, scale)
    glass = tuple(name for name in mesh.part_names if is_called(name, GLASS, NO_GLASS))
    vehicle = Vehicle(mesh.triangles, mesh.parts, mesh.part_names, glass)
    require_new(Path(args.output), replace=args.replace)  # all inputs are read
    line = f"{path}: {vehicle_line(vehicle, mesh.axes, mesh.notes)}"
    show(f"{one_line(line)}\n", sys.stderr)
    # Folders that are links are followed first: `..` of a link is the folder that it leads to.
    full = path.parent.resolve() / path.name
    with suppress(ValueError):  # on another drive
        full = Path(os.path.relpath(full, Path(args.output).parent.resolve()))
    return FoundVehicle(full.as_posix(), vehicle, mesh.axes, scale, unit=unit)


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
        more = "".join(f"; {SCALE}={each:g} if these are {name}" for name, each in others)
        tell(f"{path}: no vehicle in metres; taken as {unit}, scale {factor:g}{more}")
        return replace(mesh, triangles=mesh.triangles * factor), factor, unit
    return mesh, 1.0 if scale is None else scale, ""
