"""Import of a rig from the files of another program."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from pe_core import catalog
from pe_core.base.errors import InputError, report_memory_errors, shown
from pe_core.base.values import A_NAME
from pe_core.geometry.poses import Pose
from pe_core.scene.rig import Rig, Sensor, SensorModel
from pe_core.scene.vehicle_description import Reference
from pe_core.sensors import KINDS, coinciding

from . import portable_kinds
from .foreign_values import MAX_SENSORS, require_at_most
from .frames import composed, origin_in_ground, shifted
from .lens_pictures import alike
from .merging import listed_kinds
from .portable import ForeignRig, PortableSensor, merged_lines, named_apart
from .rig_formats import RigFormat, format_to_read
from .sensor_names import model_by_name, said_kind

NO_WORD = re.compile("[^a-z0-9]+")  # What two spellings of a model's name may differ in


class Modelled(NamedTuple):
    """A sensor and its model, a message about the model (may be empty), and whether the model
    stands in for one that the user is to choose."""

    sensor: PortableSensor
    model: SensorModel
    line: str
    stands_in: bool = False


@dataclass(frozen=True, slots=True)
class ImportedRig:
    """An imported rig and the messages about it. `to_choose`: names of sensors with a stand-in
    model, because the file does not name the model. `lines`: messages about single sensors and
    about sensors that were left out."""

    rig: Rig
    to_choose: tuple[str, ...]
    lines: tuple[str, ...]

    @property
    def lines_without_models(self) -> tuple[str, ...]:
        """The messages but those about sensors with a stand-in model."""
        return tuple(line for line in self.lines if not line.startswith(self.to_choose))


class ModelledRig(NamedTuple):
    """The rig of a file with the models of its sensors, in the format's frame. `left_out` are those
    of unknown kinds; `renamed` are messages on names that occurred twice."""

    found: ForeignRig
    modelled: tuple[Modelled, ...]
    left_out: tuple[PortableSensor, ...]
    renamed: tuple[str, ...]


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
        Name of the format; by default it is derived from the file name.
    reference : Reference, optional
        Position of the rear axle, for formats with that origin.
    models : mapping of sensor name to catalogue name, optional
        Chosen models, for sensors whose model the file does not name.
    placed : Pose, optional
        Pose of the file's origin, for a format without a vehicle.

    Raises
    ------
    InputError
        When the file is malformed, the rear axle is missing, or a chosen model does not exist.
    """
    row, path = format_to_read(Path(path), name)
    origin = origin_in_ground(row.origin, reference, row.title, path)
    with errors_of(path):
        return _imported(read_rig(path, row, models or {}), row, origin, placed)


@contextmanager
def errors_of(path: Path) -> Iterator[None]:
    """Name the file in errors about a lens, a pose or a model of it, or about memory."""
    try:
        with report_memory_errors(path):
            yield
    except InputError as error:
        if Path(error.source).is_relative_to(path if path.is_dir() else path.parent):
            raise
        raise error.within(path) from None


def read_rig(path: Path, row: RigFormat, models: Mapping[str, str]) -> ModelledRig:
    """Read a file and find the models of its sensors; `models` are those chosen, by name."""
    found = row.read(path)
    sensors = found.sensors
    require_at_most(path, "sensors", len(sensors), MAX_SENSORS, noun="sensors")
    for number, sensor in enumerate(sensors, 1):
        A_NAME.checked(path, f"name of sensor {number}", sensor.name)
    names = named_apart([sensor.name for sensor in sensors])
    named = [replace(s, name=name) for s, name in zip(sensors, names, strict=True)]
    renamed = [
        f"{name}: in the file {sensor.name}, as another sensor is"
        for sensor, name in zip(sensors, names, strict=True)
        if name != sensor.name
    ]
    included, left_out = _parted(named, models)
    if not included:
        kinds_found = listed_kinds((sensor.kind or "", sensor.name) for sensor in left_out)
        raise InputError(path, "sensors", "cameras or LiDARs", kinds_found or "none")
    kinds = {sensor.name: sensor.kind for sensor in left_out}
    known = [sensor.name for sensor in included]
    for key in models:
        if key not in known:
            what = f"a {kinds[key]}, which is left out" if key in kinds else "no sensor"
            raise InputError(path, f"model of {key}", f"one of {', '.join(known)}", what)
    modelled = tuple(_with_model(sensor, models.get(sensor.name), row) for sensor in included)
    return ModelledRig(found, modelled, tuple(left_out), tuple(renamed))


