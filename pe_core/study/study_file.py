"""The study file: TOML to `Study` and back; all its settings by key, for panel and docs."""

import functools
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from .. import catalog
from ..base.codec import Declared, Node, declared, hook, read, write
from ..base.errors import InputError, one_of, shown
from ..base.files import decode_text, read_bytes, write_bytes
from ..base.json_schema import schema_of
from ..base.setting import REQUIRED, OneOf, Setting, Several, is_angle, value_in_file
from ..base.table_reader import dumps, inline, load_toml
from ..scene.rig import Rig, SensorModel
from ..scene.vehicle import Vehicle
from .document import Document
from .mounting_file import areas_of
from .study import Study

OWN_MODEL = "own"  # Name of an own model that has none, where no sensor has one
MODEL_SCHEMA = {
    "description": "A name of the catalogue (`pe sensors`), or a table: an own model",
    "anyOf": [{"type": "string"}, {"type": "object"}],
}


def load_study(path: str | Path, *, starts_anywhere: bool = False) -> Study:
    """Read a study from its TOML file.

    `InputError`: one line with the file, the field, what was expected and what was found.

    Parameters
    ----------
    starts_anywhere : bool
        Whether sensors may be off their mounts: `Study.on_mounts` puts them there. Such a study
        cannot be searched before.
    """
    path = Path(path)
    data = load_study_data(path)
    return study_from_dict(data, str(path), path.parent, starts_anywhere=starts_anywhere)


def load_study_data(path: Path) -> dict[str, Any]:
    """Read the plain data of a study's TOML file; `InputError` where it is none."""
    return load_toml(path, "study", decode_text(read_bytes(path)))


def save_study(study: Study, path: str | Path) -> None:
    """Write a study's TOML file, atomically.

    The files that it names are not written, but have to be there; `export_study` writes them, too.

    `InputError` when the vehicle's mesh, an area or the prior's boxes or weights are in no file, or
    the study cannot be written.
    """
    path = Path(path)
    _check_beside(path, "vehicle.mesh", study.vehicle is not None, study.mesh)
    for key, prior in (("boxes", study.prior.boxes), ("grid", study.prior.grid)):
        _check_beside(path, f"prior.{key}", prior is not None, prior.file if prior else None)
    for name, area in areas_of(study.search.mounting).items():
        _check_beside(path, f"mount {name!r}: area", True, area.file)
    write_bytes(path, study_bytes(study))


def study_bytes(study: Study) -> bytes:
    """Return a study file's text; the files that it names need not exist."""
    return dumps(study_to_dict(study)).encode()


def rig_line(rig: Rig) -> str:
    """Return a rig as one line: a line of a study file, and a study file by itself."""
    return f"sensor = {inline(write(rig.sensors))}"


def read_rig_line(text: str, source: str = "rig") -> Rig:
    """Return the rig of a text of `rig_line`, or of a study file's; all else in it is left out."""
    sensors = load_toml(source, "study", text).get("sensor")
    if not sensors:
        raise InputError(
            source, "sensor", "a line as `pe export STUDY --to line` prints it", shown(text)
        )
    return study_from_dict({"sensor": sensors}, source).rig


def study_from_dict(
    data: Any,
    source: str = "study",
    folder: Path | None = None,
    *,
    starts_anywhere: bool = False,
    vehicle: Vehicle | None = None,
) -> Study:
    """Build a study from the plain data of its file; paths in it are relative to `folder`. For
    `starts_anywhere` see `load_study`; a `vehicle` takes the place of the mesh that is named."""
    node = Node(data, source, folder=folder or Path())
    try:
        study = read(Document, node).study(node, vehicle)
        study.designs()
        if study.requirements:
            study.checker()  # zones that cannot be placed are bad input, too
        if not starts_anywhere:
            study.coding()  # bounds that do not hold their start are bad input, not a late surprise
    except InputError as error:
        raise error if error.source == source else error.within(source) from None
    return study


