"""The tables [prior] and [ap] of a study: what a score is of."""

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Annotated

from ..base.codec import Node, hook, read_fields, write_fields
from ..base.errors import InputError, one_of, shown
from ..base.plugins import shipped
from ..base.setting import Named, OneOf, Part, Triple, same_setting
from ..base.values import A_PATH
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
class ClassFile:
    """A class of objects that replaces or adds to those of the model; of a shipped one only the
    keys that differ."""

    name: Named
    size: tuple[float, float, float] | None = None
    height_spread: float | None = None
    decay_x: float | None = None
    laplace_y: float | None = None
    gauss_y: float | None = None
    laplace_share: float | None = None
    lanes: tuple[float, ...] | None = None
    share: float | None = None
    length_spread: float | None = None
    width_spread: float | None = None
    any_heading: float | None = None

    def over(self, classes: Sequence[ObjectClass]) -> ObjectClass:
        """Return the class, with keys that are absent from the one of its name."""
        own = {each.name: getattr(self, each.name) for each in fields(self)}
        given = {key: value for key, value in own.items() if value is not None}
        base = next((each for each in classes if each.name == self.name), None)
        if base is not None:
            return replace(base, **given)
        for each in fields(ObjectClass):
            if each.name not in given and each.default is MISSING:
                raise InputError(f"class {self.name!r}", each.name, "a value", "nothing")
        return ObjectClass(**given)

    @classmethod
    def of(cls, own: ObjectClass, classes: Sequence[ObjectClass]) -> "ClassFile":
        """Return the table of a class, without what it shares with the one of its name."""
        base = next((each for each in classes if each.name == own.name), None)
        keys = [each.name for each in fields(ObjectClass) if each.name != "name"]
        usual = {each.name: each.default for each in fields(ObjectClass)}
        usual |= {} if base is None else {key: getattr(base, key) for key in keys}
        values = {key: getattr(own, key) for key in keys}
        return cls(own.name, **{key: v for key, v in values.items() if v != usual[key]})


@dataclass(frozen=True)
class PriorFile:
    """The table [prior]: a model with its classes, or a file of boxes or of weights."""

    model: Annotated[str | None, Part(rule=OneOf(NAMED_MODELS))] = None
    classes: tuple[str, ...] | None = None
    own_classes: Annotated[tuple[ClassFile, ...], Part(key="class")] = ()
    boxes: Annotated[str | None, Part(rule=A_PATH)] = None
    origin: Annotated[tuple[float, float, float] | None, Part(rule=Triple(ORIGIN))] = None
    grid: Annotated[str | None, Part(rule=A_PATH)] = None
    space: PerceptionSpace | None = None
    focus: tuple[Focus, ...] = ()
    density: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, prior: Prior) -> "PriorFile":
        """Return the table of a prior."""
        focus = prior.focus
        density = dict(prior.density)
        if prior.boxes is not None:
            file = prior.boxes.file or BOXES
            return cls(boxes=file, origin=prior.boxes.origin, focus=focus, density=density)
        if prior.grid is not None:
            return cls(grid=prior.grid.file or GRID, space=prior.grid.space, focus=focus)
        classes = SHIPPED.get(prior.model, ())
        own = [ClassFile.of(each, classes) for each in prior.classes if each not in classes]
        names = tuple(prior.class_names)
        by_default = dict.fromkeys([each.name for each in (*classes, *prior.classes)])
        chosen = names if classes and names != tuple(by_default) else None
        return cls(prior.model, chosen, tuple(own), focus=focus, density=density)


def _read_prior(node: Node) -> Prior:
    own = read_fields(PriorFile, node)
    source = next((key for key in (FROM_BOXES, FROM_GRID) if key in node.table), None)
    for key in ("model", "classes", "class", FROM_GRID):
        if source not in (None, key) and key in node.table:
            raise node.error(f"nothing beside {node.path}.{source}", "a value", key)
    for key, needed in (("origin", FROM_BOXES), ("space", FROM_GRID)):
        if key in node.table and needed not in node.table:
            raise node.error(f"nothing without {node.path}.{needed}", "a value", key)
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
    """Return the prior of a model, with own classes."""
    model = own.model or DEFAULT_MODEL
    classes = SHIPPED.get(model, ())
    for key in ("class", "classes"):
        if key in node.table and not classes:
            raise node.error(f"nothing beside model {model!r}", "a value", key)
    known = {each.name: each for each in classes}
    for number, each in enumerate(own.own_classes):
        if each.name in [before.name for before in own.own_classes[:number]]:
            raise node.error("each name once", f"{each.name!r} twice", "class")
        with node.at("class").items[number].naming():
            known[each.name] = each.over(classes)
    for name in own.classes or ():
        if name not in known:
            raise node.error(one_of(known, name), shown(name), "classes")
    return Prior(model, tuple(known[name] for name in own.classes or known))


def _write_prior(prior: Prior) -> dict[str, object]:
    return write_fields(PriorFile.of(prior))


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
