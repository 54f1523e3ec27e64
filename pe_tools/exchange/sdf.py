"""SDF of Gazebo: the sensors of the links of a model, in the frame of the model. Poses are relative
to the link, the model, or the frame that ``relative_to`` names (SDF 1.7 and later)."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

from pe_core.base.errors import InputError, plural, shown
from pe_core.geometry.poses import Pose

from . import foreign_values as values
from . import frames
from .gazebo_sensors import LinkBlock, pose_in, read_sensors
from .portable import ORIGIN, PortableRig

MODEL = "__model__"  # Name of a model's own frame
WORLD = "world"


@dataclass(frozen=True, slots=True)
class NamedElement:
    """An element of a model with a pose: its name in the whole model, the frame that its pose is
    relative to by default, and the prefix of the names in its model."""

    element: Element
    name: str
    parent: str
    scope: str


def read_sdf(path: Path, root: Element) -> tuple[PortableRig, list[str]]:
    """Return the sensors of the one model with sensors, and messages on what is not read."""
    models = [
        *root.findall("model"),
        *(model for world in root.findall(WORLD) for model in world.findall("model")),
    ]
    with_sensors = [model for model in models if next(model.iter("sensor"), None) is not None]
    if len(with_sensors) != 1:
        found = ", ".join(shown(m.get("name", "")) for m in with_sensors) or "none"
        raise InputError(path, "model", "one model with sensors", found)
    (model,) = with_sensors
    named = list(_elements(model, "", ""))
    values.require_at_most(path, "link", len(named), values.MAX_FRAMES, noun="links and frames")
    poses = _poses(path, named)
    in_scope: dict[str, dict[str, Pose]] = {}
    sensors = []
    for each in named:
        if each.element.tag != "link" or each.element.find("sensor") is None:
            continue
        if each.scope not in in_scope:
            names = {name.removeprefix(each.scope): pose for name, pose in poses.items()}
            in_scope[each.scope] = names
        at = LinkBlock(each.name, poses[each.name], [each.element])
        sensors += read_sensors(path, at, in_scope[each.scope])
    lines = []
    if included := [*model.iter("include")]:
        uris = ", ".join((include.findtext("uri") or "").strip() for include in included[:12])
        lines.append(f"not read, {plural(len(included), 'model')} of other files: {uris}")
    return tuple(sensors), lines


def _elements(model: Element, scope: str, parent: str) -> Iterator[NamedElement]:
    """Yield a model's own frame, its links, joints and frames, and those of models in it."""
    own = f"{scope}{MODEL}"
    yield NamedElement(model, own, parent, scope)
    for element in model:
        name = f"{scope}{element.get('name', '')}"
        if element.tag == "link":
            yield NamedElement(element, name, own, scope)
        elif element.tag == "frame":
            attached = element.get("attached_to")
            yield NamedElement(element, name, f"{scope}{attached}" if attached else own, scope)
        elif element.tag == "joint":
            child = (element.findtext("child") or "").strip()
            yield NamedElement(element, name, f"{scope}{child}" if child else own, scope)
        elif element.tag == "model":
            yield from _elements(element, f"{name}::", own)


def _poses(path: Path, named: list[NamedElement]) -> dict[str, Pose]:
    """Return the poses of all frames in that of the model, whose own pose in a world is left out.
    A model in a model is known by its name, too."""
    names = {each.name for each in named}
    hung: dict[str, tuple[str, Pose]] = {}
    for each in named:
        if not each.parent:
            continue
        pose = each.element.find("pose")
        relative = "" if pose is None else pose.get("relative_to", "")
        outer = each.scope
        if each.element.tag == "model":  # its pose is named in the model around it
            outer = each.parent.removesuffix(MODEL)
        parent = f"{outer}{relative}" if relative else each.parent
        parent = parent if parent in names else f"{parent}::{MODEL}"
        field = f"pose of {each.name}"
        if parent not in names:
            raise InputError(path, field, "the name of a link or frame", shown(relative or parent))
        hung[each.name] = (parent, pose_in(path, field, pose))
    if len(names) != len(named):
        raise InputError(path, "link", "names used once", "a name used twice")
    return {MODEL: ORIGIN, **frames.poses_from_root(path, hung, names, "frame")}