def study_to_dict(study: Study) -> dict[str, Any]:
    """Return a study as the plain data its file holds."""
    data: dict[str, Any] = write(Document.of(study))
    return data


def study_schema() -> dict[str, Any]:
    """Return the JSON schema of the plain data of a study file."""
    return schema_of(Document) | {"required": ["sensor"]}


def _check_beside(path: Path, field: str, needed: bool, file: str | None) -> None:
    """Raise `InputError` for a file that the study names and that does not exist."""
    if needed and not (file and os.path.exists(path.parent / file)):
        expected = "a file beside the study (export_study of pe_tools writes it)"
        raise InputError(path, field, expected, shown(file) if file else "none")


def _read_model(node: Node) -> SensorModel:
    """Return a model of the catalogue, or an own model from the table's values."""
    if isinstance(node.value, str):
        if catalog.entry_of(node.value) is None:
            raise node.error(one_of(catalog.names(), node.value), shown(node.value))
        return catalog.load(node.value)
    if not isinstance(node.value, Mapping):
        raise node.error("a catalogue name or a table", shown(node.value))
    own = dict(node.value)
    name = own.pop("name", node.owner or OWN_MODEL)
    try:
        return catalog.from_table(name, own, node.folder)
    except InputError as error:
        raise node.error(error.expected, error.found, error.field) from None


def _write_model(model: SensorModel) -> str | dict[str, Any]:
    """Return the catalogue's name of a model, or the values of an own model."""
    entry = catalog.entry_of(model.name)
    is_shipped = entry is not None and entry.file != catalog.OWN
    if is_shipped and catalog.same_model(catalog.load(model.name), model):
        return model.name
    return {"name": model.name, **catalog.to_table(model)}


hook(SensorModel, _read_model, _write_model, MODEL_SCHEMA)


@functools.cache
def _declared() -> tuple[Declared, ...]:
    """Return the settings of a study, each once, in the order of its file."""
    first = dict[tuple[type, str], Declared]()
    for each in declared(Document):
        first.setdefault((each.cls, each.setting.name), each)
    return tuple(first.values())


def setting_keys(*, of_scene: bool = False) -> Iterator[Declared]:
    """Yield settings with their key in the file: ``optimize.seed``; all, or those of a scene."""
    yield from (each for each in _declared() if not (of_scene and each.rows))


@functools.cache
def settings_of_part(part: str) -> tuple[Setting, ...]:
    """Return the settings of a part of Blender's panel, in their order: of a table of the file, or
    of the field that holds their dataclass (``goals``)."""
    own = (row for row in _declared() if part in (row.key.rpartition(".")[0], row.held_as))
    return tuple(row.setting for row in own if row.setting.panel is not None)


def panel_default(setting: Setting) -> Any:
    """Return the value that a setting has in a new scene, as the panel shows it."""
    assert setting.panel is not None
    default = setting.panel.default
    if default is None and setting.default is not REQUIRED:
        of_angle = is_angle(setting.rule)  # in degrees, as in a file
        default = value_in_file(setting.rule, setting.default) if of_angle else setting.default
    if default is None and setting.default is REQUIRED:
        return None
    return default if default is not None else setting.panel.none


def is_switch(setting: Setting) -> bool:
    """Whether an optional text is shown as a switch: it has one value, or is absent."""
    return setting.is_optional and isinstance(setting.rule, OneOf) and len(setting.rule.among) == 1


def menu_of(setting: Setting) -> tuple[tuple[str, str, str], ...]:
    """Return text, label and meaning of each entry of a setting's menu."""
    panel = setting.panel
    rule = setting.rule
    assert panel is not None and isinstance(rule, OneOf | Several)
    rows = zip(rule.among, panel.menu, strict=True)
    absent = () if panel.absent is None else (panel.absent,)
    return (*absent, *((text, label, about) for text, (label, about) in rows))
