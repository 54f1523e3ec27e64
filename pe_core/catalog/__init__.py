"""Catalogue of sensor presets: a TOML file for each maker, and the source of all figures.

Three presets have no document as a source, which they state (Waymo's: general knowledge). Three
are not products, but cameras for comparison.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ..base.arrays import read_only_data
from ..base.errors import InputError, one_of, require_keys, shown
from ..base.files import decode_text, read_bytes
from ..base.table_reader import load_toml
from ..base.values import A_NAME, A_TEXT, choice
from ..scene.data_sheet import DataSheet
from ..scene.named_places import named_places
from ..scene.rig import Housing, Rig, Sensor, SensorModel
from ..scene.vehicle import Vehicle
from ..sensors import kind_named, kind_of
from .housings import read_data_sheet, read_housing, scan_above_base
from .rigs import KnownRig as KnownRig
from .rigs import KnownSensor as KnownSensor
from .rigs import known_rig as known_rig
from .rigs import known_rigs as known_rigs
from .templates import PlacesByName, at_nearest, filled
from .templates import RigTemplate as RigTemplate
from .templates import templates as templates

__all__ = ["OTHER_LABELS", "OWN", "Entry", "KnownRig", "KnownSensor", "RigTemplate", "add"]
__all__ += ["add_file", "added", "data_sheet", "entries", "entry_of", "from_table", "housing"]
__all__ += ["known_rig", "known_rigs", "load", "matching", "names", "remove", "replace_added"]
__all__ += ["rig_named", "rig_on", "scan_above_base", "sensors_on", "templates", "to_table"]

PAPER_FILE = "paper.toml"  # File with the paper's sensors, which come first in lists
OWN = "own"  # Replaces the file name for presets that a program has added
OTHER_LABELS = {
    PAPER_FILE: "Paper",
    "cameras.toml": "Cameras",
    "ultrasonic.toml": "Ultrasonic",
    OWN: "Own",
}
"""Labels of the files that do not belong to a maker."""
COMMON_KEYS = frozenset({"kind", "source", "note", "housing", "data_sheet"})


@dataclass(frozen=True, slots=True)
class Entry:
    """A sensor of the catalogue: its name, the name of its file, and its table in that file."""

    name: str
    file: str
    table: Mapping[str, Any]

    @property
    def kind(self) -> str:
        """Name of its kind: ``"lidar"``, ``"camera"``."""
        return str(self.table["kind"])

    @property
    def source(self) -> str:
        """Where the figures come from."""
        return str(self.table.get("source", ""))

    @property
    def maker(self) -> str:
        """Name of the maker, or another label, by which lists are grouped."""
        has_maker = self.file not in OTHER_LABELS
        return self.name.split()[0] if has_maker else OTHER_LABELS[self.file]


_added: dict[str, Entry] = {}
_loaded: dict[str, SensorModel] = {}
"""Cache of loaded sensors by name: at most one for each entry."""


def entries() -> Mapping[str, Entry]:
    """Return all entries by name: those of the files in order, then those added by programs."""
    return MappingProxyType({**_shipped(), **_added}) if _added else _shipped()


def entry_of(name: str) -> Entry | None:
    """Return the entry of that name; None where there is none. A file that has not that text is not
    parsed."""
    if name in _added:
        return _added[name]
    tables = (_entries_in(file) for file, text in _files().items() if name in text)
    return next((found[name] for found in tables if name in found), None)


def names(kind: str | None = None) -> list[str]:
    """Return the names in the catalogue, of one kind or of all kinds."""
    return [e.name for e in entries().values() if kind in (None, e.kind)]


def matching(typed: str) -> list[str]:
    """Return the names equal to the typed text, or else those that contain it; case is ignored. A
    single result is unambiguous: only ``"Hesai QT128C2X"`` contains ``"QT128"``."""
    wanted = typed.strip().casefold()
    containing = [name for name in names() if wanted in name.casefold()] if wanted else []
    exact = [name for name in containing if name.casefold() == wanted]
    return exact or containing


def add(name: str, table: Mapping[str, Any], folder: Path | None = None) -> None:
    """Add a preset to the catalogue, until the program ends.

    `InputError` when the name is taken, or the table does not describe a sensor.

    `table`: Table of the sensor, see `from_table`.
    `folder`: Folder of the table's file of angles.
    """
    if name in entries():
        raise InputError("catalogue", "name", "a name used once", repr(name))
    _loaded[name] = from_table(name, table, folder)
    _added[name] = Entry(name, OWN, read_only_data(table))


def add_file(path: Path) -> list[str]:
    """Add the presets of a file, a table each by its name; return their names. `InputError` when
    the file is no TOML, or a preset cannot be added; then none of them is."""
    tables = load_toml(path, "catalogue", decode_text(read_bytes(path)))
    added = []
    try:
        for name, table in tables.items():
            add(name, table, path.parent)
            added.append(name)
    except InputError:
        for name in added:
            remove(name)
        raise
    return added


def remove(name: str) -> None:
    """Remove a preset that was added with `add`, if there is one of that name."""
    if _added.pop(name, None) is not None:
        _loaded.pop(name, None)


def added() -> dict[str, SensorModel]:
    """Return the sensors that were added, by name."""
    return {name: _loaded[name] for name in _added}


def replace_added(models: Mapping[str, SensorModel]) -> None:
    """Have these sensors in place of all that were added: those of another process."""
    for name in tuple(_added):
        remove(name)
    for name, model in models.items():
        _loaded[name] = model
        _added[name] = Entry(name, OWN, read_only_data(to_table(model)))


def load(name: str) -> SensorModel:
    """Return the sensor of that name; the same object every time. `InputError` when there is no
    such sensor; the message has similar names."""
    name = A_TEXT.checked("catalogue", "model", name)
    if name not in _loaded:
        entry = entry_of(name)
        if entry is None:
            raise InputError("catalogue", "model", one_of(names(), name), shown(name))
        _loaded.setdefault(name, from_table(name, entry.table))
    return _loaded[name]


def rig_named(key: str) -> KnownRig | RigTemplate:
    """Return the known rig, or the rig template, of that key.

    `InputError` when there is none of that key.
    """
    every: dict[str, KnownRig | RigTemplate] = {**known_rigs(), **templates()}
    return every[choice("catalogue", "rig", key, every)]


def sensors_on(
    rig: KnownRig | RigTemplate, vehicle: Vehicle | None = None, places: PlacesByName | None = None
) -> tuple[KnownSensor, ...]:
    """Return the sensors of a rig on a vehicle.

    A template fills the places, by default those that `named_places` finds. A known rig is scaled
    to the vehicle's bounds, without a vehicle as it was published; with places, each sensor is then
    moved to the nearest of them. `InputError` for a template with neither vehicle nor places.
    """
    if isinstance(rig, RigTemplate):
        if places is None:
            if vehicle is None:
                raise InputError(rig.key, "vehicle", "a mesh: its places are found on it", "none")
            places = named_places(vehicle)
        return filled(rig, places, load)
    sensors = rig.sensors
    if vehicle is not None:
        sensors = rig.on_vehicle(*(bound.tolist() for bound in vehicle.bounds))
    return sensors if places is None else tuple(at_nearest(sensors, places, load))


def rig_on(
    rig: KnownRig | RigTemplate, vehicle: Vehicle | None = None, places: PlacesByName | None = None
) -> Rig:
    """Return the rig of `sensors_on`."""
    found = sensors_on(rig, vehicle, places)
    return Rig([Sensor(s.name, load(s.model), s.pose) for s in found])


def housing(name: str) -> Housing | None:
    """Return the housing of the sensor of that name; None if its size is not known. `InputError`
    when its table in the catalogue is not valid."""
    entry = entry_of(name)
    table = None if entry is None else entry.table.get("housing")
    return None if table is None else read_housing(name, table)


def data_sheet(name: str) -> DataSheet:
    """Return the figures of the sensor of that name, None where no data sheet has them.
    `InputError` when its table in the catalogue is not valid."""
    entry = entry_of(name)
    table = None if entry is None else entry.table.get("data_sheet")
    return DataSheet() if table is None else read_data_sheet(name, table)


def from_table(name: str, table: Mapping[str, Any], folder: Path | None = None) -> SensorModel:
    """Build a sensor from a table of the catalogue, or from a user's table of the same form.

    LiDAR: ``kind = "lidar"``, ``elevations_deg``, ``azimuth_count`` or ``azimuth_step_deg``,
    ``max_range_m``; optional ``azimuth_offsets_deg`` (counter-clockwise from above) and
    ``horizontal_fov_deg``. In place of elevations and offsets, ``angles``: a file that
    `read_angles` reads, relative to `folder`. Camera: ``kind = "camera"``, ``width``,
    ``height``, ``hfov_deg``, or a lens: ``fx``, ``fy``, ``cx``, ``cy``, ``distortion``,
    ``fov_deg``; optional ``min_range_m``, ``max_range_m``. Other kinds: their own keys.
    All kinds: ``source``, ``note``, and ``housing`` and ``data_sheet`` (see `read_housing` and
    `read_data_sheet`), which are not used here.

    `InputError` when a value or the file of angles is not valid, or there is no such kind.
    """
    name = A_NAME.checked("sensor", "name", name)
    if not isinstance(table, Mapping):
        raise InputError(name, "model", "a table", shown(table))
    kind = kind_named(table.get("kind"), name)
    require_keys(name, "", table, kind.keys | COMMON_KEYS)
    if "housing" in table:
        read_housing(name, table["housing"])
    if "data_sheet" in table:
        read_data_sheet(name, table["data_sheet"])
    try:
        return kind.read(name, table, folder or Path())
    except InputError as error:
        field = error.field
        with_unit = [key for key in kind.keys if key.rpartition("_")[0] == field]
        if field not in kind.keys and with_unit:  # the key of a model's field: `min_range_m`
            field = with_unit[0]
        raise InputError(error.source, field, error.expected, error.found) from None


def to_table(model: SensorModel) -> dict[str, Any]:
    """Return the table from which `from_table` builds this sensor."""
    kind = kind_of(model)
    return {"kind": kind.name, **kind.write(model)}


@cache
def _files() -> Mapping[str, str]:
    """Read the texts of all files, by the names of files in the order of lists."""
    files = [f for f in resources.files(__package__).iterdir() if f.name.endswith(".toml")]
    files.sort(key=lambda f: (f.name != PAPER_FILE, f.name))
    return {file.name: file.read_text("utf-8") for file in files}


@cache
def _entries_in(file: str) -> Mapping[str, Entry]:
    """Parse the entries of a file; the result is cached."""
    tables = tomllib.loads(_files()[file])
    return {name: Entry(name, file, read_only_data(table)) for name, table in tables.items()}


@cache
def _shipped() -> Mapping[str, Entry]:
    """Parse the entries of all files; the result is cached."""
    by_name: dict[str, Entry] = {}
    for file in _files():
        for name, entry in _entries_in(file).items():
            if name in by_name:
                raise InputError(file, name, "a name used once", by_name[name].file)
            by_name[name] = entry
    return MappingProxyType(by_name)


def same_model(one: SensorModel, other: SensorModel) -> bool:
    """Return whether two models have equal values, whatever their names."""
    return one is other or to_table(one) == to_table(other)
