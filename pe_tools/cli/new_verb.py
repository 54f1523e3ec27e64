"""`pe new`: a first study of a vehicle's mesh, with comments and a sensor on the roof."""

import argparse
import math
import shlex
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from pe_core import catalog
from pe_core.base.files import require_new, write_bytes
from pe_core.base.table_reader import dumps
from pe_core.scene import Pose, Rig, Sensor, vehicle_line
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_core.study import Study

from ..advice import warnings
from ..formats import Mesh, axes_in_text, write_mesh
from ..templating import Templates
from .answers import FilesAnswer
from .found_vehicle import OF_MESH, FoundVehicle, asked_keys, find_vehicle
from .known_rigs import new_of_rig
from .roof import MOUNT, RoofSensor, find_roof, roof_sensor
from .study_source import StudyFiles
from .terminal import DONE, Answer, answered, tell

MODEL = "Pandar64"
TEMPLATE = Path(__file__).with_name("first_study.toml.j2")
CAMERA = "Camera 60 deg"
CAMERA_ABOVE_M = 0.1
"""Model of the camera that is proposed as a comment, and its height above the roof."""
OF_MODEL = f"sensor.{MOUNT}.model"
"""Key of the sensor's model for ``--set``."""
PITCH_DEG = (-10.0, 10.0)
MAX_HEIGHT_STEP_M = 0.05
COLUMN = 30  # Column of the comments
LONG = 50  # A line with more characters has its comment above it


def new(_: StudyFiles, args: argparse.Namespace) -> Answer:
    """Write the first study of a mesh, with one sensor on the roof or with a known rig; list known
    rigs, or describe one."""
    if args.rig is not None:
        return new_of_rig(args)
    if args.file is None or args.output is None:
        args.usage_error("expected MESH and -o STUDY; or --rig, which lists known rigs")
    return new_of_mesh(args)


def new_of_mesh(args: argparse.Namespace) -> Answer:
    """Write the study of a mesh, and tell what was found in the mesh."""
    asked = asked_keys(args, (*OF_MESH, OF_MODEL))
    name = asked.get(OF_MODEL, MODEL)
    output = Path(args.output)
    area_path = output.parent / f"{output.stem}_roof.npz"
    model = catalog.load(name)
    found = find_vehicle(args, asked)
    start = Sensor(MOUNT, model, Pose.from_degrees((0, 0, 0), (0, 0, 0)))
    roof = roof_sensor(found.vehicle, start, catalog.housing(name), area_path.name)
    first = FirstStudy(output.name, found, roof)
    written = [output]
    if roof.mount is not None and roof.mount.area is not None:  # no part of the vehicle
        require_new(area_path, replace=args.replace)
        faces = roof.mount.area.triangles
        write_mesh(area_path, Mesh(faces, np.zeros(len(faces), np.int32), (MOUNT,)))
        written.append(area_path)
    write_bytes(output, study_text(first).encode())
    study = first.study()
    file = shlex.quote(str(output))
    for each in warnings((), study.vehicle, study.space, study.prior):
        tell(f"warning: {each.line}")  # sunk into the ground, far from the origin, odd sizes
    lines = [f"wrote {path}" for path in written]
    lines += [f"next: pe score {file}", f"      pe optimize {file} -o results"]
    return answered(args, FilesAnswer(written=tuple(map(str, written))), lines), DONE


@dataclass(frozen=True)
class FirstStudy:
    """What a first study is written from: the study's own file, the vehicle, its roof."""

    file: str
    found: FoundVehicle
    roof: RoofSensor

    def study(self) -> Study:
        """Return the study that the text is read as."""
        name = self.roof.sensor.name
        search = self.roof.search()
        limits = {name: {"pitch": (math.radians(PITCH_DEG[0]), math.radians(PITCH_DEG[1]))}}
        return Study(
            Rig([self.roof.sensor]),
            self.found.vehicle,
            search=replace(search, limits=limits),
            samples=FIRST_SAMPLES,
            mesh=self.found.mesh,
            axes=self.found.axes,
        )


def study_text(first: FirstStudy) -> str:
    """Return the study file's text: keys with comments, in the order a newcomer asks."""
    study = first.study()
    sensor = first.roof.sensor
    roof = find_roof(first.found.vehicle)
    axes = study.axes
    top = sensor.pose.position[2] + 0.1
    named = axes.up is not None and axes.forward is not None
    text = Templates(TEMPLATE.parent, is_html=False).render(
        TEMPLATE.name,
        row=_row,
        line=_line,
        study=study,
        file=_printable(shlex.quote(first.file)),
        space=Study(Rig([sensor])).space,
        vehicle=_printable(vehicle_line(first.found.vehicle, first.found.faces)),
        found=axes_in_text(first.found.faces) if named else None,
        back=(axes.forward or "").translate(str.maketrans("+-", "-+")),
        unit=first.found.unit,
        glass=list(first.found.vehicle.glass),
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
