"""The tables [prior] and [ap] of a study: what a score is of."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

from ..base.codec import Node, hook, read_fields, write_fields
from ..base.errors import one_of, shown
from ..base.plugins import shipped
from ..base.setting import OneOf, Part, Triple, same_setting
from ..base.values import A_NAME, A_PATH
from ..geometry.grids import PerceptionSpace
from ..metric.entropy import ApCurve
from ..prior.boxes import ORIGIN
from ..prior.classes import SHIPPED, ObjectClass
from ..prior.grid import read_grid
from ..prior.prior import FROM_BOXES, FROM_GRID, MODELS, Focus, Prior
from ..sensors import BLIND_RULES, PerceptionModel
from .file_names import BOXES, GRID

DEFAULT_MODEL = "road"
NAMED_MODELS = tuple(model for model in MODELS if model not in (FROM_BOXES, FROM_GRID))


@dataclass(frozen=True)
class PriorFile:
    """The table [prior]: a model with its classes, or a file of boxes or of weights."""

    model: Annotated[str | None, Part(rule=OneOf(NAMED_MODELS))] = None
    classes: tuple[str, ...] | None = None
    own_classes: Annotated[tuple[ObjectClass, ...], Part(key="class", changes=True)] = ()
    boxes: Annotated[str | None, Part(rule=A_PATH)] = None
    origin: Annotated[tuple[float, float, float] | None, Part(rule=Triple(ORIGIN))] = None
    grid: Annotated[str | None, Part(rule=A_PATH)] = None
    space: PerceptionSpace | None = None
    focus: tuple[Focus, ...] = ()
    density: Mapping[str, float] = field(default_factory=dict)


def _read_prior(node: Node) -> Prior:
    source = next((key for key in (FROM_BOXES, FROM_GRID) if key in node.table), None)
    for key in ("model", "classes", "class", FROM_GRID):
        if source not in (None, key) and key in node.table:
            raise node.error(f"nothing beside {node.path}.{source}", "a value", key)
    for key, needed in (("origin", FROM_BOXES), ("space", FROM_GRID)):
        if key in node.table and needed not in node.table:
            raise node.error(f"nothing without {node.path}.{needed}", "a value", key)
    rest = {key: value for key, value in node.table.items() if key != "class"}
    own = read_fields(PriorFile, node.with_value(rest, node.path))
    if own.boxes is not None:
        boxes = shipped("reader.boxes")(node.folder / own.boxes, own.origin)
        prior = Prior.from_boxes(replace(boxes, file=own.boxes))
    elif own.grid is not None:
        grid = read_grid(node.folder / own.grid, own.space or PerceptionSpace())
        prior = Prior(FROM_GRID, grid=replace(grid, file=own.grid))
    else:
        prior = _of_model(own, node)
    with node.naming():
        return replace(prior, focus=own.focus, density=tuple(own.density.items()))


def _of_model(own: PriorFile, node: Node) -> Prior:
    """Return the prior of a model; of a class of its own with a shipped name, keys that are absent
    are those of the shipped one."""
    model = own.model or DEFAULT_MODEL
    shipped_classes = {each.name: each for each in SHIPPED.get(model, ())}
    for key in ("class", "classes"):
        if key in node.table and not shipped_classes:
            raise node.error(f"nothing beside model {model!r}", "a value", key)
    own_classes = dict[str, ObjectClass]()
    for row in node.at("class", []).items:
        name = A_NAME.checked(row.source, f"{row.path}.name", row.table.get("name"))
        if name in own_classes:
            raise node.error("each name once", f"{name!r} twice", "class")
        own_classes[name] = read_fields(ObjectClass, row, shipped_classes.get(name))
    known = shipped_classes | own_classes
    for name in own.classes or ():
        if name not in known:
            raise node.error(one_of(known, name), shown(name), "classes")
    return Prior(model, tuple(known[name] for name in own.classes or known))


def _write_prior(prior: Prior) -> dict[str, object]:
    focus = prior.focus
    density = dict(prior.density)
    if prior.boxes is not None:
        file = prior.boxes.file or BOXES
        origin = prior.boxes.origin
        return write_fields(PriorFile(boxes=file, origin=origin, focus=focus, density=density))
    if prior.grid is not None:
        file = prior.grid.file or GRID
        return write_fields(PriorFile(grid=file, space=prior.grid.space, focus=focus))
    classes = {each.name: each for each in SHIPPED.get(prior.model, ())}
    own = [each for each in prior.classes if each != classes.get(each.name)]
    by_default = classes | dict.fromkeys(prior.class_names)
    chosen = tuple(prior.class_names) if classes and [*prior.class_names] != [*by_default] else None
    table = write_fields(PriorFile(prior.model, chosen, focus=focus, density=density))
    rows = [{"name": e.name, **write_fields(e, classes.get(e.name))} for e in own]
    return {**table, "class": rows} if rows else table


@dataclass(frozen=True)
class ModelFile:
    """The table [ap]: the model of objects, and curves by kind and by class."""

    model: str = same_setting(PerceptionModel, "model")
    curves: Annotated[Mapping[str, ApCurve], Part(inline=True)] = field(default_factory=dict)
    objects: Mapping[str, Mapping[str, ApCurve]] = field(default_factory=dict)

    @classmethod
    def of(cls, model: PerceptionModel) -> "ModelFile":
        """Return the table of a model; curves of a kind's own are left out."""
        return cls(model.model, model.other_curves, model.objects)


@dataclass(frozen=True)
class FusionTable:
    """The table [fusion]: how sensors that see nothing count."""

    blind: Annotated[str, Part(rule=OneOf(BLIND_RULES))] = "floor"


hook(Prior, _read_prior, _write_prior, PriorFile)
