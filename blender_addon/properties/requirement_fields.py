"""What the panel's fields of a requirement read from its table, and change in it; no Blender.

A table is that of a study file, with the keys of its preset (`requirement_file.full_table`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from ..engine import pe, requirements

TableData = dict[str, Any]
Getter: TypeAlias = Callable[[TableData], Any]
Setter: TypeAlias = Callable[[TableData, Any], None]
SEVERAL, OWN = "several", "own"
BODIES_ASKED, GROUND_ASKED = "bodies", "ground"
AREA, POLYGON, RING, PATH, SPOTS = "area", "polygon", "ring", "path", "spots"
CORNERS = {POLYGON: 3, PATH: 2, SPOTS: 1}
"""Shapes with a list of corners, and how many they have at least."""
USUAL_RECTANGLE = (["front + 1", "front + 5"], ["right", "left"])
USUAL_RING = [0.2, 1.0]
USUAL_BODIES = ("adult", "child")
USUAL_SIZE = [0.5, 0.5, 1.5]
USUAL_BLIND_M2 = 0.5
AS_IN_FILE = "file"
"""An axis that the mesh file states, or the default of its format."""
AXIS_NAMES = tuple(f"{sign}{axis}" for axis in "xyz" for sign in "+-")
MESH_KEYS = ("mesh", "up", "forward", "scale")
SIZE_KEYS = ("size", "diameter", "height")
NOT_OF_GROUND = (
    "sensors",
    "kinds",
    "of",
    "points",
    "pixels",
    "pixels_high",
    "per_degree",
    "share",
    "ap",
)
OF_GROUND = ("blind_m2", "blind_out", "blind_height")


def place_of(text: str) -> str | float:
    """Return a place of a zone: a number [m], or the text of a plane with an offset."""
    try:
        return float(text)
    except ValueError:
        return text.strip()


# --- the zone -----------------------------------------------------------------------------------


def shape_of(table: TableData) -> str:
    """Return the shape of the zone."""
    zone = table.get("zone", {})
    return next((key for key in (POLYGON, RING, PATH, SPOTS) if zone.get(key)), AREA)


def reshape(table: TableData, shape: str) -> None:
    """Give the zone another shape: with the corners that it has, if it has any."""
    zone = table.setdefault("zone", {})
    if shape == shape_of(table):
        return
    corners = _corners(table)
    for key in ("x", "y", POLYGON, RING, PATH, SPOTS):
        zone.pop(key, None)
    if shape == RING:
        zone["ring"] = list(USUAL_RING)
    elif shape == AREA:
        zone["x"], zone["y"] = (list(ends) for ends in USUAL_RECTANGLE)
        if len(corners) == 4 and _is_rectangle(corners):
            zone["x"] = [corners[0][0], corners[2][0]]
            zone["y"] = [corners[0][1], corners[2][1]]
    else:
        zone[shape] = corners if len(corners) >= CORNERS[shape] else _rectangle(*USUAL_RECTANGLE)


def corners_text(table: TableData) -> str:
    """Return the corners of the zone: "front + 1, left; front + 5, left + 1"."""
    shape = shape_of(table)
    corners = table.get("zone", {}).get(shape, ()) if shape in CORNERS else ()
    return "; ".join(f"{_shown(x)}, {_shown(y)}" for x, y in corners)


def set_corners(table: TableData, text: str) -> None:
    """Read the corners of the zone; `InputError` where a corner has not x and y."""
    corners = []
    for part in text.split(";"):
        if not part.strip():
            continue
        places = part.split(",")
        if len(places) != 2:
            raise pe.InputError("zone", "corners", "x, y; x, y", repr(part.strip()))
        corners.append([place_of(each) for each in places])
    table.setdefault("zone", {})[shape_of(table)] = corners


def eyes_text(table: TableData) -> str:
    """Return x of the driver's eyes; empty where it is not known."""
    eyes = table.get("zone", {}).get("eyes")
    return "" if eyes is None else f"{eyes:g}"


def set_eyes(table: TableData, text: str) -> None:
    """Set x of the driver's eyes; an empty text removes it."""
    zone = table.setdefault("zone", {})
    zone.pop("eyes", None)
    if text.strip():
        zone["eyes"] = place_of(text)


# --- bodies -------------------------------------------------------------------------------------


def asked_for(table: TableData) -> str:
    """Return whether test bodies or blind ground are asked for."""
    criterion = table.get("criterion", {})
    return GROUND_ASKED if {"blind_m2", "blind_out"} & criterion.keys() else BODIES_ASKED


def ask_for(table: TableData, what: str) -> None:
    """Ask for test bodies, or for blind ground; keys of the other go."""
    if what == asked_for(table):
        return
    criterion = table.setdefault("criterion", {})
    for key in OF_GROUND if what == BODIES_ASKED else NOT_OF_GROUND:
        criterion.pop(key, None)
    if what == GROUND_ASKED:
        criterion["blind_m2"] = USUAL_BLIND_M2
        for key in ("body", "headings"):
            table.pop(key, None)
    else:
        table["body"] = [USUAL_BODIES[0]]


