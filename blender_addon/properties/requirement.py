"""A requirement as the panel edits it: views of its table, which is stored as JSON text.

What the engine declares is a field of its own. The shape of the zone and the bodies are lines with
the keys of a study file.
"""

import tomllib
from collections.abc import Callable, Sequence
from copy import deepcopy
from typing import Any

from bpy.types import Context, PropertyGroup

from .. import document, signals
from ..engine import pe, requirements, studies
from .declared import mixin, property_of
from .fields import menu, text, view
from .list_rows import Switched, Tabled

Change = Callable[[document.TableData, Any], None]
BODIES_ASKED = "bodies"
GROUND_ASKED = "ground"
ASKS = (
    (BODIES_ASKED, "Test Bodies", "A body stands at each sample of the zone, and has to be seen"),
    (GROUND_ASKED, "Blind Ground", "Blind ground in the zone is limited"),
)
SHAPES = (
    ("area", "Rectangle", "From and to along x and y"),
    ("polygon", "Polygon", "An area with three corners or more"),
    ("ring", "Ring", "All ground at a distance from the outline of the vehicle's body"),
    ("path", "Path", "A line along which a body moves"),
    ("spots", "Spots", "Single places"),
)
USUAL: dict[str, document.TableData] = {
    "area": {"x": ["front + 1", "front + 5"], "y": ["right", "left"]},
    "polygon": {"polygon": [["front + 1", "right"], ["front + 5", 0.0], ["front + 1", "left"]]},
    "ring": {"ring": [0.2, 1.0]},
    "path": {"path": [["front + 1", "right"], ["front + 1", "left"]]},
    "spots": {"spots": [["front + 1", 0.0]]},
}
"""With what a shape begins."""
SHAPE_KEYS = ("x", "y", "polygon", "ring", "path", "spots")
USUAL_BODY = "adult"
USUAL_BLIND_M2 = 0.5
NOT_OF_GROUND = ("sensors", "kinds", "of", "points", "pixels", "share", "ap")
OF_GROUND = ("blind_m2", "max_blind_distance", "blind_height")
ZERO_COUNTS = ("blind_m2",)
"""Settings that are asked for at 0, too."""
SECTIONS = {
    "zone": requirements.Zone,
    "criterion": requirements.Criterion,
    "robust_to": requirements.RobustTo,
}


def _view(
    get: Callable[[document.TableData], Any], put: Change, items: Sequence[tuple[Any, ...]] = ()
) -> dict[str, Any]:
    """Return the callbacks of a property: read from a row's full table, and changed in it."""

    def write(row: PropertyGroup, value: Any) -> None:
        document.edit_row(row, lambda table: put(table, value))
        signals.study_changed.emit()

    return view(lambda row: get(document.full_table(row)), write, items)


def _choice(
    items: tuple[tuple[str, str, str], ...], get: Callable[..., str], put: Change
) -> dict[str, Any]:
    """Return items and callbacks of a menu."""
    return {"items": items, **_view(get, put, items)}


def _declared() -> Any:
    """Return a mixin with views of all that is declared for a zone, a criterion and conditions."""
    return mixin(
        "Requirement",
        {
            setting.panel.property: property_of(setting, **_declared_view(section, setting))
            for section, cls in SECTIONS.items()
            for setting in studies.settings_of(cls).values()
            if setting.panel is not None
        },
    )


def _declared_view(section: str, setting: studies.Setting) -> dict[str, Any]:
    """Return the callbacks of a declared setting; its default removes the key."""
    name = setting.name
    default = document.in_file(setting)

    def get(table: document.TableData) -> Any:
        value = table.get(section, {}).get(name, default)
        return document.property_value(setting, value)

    def put(table: document.TableData, value: Any) -> None:
        found = document.value_of_property(setting, value)
        own = table.setdefault(section, {})
        own.pop(name, None)
        if name in ZERO_COUNTS or found != default:
            own[name] = value if found is None else found

    is_menu = isinstance(setting.rule, studies.OneOf)
    own = _choice(studies.menu_of(setting), get, put) if is_menu else _view(get, put)
    return own | {"default": None, "update": None}  # its default is in the table


