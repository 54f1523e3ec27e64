"""Which links of a robot without Gazebo's sensors are sensors: name, joint and mass decide.

A link whose name says a kind of sensor is one, whatever its mass; of several in a row on fixed
joints, such as housing and lens, the last one. A link whose name says nothing is one only where no
name says a sensor, and if it is fixed, without a mass, and nothing is on it. What is left out, and
what is taken without a name, is told."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from pe_core.sensors import KINDS

from .frames import OPTICAL_NAME, camera_frames
from .merging import listed_kinds
from .portable_kinds import CAMERA
from .sensor_names import FRAME, said_kind

MOST_NAMES = 12  # Maximum names in a message
MOST_HOUSINGS = 8  # Maximum joints from a sensor to its housing


@dataclass(frozen=True, slots=True)
class LinkTree:
    """Links of a robot by name, the root first, with their parents; `moving` are on joints that are
    not fixed, `heavy` have a mass."""

    links: tuple[str, ...]
    parents: dict[str, str]
    moving: frozenset[str]
    heavy: frozenset[str]


@dataclass(frozen=True, slots=True)
class SensorLink:
    """A link that is a sensor: the sensor's name, its link, its kind (None: unknown), and a
    camera's optical frame."""

    name: str
    frame: str
    kind: str | None
    optical: str | None = None


def has_mass(link: Element) -> bool:
    """Whether a link of a URDF has a mass: an inertia alone, or a mass of zero, is none."""
    mass = link.find("inertial/mass")
    text = "0" if mass is None else mass.get("value", "0")
    return text.strip(" 0.") != ""


def sensor_links(tree: LinkTree) -> tuple[list[SensorLink], list[str]]:
    """Return the links that are sensors, and messages on those that are not, or are guessed."""
    owners = camera_frames(tree.parents)
    said = {name: said_kind(name) for name in tree.links[1:] if name not in owners}
    said |= {owner: CAMERA for owner in owners.values() if owner in said}
    optical_of = {owner: name for name, owner in owners.items()}
    is_named = any(kind in KINDS for kind in said.values()) or bool(owners)
    inner = _inner_links(tree, said)
    on_them = set(tree.parents.values())
    result: list[SensorLink] = []
    guessed = []
    left_out = []
    for name in tree.links[1:]:
        if name in owners:
            if owners[name] not in said:
                result.append(SensorLink(owners[name], name, CAMERA))
            continue
        kind = said[name]
        may_be = name not in on_them and name not in tree.heavy and name not in tree.moving
        if name in optical_of or (kind in KINDS and name not in inner):
            result.append(SensorLink(name, name, kind, optical_of.get(name)))
        elif kind is not None and kind not in KINDS and may_be and kind != FRAME:
            result.append(SensorLink(name, name, None))  # left out by its name at import
        elif kind is None and may_be and not is_named:
            result.append(SensorLink(name, name, None))
            guessed.append(name)
        elif kind != FRAME and name not in inner and (may_be or kind is not None):
            left_out.append((kind or "link", name))
    return result, [*_left_out_lines(left_out), *_guess_lines(guessed)]


def _inner_links(tree: LinkTree, said: dict[str, str | None]) -> set[str]:
    """Return the links with another of the same kind on them, on fixed joints: its housing."""
    inner = set()
    for name, kind in said.items():
        link = name
        for _ in range(MOST_HOUSINGS if kind in KINDS else 0):
            if link not in tree.parents or link in tree.moving:
                break
            link = tree.parents[link]
            if said.get(link) == kind:
                inner.add(link)
                break
    return inner


def unread_lines(tree: LinkTree, read: Collection[str]) -> list[str]:
    """Return a message on links with the name of a sensor, in a robot whose sensors are Gazebo's,
    that are `read`. A link that holds such a sensor, or is on its link, is no other."""
    near = set(read)
    on_read = {name for name in read if name != tree.links[0] and said_kind(name) != FRAME}
    for link in read:
        while link in tree.parents and tree.parents[link] not in near:
            link = tree.parents[link]
            near.add(link)
    names = []
    for name in tree.links[1:]:  # parents come first
        if tree.parents[name] in on_read:
            on_read.add(name)
        kind = said_kind(name) or ""
        if (
            kind in KINDS
            and name not in near
            and name not in on_read
            and not OPTICAL_NAME.search(name)
        ):
            names.append((kind, name))
    return [f"left out, as Gazebo has no sensor on them: {_listed(names)}"] if names else []


def _left_out_lines(found: list[tuple[str, str]]) -> list[str]:
    return [f"left out, no sensors by name, joint or mass: {_listed(found)}"] if found else []


def _guess_lines(names: list[str]) -> list[str]:
    if not names:
        return []
    shown = ", ".join(names[:MOST_NAMES]) + (", ..." if len(names) > MOST_NAMES else "")
    return [f"taken as sensors, as fixed links without a mass, no name says so: {shown}"]


def _listed(found: Iterable[tuple[str, str]]) -> str:
    rows = list(found)
    more = len(rows) - MOST_NAMES
    return listed_kinds(rows[:MOST_NAMES]) + (f" and {more} more" if more > 0 else "")
