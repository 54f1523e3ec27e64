"""Rigs back in: files of another program as sensors of ours."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
    merged_lines,
    named_apart,
    picture_of,
    with_ranges,
)
from .frames import composed, origin_in_ground, shifted
from .limits import MAX_SENSORS, require_at_most
from .other_kinds import NO_WORD, listed_kinds, parted
from .passthrough import Passthrough, SourceSensor, model_text
from .pictures import alike
from .table import RigFormat, rig_format, told_format

STAND_INS = {LIDAR: "Velodyne VLP-16 Puck", CAMERA: "nuScenes front"}
"""Models that stand in for those a file does not tell, until somebody chooses."""
CHOOSE = "choose its model"
Modelled = tuple[CarriedSensor, SensorModel, str]
"""A sensor, its model, and what there is to know of that."""
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
        What to know of single sensors, and which were left out.
    passthrough : Passthrough or None
        What the file has besides, for an export in the same format; None where that is nothing.
    """

    rig: Rig
    to_choose: tuple[str, ...]
    lines: tuple[str, ...]
    passthrough: Passthrough | None = None


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
        return _imported(path, row, _FileOrigin(origin, placed), models or {})


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


@dataclass(frozen=True, slots=True)
class _FileOrigin:
    """Where a format's origin is in the ground frame, and where the file's own was put."""

    origin: tuple[float, ...]
    placed: Pose | None

    def __call__(self, pose: Pose) -> Pose:
        return shifted(pose if self.placed is None else composed(self.placed, pose), self.origin)


def _imported(
    path: Path, row: RigFormat, place: _FileOrigin, models: Mapping[str, str]
) -> ImportedRig:
    read = row.read(path)
    require_at_most(path, "sensors", len(read), MAX_SENSORS, "sensors")
    for number, each in enumerate(read, 1):
        A_NAME.checked(path, f"name of sensor {number}", each.name)
    names = named_apart([each.name for each in read])
    named = [each.called(name) for each, name in zip(read, names, strict=True)]
    found, left_out = parted(named, models)
    if not found:
        none = listed_kinds((each.kind or "", each.name) for each in left_out)
        raise InputError(path, "sensors", "cameras or LiDARs", none or "none")
    _check_chosen(path, models, found, left_out)
    done = [_with_model(each, models.get(each.name), row) for each in found]
    rig = Rig([Sensor(s.name, model, place(s.pose), s.fusion) for s, model, _ in done])
    kept = _kept(named, left_out, done, models)
    passthrough = Passthrough(row.name, kept, row.source(path), place.placed)
    told = [_left_out_line(left_out, row)] if left_out else []
    noted = merged_lines(((each.name, each.told) for each, _, _ in done), len(done))
    lines = (*told, *noted, *(line for _, _, line in done if line))
    to_choose = tuple(each.name for each, _, line in done if line.endswith(CHOOSE))
    return ImportedRig(rig, to_choose, lines, passthrough if passthrough.holds else None)


def _check_chosen(
    path: Path,
    models: Mapping[str, str],
    found: Sequence[CarriedSensor],
    left_out: Sequence[CarriedSensor],
) -> None:
    """Raise `InputError` for a model of what is no sensor of the rig."""
    names, others = [each.name for each in found], {each.name: each.kind for each in left_out}
    for key in models:
        if key not in names:
            is_one = f"a {others[key]}, which is left out" if key in others else "no sensor"
            raise InputError(path, f"model of {key}", f"one of {', '.join(names)}", is_one)


def _left_out_line(left_out: Sequence[CarriedSensor], row: RigFormat) -> str:
    """Return which sensors are not in the rig, and whether an export has them again."""
    which = listed_kinds((each.kind or "", each.name) for each in left_out)
    kept = f"; an export to {row.title} has them again" if row.passes_through else ""
    return f"left out: {which}{kept}"


def _kept(
    named: Sequence[CarriedSensor],
    left_out: Sequence[CarriedSensor],
    done: Sequence[Modelled],
    models: Mapping[str, str],
) -> tuple[SourceSensor, ...]:
    """Return what is kept of each sensor, in the file's order."""
    kept = {each.name: SourceSensor(each.name, each.kind or "", each.entry) for each in left_out}
    for each, model, line in done:
        text = "" if each.name in models else model_text(model)
        known = each.name, model.kind, each.entry, each.pose, text
        kept[each.name] = SourceSensor(*known, line.endswith(CHOOSE))
    return tuple(kept[each.name] for each in named)


def _with_model(each: CarriedSensor, chosen: str | None, row: RigFormat) -> Modelled:
    """Return a sensor, its model, and a line about that where there is something to know."""
    each = replace(each, kind=each.kind or (CAMERA if _sounds_like_a_camera(each.name) else LIDAR))
    model, line = _model(each, chosen, row)
    return row.settled(replace(each, model=model.name)), model, line


def _sounds_like_a_camera(name: str) -> bool:
    return any(word in name.lower() for word in LENS_WORDS)


def _model(each: CarriedSensor, chosen: str | None, row: RigFormat) -> tuple[SensorModel, str]:
    if chosen is not None:
        return catalog.load(chosen), ""
    if (known := _known(each)) is not None:
        model, line = _known_or_own(each, catalog.load(known), row)
        return with_ranges(model, each), line
    if each.kind == CAMERA and each.picture is not None:
        own, line = camera_of(each.name, each.picture, row.usual_size)
        return with_ranges(own, each), line
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
    each: CarriedSensor, model: SensorModel, row: RigFormat
) -> tuple[SensorModel, str]:
    """Return the catalogue's model, or the file's own lens where that is another one."""
    picture = picture_of(model)
    if picture is None or each.picture is None or alike(row.keeps(picture), each.picture):
        return model, ""
    own, line = camera_of(each.name, each.picture, row.usual_size)
    told = f"{each.name}: its lens is not that of {model.name} in the catalogue, but the file's"
    return own, line or told