def asked_for(table: document.TableData) -> str:
    """Return whether test bodies or blind ground are asked for."""
    criterion = table.get("criterion", {})
    return GROUND_ASKED if {"blind_m2", "max_blind_distance"} & criterion.keys() else BODIES_ASKED


def ask_for(table: document.TableData, what: str) -> None:
    """Ask for test bodies, or for blind ground; keys of the other go."""
    if what == asked_for(table):
        return
    criterion = table.setdefault("criterion", {})
    for key in OF_GROUND if what == BODIES_ASKED else NOT_OF_GROUND:
        criterion.pop(key, None)
    if what == GROUND_ASKED:
        criterion["blind_m2"] = USUAL_BLIND_M2
        table.pop("body", None)
    else:
        table["body"] = [USUAL_BODY]


def shape_of(table: document.TableData) -> str:
    """Return the shape of the zone."""
    return next((shape for shape in USUAL if table.get("zone", {}).get(shape)), "area")


def reshape(table: document.TableData, shape: str) -> None:
    """Give the zone another shape, as it usually begins."""
    if shape != shape_of(table):
        _set_shape(table, deepcopy(USUAL[shape]))


def _set_shape(table: document.TableData, keys: document.TableData) -> None:
    zone = table.setdefault("zone", {})
    for key in SHAPE_KEYS:
        zone.pop(key, None)
    zone |= keys


def _zone_line(table: document.TableData) -> str:
    zone = table.get("zone", {})
    return document.line_of({key: zone[key] for key in SHAPE_KEYS if zone.get(key)})


def _set_zone(table: document.TableData, line: str) -> None:
    _set_shape(table, document.read_line(line, "x"))


def _bodies_line(table: document.TableData) -> str:
    bodies = table.get("body", [])
    tables = [each for each in bodies if not isinstance(each, str)]
    if len(tables) == len(bodies) == 1:
        return document.line_of(tables[0])
    if not tables:
        return ", ".join(map(str, bodies))
    return ", ".join(
        f"{{ {document.line_of(each)} }}" if each in tables else f'"{each}"' for each in bodies
    )


def _set_bodies(table: document.TableData, line: str) -> None:
    """Set names of bodies, the keys of an own body, or several of both."""
    if "=" not in line:
        table["body"] = [each.strip() for each in line.split(",") if each.strip()]
        return
    try:
        several = line if line.lstrip().startswith("{") else f"{{ {line} }}"
        table["body"] = tomllib.loads(f"line = [{several}]")["line"]
    except tomllib.TOMLDecodeError as error:
        raise pe.InputError("scene", "bodies", "names, or keys of a body", str(error)) from None


def known_bodies(_row: PropertyGroup, _context: Context, _typed: str) -> list[tuple[str, str]]:
    """Return the names of test bodies, each with its source."""
    return [(name, body.source) for name, body in requirements.BODIES.items()]


Declared: Any = _declared()


class PE_Requirement(Declared, Switched, Tabled, PropertyGroup):
    """A requirement, and its last verdict."""

    problem: text("Problem", "Why a change was not made")
    asks: menu("Asks For", "What is asked for in the zone", **_choice(ASKS, asked_for, ask_for))
    bodies: text(
        "Bodies",
        "Names of test bodies: child, adult. Or an own one, with the keys of a study: "
        'size = [0.5, 0.5, 1.5], class = "pedestrian", headings = [0, 90]',
        search=known_bodies,
        search_options={"SUGGESTION"},
        **_view(_bodies_line, _set_bodies),
    )
    shape: menu("Zone", "Shape of the zone", **_choice(SHAPES, shape_of, reshape))
    zone: text(
        "Places",
        "Keys of the shape, as a study has them. Places are numbers [m], or planes of the vehicle "
        "with an offset outwards: front + 0.8, near, rear_axle, 25 %",
        **_view(_zone_line, _set_zone),
    )
    verdict: text("Verdict", "The last verdict as JSON, or why there is none")
