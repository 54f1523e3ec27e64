"""Rigs back in: files of another program as sensors of ours."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from .. import catalog
from ..errors import InputError, shown
from ..scene.geometry import Pose
from ..scene.reference import Reference
from ..scene.sensors import Rig, Sensor, SensorModel
from ..text.memory import told_if_too_much
from ..text.values import A_NAME
from .carried import (
    CAMERA,
    LIDAR,
    CarriedSensor,
    camera_of,
    lidar_of,
    named_apart,
    picture_of,
)
from .frames import composed, origin_in_ground, shifted
from .limits import MAX_SENSORS, require_at_most
from .pictures import KeptPicture, alike
from .table import RigFormat, rig_format, told_format

STAND_INS = {LIDAR: "Velodyne VLP-16 Puck", CAMERA: "nuScenes front"}
"""Models that stand in for those a file does not tell, until somebody chooses."""
NO_WORD = re.compile("[^a-z0-9]+")
CHOOSE = "choose its model"
SEE_NOTHING = {"gnss", "gps", "imu", "ins"}
"""Words in the names of what rigs have besides sensors that see."""
LENS_WORDS = ("cam", "fisheye", "rgb", "image")
"""What the name of a camera has in it, where the file says no kind."""


@dataclass(frozen=True, slots=True)
class ImportedRig:
    """A rig that was read, and what has to be told of it.

    Attributes
    ----------
    rig : Rig
    to_choose : tuple of str
        Names of sensors whose model the file did not tell: another one stands in.
    lines : tuple of str
        What to know of single sensors.
    """

    rig: Rig
    to_choose: tuple[str, ...]
    lines: tuple[str, ...]


def import_rig(
    path: str | Path,
    name: str | None = None,
    reference: Reference | None = None,
    models: Mapping[str, str] | None = None,
    placed: Pose | None = None,
) -> ImportedRig:
    """Read a rig of another program.

    Parameters
    ----------
    path : str or Path
        File or folder.
    name : str, optional
        Of the format; told from the file's name by default.
    reference : Reference, optional
        Where the rear axle is, for formats whose origin is there.
    models : mapping of sensor name to catalogue name, optional
        Models that the file does not tell.
    placed : Pose, optional
        Where the file's origin is, for a file that has no vehicle in it.

    Raises
    ------
    InputError
        When the file is wrong, needs the rear axle, or a chosen model is none.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(path, "file", "an existing file or folder", "nothing of that name")
    row = told_format(path) if name is None else rig_format(name)
    origin = origin_in_ground(row.origin, reference, row.title, path)
    with _in_file(path), told_if_too_much(path):
        return _imported(path, row, _placing(origin, placed), models or {})


@contextmanager
def _in_file(path: Path) -> Iterator[None]:
    """Have what is wrong with a lens, a pose or a model of a file said of the file."""
    try:
        yield
    except InputError as error:
        if Path(error.source).is_relative_to(path if path.is_dir() else path.parent):
            raise
        field = f"{error.source}: {error.field}"
        raise InputError(path, field, error.expected, error.found) from None


def _imported(
    path: Path,
    row: RigFormat,
    place: Callable[[Pose], Pose],
    models: Mapping[str, str],
) -> ImportedRig:
    read = row.read(path)
    require_at_most(path, "sensors", len(read), MAX_SENSORS, "sensors")
    for number, each in enumerate(read, 1):
        A_NAME.checked(path, f"name of sensor {number}", each.name)
    found = [each for each in read if not _sees_nothing(each)]
    blind = [f"{s.name}: no sensor that sees; left out" for s in read if _sees_nothing(s)]
    if not found:
        raise InputError(path, "sensors", "some that see", "; ".join(blind) or "none")
    names = named_apart([each.name for each in found])
    unknown = next((key for key in models if key not in names), None)
    if unknown is not None:
        raise InputError(path, f"model of {unknown}", f"one of {', '.join(names)}", "no sensor")
    called = [each.called(n) for each, n in zip(found, names, strict=True)]
    done = [_sensor(each, models.get(each.name), row, place) for each in called]
    noted = [f"{each.name}: {each.told}" for each in called if each.told]
    lines = (*blind, *noted, *(line for _, line in done if line))
    to_choose = tuple(sensor.name for sensor, line in done if line.endswith(CHOOSE))
    return ImportedRig(Rig([sensor for sensor, _ in done]), to_choose, lines)


def _placing(origin: tuple[float, ...], placed: Pose | None) -> Callable[[Pose], Pose]:
    if placed is None:
        return lambda pose: shifted(pose, origin)
    return lambda pose: shifted(composed(placed, pose), origin)


def _sensor(
    each: CarriedSensor, chosen: str | None, row: RigFormat, place: Callable[[Pose], Pose]
) -> tuple[Sensor, str]:
    """Return a sensor with its model, and a line about it where there is something to tell."""
    each = replace(each, kind=each.kind or (CAMERA if _sounds_like_a_camera(each.name) else LIDAR))
    model, line = _model(each, chosen, row.keeps)
    if not line.endswith(CHOOSE):
        each = row.settled(replace(each, model=model.name))
    return Sensor(each.name, model, place(each.pose), each.fusion), line


def _sees_nothing(each: CarriedSensor) -> bool:
    words = set(NO_WORD.sub(" ", each.name.lower()).split())
    return each.model is None and each.picture is None and bool(words & SEE_NOTHING)


def _sounds_like_a_camera(name: str) -> bool:
    return any(word in name.lower() for word in LENS_WORDS)


def _model(each: CarriedSensor, chosen: str | None, kept: KeptPicture) -> tuple[SensorModel, str]:
    if chosen is not None:
        return catalog.load(chosen), ""
    if (known := _known(each)) is not None:
        return _known_or_own(each, catalog.load(known), kept)
    if each.kind == CAMERA and each.picture is not None:
        return camera_of(each.name, each.picture)
    if each.kind == LIDAR and each.scan is not None:
        return lidar_of(each.name, each.scan), ""
    stand_in = STAND_INS.get(each.kind or "", STAND_INS[LIDAR])
    called = f"no {shown(each.model)} in the catalogue" if each.model else "no model in the file"
    return catalog.load(stand_in), f"{each.name}: {called}; {stand_in} stands in: {CHOOSE}"


def _known(each: CarriedSensor) -> str | None:
    """Return the catalogue's name for what the file calls the model, or None."""
    wanted = NO_WORD.sub("", (each.model or "").lower())
    names = {NO_WORD.sub("", name.lower()): name for name in catalog.names(each.kind)}
    return names.get(wanted) if wanted else None


def _known_or_own(
    each: CarriedSensor, model: SensorModel, kept: KeptPicture
) -> tuple[SensorModel, str]:
    """Return the catalogue's model, or the file's own lens where that is another one."""
    picture = picture_of(model)
    if picture is None or each.picture is None or alike(kept(picture), each.picture):
        return model, ""
    own, line = camera_of(each.name, each.picture)
    told = f"{each.name}: its lens is not that of {model.name} in the catalogue, but the file's"
    return own, line or told