def body_choice(table: TableData) -> str:
    """Return the name of the one body, "several" or "own"."""
    names = _bodies(table)
    if len(names) > 1 and all(isinstance(each, str) for each in names):
        return SEVERAL
    is_one = len(names) == 1 and isinstance(names[0], str) and names[0] in requirements.BODIES
    return names[0] if is_one else OWN


def choose_body(table: TableData, name: str) -> None:
    """Set the one body; several, or an own one, begin with usual ones."""
    if name == body_choice(table):
        return
    table.pop("headings", None)
    if name == SEVERAL:
        table["body"] = list(USUAL_BODIES)
    else:
        own = {"name": OWN, "size": list(USUAL_SIZE), "class": "pedestrian"}
        table["body"] = [own if name == OWN else name]


def bodies_text(table: TableData) -> str:
    """Return the names of the bodies: "child, adult"."""
    return ", ".join(each if isinstance(each, str) else each["name"] for each in _bodies(table))


def set_bodies(table: TableData, text: str) -> None:
    """Set bodies by their names; the engine says which names there are."""
    table["body"] = [each.strip() for each in text.split(",") if each.strip()]


def headings_text(table: TableData) -> str:
    """Return the headings [deg]; empty where bodies stand at their own."""
    return ", ".join(f"{angle:g}" for angle in table.get("headings", ()))


def set_headings(table: TableData, text: str) -> None:
    """Set the headings [deg]; an empty text stands for those of the bodies."""
    table.pop("headings", None)
    if text.strip():
        table["headings"] = [place_of(each) for each in text.split(",")]


def own_size(table: TableData) -> tuple[float, float, float]:
    """Return length, width and height of the own body [m]."""
    own = _own(table)
    if "diameter" in own:
        return own["diameter"], own["diameter"], own["height"]
    length, width, height = own.get("size", USUAL_SIZE)
    return length, width, height


def set_own_size(table: TableData, size: tuple[float, ...]) -> None:
    """Set the size of the own body; a round one is as wide as long."""
    own = _own(table)
    length, width, height = (round(value, 6) for value in size)
    if "diameter" in own:
        wider = width if length == own["diameter"] else length
        own["diameter"], own["height"] = wider, height
    else:
        own["size"] = [length, width, height]


def own_is_round(table: TableData) -> bool:
    """Whether the own body is a cylinder."""
    return "diameter" in _own(table)


def set_own_round(table: TableData, is_round: bool) -> None:
    """Make the own body a cylinder, or a box."""
    own, (length, width, height) = _own(table), own_size(table)
    for key in ("diameter", "height", "size"):
        own.pop(key, None)
    own |= {"diameter": length, "height": height} if is_round else {"size": [length, width, height]}


def mesh_file(table: TableData) -> str:
    """Return the mesh file of the own body; empty where the body is a box or a cylinder."""
    return str(_own(table).get("mesh", ""))


def set_mesh_file(table: TableData, file: str) -> None:
    """Make the own body that of a mesh file; an empty text makes it a box of the usual size."""
    own = _own(table)
    for key in SIZE_KEYS if file else MESH_KEYS:
        own.pop(key, None)
    if file:
        own["mesh"] = file
    else:
        own.setdefault("size", list(USUAL_SIZE))


def own_text(key: str, usual: str) -> tuple[Getter, Setter]:
    """Return how a text of the own body is read and set; the usual text removes the key."""

    def put(table: TableData, text: str) -> None:
        own = _own(table)
        own.pop(key, None)
        if text.strip() != usual:
            own[key] = text.strip()

    return (lambda table: str(_own(table).get(key, usual))), put


def own_number(key: str, usual: float) -> tuple[Getter, Setter]:
    """Return how a number of the own body is read and set."""

    def put(table: TableData, value: float) -> None:
        _own(table)[key] = round(value, 6)

    return (lambda table: float(_own(table).get(key, usual))), put


def _bodies(table: TableData) -> list[Any]:
    value = table.get("body", [])
    return value if isinstance(value, list) else [value]


def _own(table: TableData) -> TableData:
    """Return the table of the one own body; an empty one where there is none."""
    bodies = _bodies(table)
    return bodies[0] if len(bodies) == 1 and isinstance(bodies[0], dict) else {}


def _corners(table: TableData) -> list[list[Any]]:
    """Return the corners of the zone, of a rectangle too; none of a ring."""
    zone, shape = table.get("zone", {}), shape_of(table)
    if shape == AREA and zone.get("x") and zone.get("y"):
        return _rectangle(zone["x"], zone["y"])
    return [list(corner) for corner in zone.get(shape, ())] if shape in CORNERS else []


def _rectangle(x: list[Any], y: list[Any]) -> list[list[Any]]:
    return [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]


def _is_rectangle(corners: list[list[Any]]) -> bool:
    (x0, y0), _, (x1, y1), _ = corners
    return corners == _rectangle([x0, x1], [y0, y1])


def _shown(place: Any) -> str:
    return place if isinstance(place, str) else f"{place:g}"
