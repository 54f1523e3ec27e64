"""The tables [metric], [ap], [fusion] and [prior] of a study: what a score is of."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..base.plugins import shipped
from ..base.setting import changed_settings, read_declared, read_settings, settings_table
from ..base.table_reader import REQUIRED, Table
from ..base.values import A_NAME, A_PATH, vector
from ..geometry.grids import PerceptionSpace
from ..metric.entropy import ApCurve
from ..prior.boxes import ORIGIN
from ..prior.classes import FIELDS, SHIPPED, ObjectClass
from ..prior.grid import read_grid
from ..prior.prior import FROM_BOXES, FROM_GRID, MODELS, Densities, Focus, Prior, checked_densities
from ..scoring.targets import TargetRule
from ..sensors import BLIND_RULES, KINDS, PerceptionModel
from .file_names import BOXES, GRID

CLASSES = "objects"  # The table of a kind's curves by class, in [ap.KIND]
DEFAULT_MODEL = "road"
OF_OBJECTS = dict.fromkeys(("length_spread", "width_spread", "any_heading"), 0.0)
"""Settings of a class that matter only for objects, with defaults that a file leaves out."""
OPTIONAL = {"lanes": (0.0,), "share": 1.0, **OF_OBJECTS}
"""Optional keys of an own class."""
NOT_NUMBERS = ("name", "size", "lanes")


def read_targets(table: Table) -> TargetRule:
    """Return whether voxels or objects are scored, from [metric]."""
    return read_declared(table, TargetRule)


def targets_table(targets: TargetRule) -> dict[str, Any] | None:
    """Return the table [metric]; None for the voxels of the paper."""
    if targets == TargetRule():
        return None
    return settings_table(targets)


def read_model(curves: Table, fusion: Table) -> PerceptionModel:
    """Return the perception model: AP curves of voxels and objects, the rule for blind sensors."""
    default = PerceptionModel()
    tables = {kind: curves.table(kind) for kind in KINDS}
    objects = {}
    for kind, table in tables.items():
        own = table.table(CLASSES)
        objects[kind] = {name: read_curve(own.table(name)) for name in own.names}
    by_kind: Any = {kind: read_curve(table, default.curve(kind)) for kind, table in tables.items()}
    blind = fusion.text("blind", default.blind, BLIND_RULES)
    chosen = read_settings(curves, PerceptionModel)
    model = PerceptionModel(blind, objects=objects, **chosen, **by_kind)
    curves.finish()
    fusion.finish()
    return model


def curves_table(model: PerceptionModel) -> dict[str, Any]:
    """Return the table [ap]: all curves by kind, and the model and classes that are not default."""
    return changed_settings(model) | {
        kind: {
            **curve_table(curve),
            CLASSES: {n: curve_table(c) for n, c in model.objects.get(kind, {}).items()} or None,
        }
        for kind, curve in model.curves.items()
    }


def curve_table(curve: ApCurve) -> dict[str, Any]:
    """Return the table of an AP curve, without a range term of 0."""
    return {key: value for key, value in settings_table(curve).items() if key != "c" or value}


def read_curve(table: Table, default: ApCurve | None = None) -> ApCurve:
    """Return an AP curve from its table; keys that are absent are those of the default."""
    return read_declared(table, ApCurve, default=default)


def read_prior(table: Table, folder: Path) -> Prior:
    """Read a prior; the path of its boxes or weights is relative to `folder`."""
    own = next((key for key in (FROM_BOXES, FROM_GRID) if key in table), None)
    for key in ("model", "classes", "class", FROM_GRID):
        if own not in (None, key) and key in table:
            raise table.error(key, f"nothing beside {table.field(str(own))}", "a value")
    read = {FROM_BOXES: _read_boxes, FROM_GRID: _read_grid}
    prior = read[own](table, folder) if own else _read_model(table)
    prior = replace(prior, focus=tuple(read_declared(t, Focus) for t in table.tables("focus")))
    if "density" in table:
        prior = replace(prior, density=_read_density(table.table("density"), prior))
    table.finish()
    return prior


def prior_table(prior: Prior) -> dict[str, Any]:
    """Return the table of a prior; keys that the file leaves out are None."""
    focus = [settings_table(each) for each in prior.focus]
    if prior.boxes is not None:
        named, origin = prior.boxes.file or BOXES, prior.boxes.origin
        where = {FROM_BOXES: named, "origin": None if origin is None else list(origin)}
        return {**where, "focus": focus or None, "density": dict(prior.density) or None}
    if (grid := prior.grid) is not None:
        return {
            FROM_GRID: grid.file or GRID,
            "focus": focus or None,
            "space": settings_table(grid.space),
        }
    shipped = SHIPPED.get(prior.model, ())
    tables = [t for c in prior.classes if len(t := _class_table(c, shipped)) > 1]
    names = list(prior.class_names)
    in_order = not shipped or names == _names(shipped, prior.classes)
    return {
        "model": prior.model,
        "classes": None if in_order else names,
        "class": tables or None,
        "focus": focus or None,
        "density": dict(prior.density) or None,
    }


def _read_density(table: Table, prior: Prior) -> Densities:
    """Return the number of objects of each class round the vehicle at a time."""
    names = [name for name in prior.class_names if name in table]
    counts = tuple((name, table.number(name)) for name in names)
    table.finish()
    return checked_densities(counts, prior.class_names)


def _read_boxes(table: Table, folder: Path) -> Prior:
    file, origin = table.text(FROM_BOXES, rule=A_PATH), table.numbers("origin", 3, None)
    if origin is not None:
        origin = vector(table.source, table.field("origin"), origin, 3, ORIGIN)
    at = None if origin is None else (origin[0], origin[1], origin[2])
    return Prior.from_boxes(replace(shipped("reader.boxes")(folder / file, at), file=file))


def _read_grid(table: Table, folder: Path) -> Prior:
    file = table.text(FROM_GRID, rule=A_PATH)
    grid = read_grid(folder / file, read_declared(table.table("space"), PerceptionSpace))
    return Prior(FROM_GRID, grid=replace(grid, file=file))


def _read_model(table: Table) -> Prior:
    model = table.text(
        "model", DEFAULT_MODEL, [m for m in MODELS if m not in (FROM_BOXES, FROM_GRID)]
    )
    shipped = SHIPPED.get(model, ())
    for key in ("class", "classes"):
        if key in table and not shipped:
            raise table.error(key, f"nothing beside model {model!r}", "a value")
    own = [_read_class(t, shipped) for t in table.tables("class")]
    for cls in own:
        if [c.name for c in own].count(cls.name) > 1:
            raise table.error("class", "each name once", f"{cls.name!r} twice")
    known = {c.name: c for c in (*shipped, *own)}
    names = table.texts("classes", tuple(known))
    for name in names:
        if name not in known:
            raise table.error("classes", f"some of {', '.join(known)}", repr(name))
    return Prior(model, tuple(known[name] for name in names))


def _read_class(table: Table, shipped: Sequence[ObjectClass]) -> ObjectClass:
    """Read a class; a class with the name of a shipped one needs only the keys that differ."""
    name = table.text("name", rule=A_NAME)
    base = next((c for c in shipped if c.name == name), None)

    def default(key: str) -> Any:
        return OPTIONAL.get(key, REQUIRED) if base is None else getattr(base, key)

    values = {key: table.number(key, default(key)) for key in FIELDS if key not in NOT_NUMBERS}
    size = table.numbers("size", 3, default("size"))
    lanes = _read_lanes(table, default("lanes"))
    table.finish()
    with table.naming():
        return ObjectClass(name=name, size=(size[0], size[1], size[2]), lanes=lanes, **values)


def _read_lanes(table: Table, default: tuple[float, ...]) -> tuple[float, ...]:
    value = table.raw("lanes", default)
    return table.numbers("lanes", len(value) if isinstance(value, list) else 1, default)


def _class_table(cls: ObjectClass, shipped: Sequence[ObjectClass]) -> dict[str, Any]:
    """Return the table of a class: its name, and the keys that differ from the shipped class."""
    base = next((c for c in shipped if c.name == cls.name), None)
    told = [f for f in FIELDS if getattr(cls, f) != getattr(base, f, OF_OBJECTS.get(f))]
    values = {f: getattr(cls, f) for f in ("name", *told)}
    return {f: list(v) if isinstance(v, tuple) else v for f, v in values.items()}


def _names(shipped: Sequence[ObjectClass], classes: Sequence[ObjectClass]) -> list[str]:
    """Return names in the default order: the shipped classes first, then new ones."""
    names = [c.name for c in shipped]
    return names + [c.name for c in classes if c.name not in names]