def _parted(
    sensors: Iterable[PortableSensor], chosen: Mapping[str, str]
) -> tuple[list[PortableSensor], list[PortableSensor]]:
    """Return the sensors of known kinds, and the sensors to leave out. If the file states no kind,
    the sensor's name decides, unless a model was `chosen` for it."""
    included = []
    left_out = []
    for sensor in sensors:
        kind = sensor.kind or ""
        if not (kind or sensor.name in chosen or sensor.model or sensor.has_figures):
            kind = said_kind(sensor.name) or ""
        is_chosen = kind in KINDS and sensor.name in chosen
        if not kind or is_chosen or portable_kinds.has_model(replace(sensor, kind=kind)):
            included.append(sensor)
        else:
            left_out.append(replace(sensor, kind=kind))
    return included, left_out


def _imported(
    read: ModelledRig, row: RigFormat, origin: Sequence[float], placed: Pose | None
) -> ImportedRig:
    modelled = read.modelled
    rig = []
    for sensor, model, *_ in modelled:
        pose = sensor.pose if placed is None else composed(placed, sensor.pose)
        rig.append(Sensor(sensor.name, model, shifted(pose, origin), sensor.fusion))
    hint = "; an export --into the file keeps them" if row.merges else ""
    left_out = listed_kinds((sensor.kind or "", sensor.name) for sensor in read.left_out)
    left_out_lines = [f"left out: {left_out}{hint}"] if left_out else []
    notes = merged_lines(((m.sensor.name, m.sensor.told) for m in modelled), len(modelled))
    lines = (*left_out_lines, *read.renamed, *read.found.lines, *notes)
    lines += tuple(m.line for m in modelled if m.line)
    lines += tuple(
        f"{', '.join(sensor.name for sensor in group)}: at the same place, within 1 cm; each counts"
        for group in coinciding(rig)
    )
    to_choose = tuple(m.sensor.name for m in modelled if m.stands_in)
    return ImportedRig(Rig(rig), to_choose, lines)


def _with_model(sensor: PortableSensor, chosen: str | None, row: RigFormat) -> Modelled:
    """Return a sensor with its kind resolved, its model, and a message about the model."""
    said = said_kind(sensor.name)
    sensor = replace(sensor, kind=sensor.kind or (said if said in KINDS else portable_kinds.LIDAR))
    modelled = Modelled(sensor, catalog.load(chosen), "") if chosen else _modelled(sensor, row)
    known = replace(sensor, model=modelled.model.name, is_stand_in=modelled.stands_in)
    return modelled._replace(sensor=row.settled(known))


def _modelled(sensor: PortableSensor, row: RigFormat) -> Modelled:
    """Return a sensor with the catalogue's model, one of the file's figures, the one that its name
    says, or a stand-in."""
    if (named := _catalogued(sensor, row)) is not None:
        return named
    reason = ""
    try:
        own = portable_kinds.portable_kind(sensor.kind).model(sensor, row.usual_size)
    except InputError as error:
        if sensor.picture is None:
            raise
        own = None
        reason = f"its lens is left out, {error.at('')}"
    if own is not None:
        model, line = own
        return Modelled(sensor, model, line)
    for text in filter(None, (sensor.model, sensor.name)):
        if name := model_by_name(text, sensor.kind):
            model = portable_kinds.with_ranges(catalog.load(name), sensor)
            return Modelled(sensor, model, f"{sensor.name}: {name}, as {shown(text)} says")
    return _stand_in(sensor, reason)


def _catalogued(sensor: PortableSensor, row: RigFormat) -> Modelled | None:
    """Return a sensor with the catalogue's model of the name in the file; None if there is none. A
    camera that the catalogue has with another lens gets the file's lens."""
    normalized = NO_WORD.sub("", (sensor.model or "").lower())
    names = {NO_WORD.sub("", name.lower()): name for name in catalog.names(sensor.kind)}
    if not normalized or normalized not in names:
        return None
    model = catalog.load(names[normalized])
    line = ""
    ours = portable_kinds.picture_of(model)
    theirs = sensor.picture
    if ours and theirs is not None and not alike(row.keeps(ours), theirs):
        note = f"{sensor.name}: its lens is not that of {model.name} in the catalogue, but the"
        model, line = portable_kinds.camera_of(sensor.name, theirs, row.usual_size)
        line = line or f"{note} file's"
    return Modelled(sensor, portable_kinds.with_ranges(model, sensor), line)


def _stand_in(sensor: PortableSensor, reason: str) -> Modelled:
    """Return a sensor with a stand-in for its model. `reason` may be empty: the file has none."""
    stand_in = portable_kinds.stand_in_of(sensor.kind or "")
    assert stand_in is not None, "`_parted` has left it out"
    if not reason and sensor.model:
        reason = f"no {shown(sensor.model)} in the catalogue"
    reason = reason or "no model in the file"
    if sensor.kind == portable_kinds.LIDAR and said_kind(sensor.name) is None:
        reason += ", and no kind in its name"
    line = f"{sensor.name}: {reason}; {stand_in} stands in: choose its model"
    return Modelled(sensor, catalog.load(stand_in), line, True)
