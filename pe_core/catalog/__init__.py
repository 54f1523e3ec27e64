"""Sensor presets, one TOML file a maker; each says where its figures come from.

Three have no document behind them and say so (Waymo's: general knowledge); three are no
product, but cameras to compare with.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib import resources
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ..errors import InputError, shown
from ..kinds import kind_named, kind_of
from ..scene.housing import Housing
from ..scene.sensors import Rig, Sensor, SensorModel
from ..scene.vehicle import Vehicle
from ..text.fixed import fixed
from ..text.values import A_NAME, A_TEXT
from .housings import read_housing
from .rigs import KnownRig as KnownRig
from .rigs import KnownSensor as KnownSensor
from .rigs import known_rig as known_rig
from .rigs import known_rigs as known_rigs
from .scan_offsets import scan_above_base

__all__ = [
    "Entry",
    "KnownRig",
    "KnownSensor",
    "add",
    "entries",
    "from_table",
    "housing",
    "known_rig",
    "known_rigs",
    "load",
    "matching",
    "names",
    "remove",
    "rig_on",
    "scan_above_base",
    "to_table",
]

PAPER_FILE = "paper.toml"
"""The paper's own sensors come first in lists."""
OWN = "own"
"""In place of a file's name, for presets that a program has added."""
NOBODY_S = {PAPER_FILE: "Paper", "cameras.toml": "Cameras", OWN: "Own"}
"""What files that are no maker's are called."""
COMMON_KEYS = frozenset({"kind", "source", "note", "housing"})


@dataclass(frozen=True, slots=True)
class Entry:
    """One sensor of the catalogue: its table as the file has it, and the file's name."""

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
        """Whose it is, as lists are divided: a file of the catalogue is a maker's."""
        named = self.file not in NOBODY_S
        return self.name.split()[0] if named else NOBODY_S[self.file]


_added: dict[str, Entry] = {}
_loaded: dict[str, SensorModel] = {}
"""Sensors by name, once each: as many as the catalogue has entries, shipped and added."""


def entries() -> Mapping[str, Entry]:
    """All entries by name, in the order of the files; then what programs have added."""
    return MappingProxyType({**_shipped(), **_added}) if _added else _shipped()


def names(kind: str | None = None) -> list[str]:
    """Names in the catalogue, of one kind or of all."""
    return [e.name for e in entries().values() if kind in (None, e.kind)]


def matching(typed: str, kind: str | None = None) -> list[str]:
    """Names, of one kind or of all, that are what was typed, or else contain it; case is one.

    A single one is what was meant: ``"QT128"`` is in ``"Hesai QT128C2X"`` alone.
    """
    wanted = typed.strip().casefold()
    found = [name for name in names(kind) if wanted in name.casefold()] if wanted else []
    exact = [name for name in found if name.casefold() == wanted]
    return exact or found


def add(name: str, table: Mapping[str, Any]) -> None:
    """Add a preset of one's own to the catalogue, until the program ends.

    Parameters
    ----------
    name : str
    table : mapping
        As `from_table` takes it.

    Raises
    ------
    InputError
        When there is a sensor of that name, or the table is no sensor's.
    """
    if name in entries():
        raise InputError("catalogue", "name", "a name used once", repr(name))
    _loaded[name] = from_table(name, table)
    _added[name] = Entry(name, OWN, fixed(table))


def remove(name: str) -> None:
    """Take a preset that was added away again; do nothing if there is none."""
    if _added.pop(name, None) is not None:
        _loaded.pop(name, None)


def load(name: str) -> SensorModel:
    """Return the sensor of that name; the same object every time.

    Raises
    ------
    InputError
        When there is no such sensor; the message offers near ones.
    """
    name = A_TEXT.checked("catalogue", "model", name)
    if name not in _loaded:
        entry = entries().get(name)
        if entry is None:
            raise InputError("catalogue", "model", f"a name such as {_near(name)}", shown(name))
        _loaded.setdefault(name, from_table(name, entry.table))
    return _loaded[name]


def rig_on(known: KnownRig, vehicle: Vehicle | None = None) -> Rig:
    """Return a known rig stretched onto a vehicle's box; without one as it was published."""
    sensors = known.sensors
    if vehicle is not None:
        low, high = vehicle.bounds
        sensors = known.on_vehicle(low.tolist(), high.tolist())
    return Rig([Sensor(each.name, load(each.model), each.pose) for each in sensors])


def housing(name: str) -> Housing | None:
    """Return the housing of the sensor of that name, None where no size of it is known.

    Raises
    ------
    InputError
        When the catalogue's table of it is wrong.
    """
    entry = entries().get(name)
    table = None if entry is None else entry.table.get("housing")
    return None if table is None else read_housing(name, table)


def from_table(name: str, table: Mapping[str, Any], folder: Path | None = None) -> SensorModel:
    """Build a sensor from a catalogue table, or a user's own of the same form.

    LiDAR: ``kind = "lidar"``, ``elevations_deg``, ``azimuth_count`` or ``azimuth_step_deg``,
    ``max_range_m``; optional ``azimuth_offsets_deg`` (counter-clockwise from above) and
    ``horizontal_fov_deg``. In place of elevations and offsets, ``angles``: a file that
    `read_angles` reads, relative to `folder`. Camera: ``kind = "camera"``, ``width``,
    ``height``, ``hfov_deg``, or a lens: ``fx``, ``fy``, ``cx``, ``cy``, ``distortion``,
    ``fov_deg``; optional ``min_range_m``, ``max_range_m``. Other kinds: the keys of their row.
    All: ``source``, ``note``, and ``housing`` (see `read_housing`), which is no part of the sensor.

    Raises
    ------
    InputError
        When a value or the file of angles is wrong, or there is no such kind.
    """
    name = A_NAME.checked("sensor", "name", name)
    if not isinstance(table, Mapping):
        raise InputError(name, "model", "a table", shown(table))
    kind = kind_named(table.get("kind"), name)
    unknown = sorted(map(str, set(table) - kind.keys - COMMON_KEYS))
    if unknown:
        raise InputError(
            name, unknown[0], f"one of {', '.join(sorted(kind.keys))}", "an unknown key"
        )
    if "housing" in table:
        read_housing(name, table["housing"])
    return kind.read(name, table, folder or Path())


def to_table(model: SensorModel) -> dict[str, Any]:
    """Return the table that `from_table` turns into this sensor again."""
    kind = kind_of(model)
    return {"kind": kind.name, **kind.write(model)}


@cache
def _shipped() -> Mapping[str, Entry]:
    """The entries of the files, read once."""
    found: dict[str, Entry] = {}
    files = [f for f in resources.files(__package__).iterdir() if f.name.endswith(".toml")]
    for file in sorted(files, key=lambda f: (f.name != PAPER_FILE, f.name)):
        for name, table in tomllib.loads(file.read_text("utf-8")).items():
            if name in found:
                raise InputError(file.name, name, "a name used once", found[name].file)
            found[name] = Entry(name, file.name, fixed(table))
    return MappingProxyType(found)


def _near(name: str) -> str:
    lowered = {n.lower(): n for n in names()}
    close = get_close_matches(name.lower(), lowered, n=3, cutoff=0.4)
    return ", ".join(repr(lowered[c]) for c in close) or repr(names()[0])
