"""Build the city bus, 12 m long with two doors: `python make_city_bus.py --out PATH` with the bpy
module. Deterministic. The bus is no product: its lengths are this file's own."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import blend_file  # noqa: E402
from bus_parts import WHEEL  # noqa: E402
from parts import Part, join  # noqa: E402
from upright import Level, Panel, Place, body, box, within  # noqa: E402
from wheels import four_wheels, places, scaled  # noqa: E402

LENGTH = 12.0
WIDTH = 2.55
HEIGHT = 3.20
AXLES = {"front": 3.3, "rear": -2.6}
WHEEL_RADIUS = 0.48
TRACK = 2.27
ARCH = 0.56
"""Half the length of the dark field behind a wheel."""
SIDE_WINDOWS = (
    (-5.50, -4.06), (-3.98, -2.54), (-2.46, -1.04), (-0.96, 0.16), (0.24, 1.56), (1.64, 2.90),
    (2.98, 4.06), (4.14, 5.40),
)  # fmt: skip
DOORS = ((0.24, 1.56), (4.14, 5.40))
WINDOW_Z = (1.15, 2.45)
SCREEN_Z = (1.15, 2.75)
TAIL_Z = (1.50, 2.45)
DOOR_Z = (0.42, 2.45)
ARCH_Z = 1.02
LAMP_Z = (0.75, 0.92)
SKIRT_Z = 0.42
SCREEN_Y = 1.10
TAIL_Y = 0.85
LAMP_Y = (0.70, 1.10)
ACROSS = (-0.80, -0.70, 0.70, 0.80)
LEVELS = [
    Level(0.30, -5.92, 5.90, 1.235, 0.22), Level(0.42, -6.00, 5.99, 1.275, 0.25),
    Level(0.75, -6.00, 6.00, 1.275, 0.25), Level(0.92, -6.00, 6.00, 1.275, 0.25),
    Level(1.02, -6.00, 6.00, 1.275, 0.25), Level(1.15, -6.00, 6.00, 1.275, 0.25),
    Level(1.50, -6.00, 5.98, 1.272, 0.25), Level(2.45, -5.98, 5.92, 1.260, 0.25),
    Level(2.75, -5.96, 5.90, 1.250, 0.25), Level(2.92, -5.90, 5.82, 1.200, 0.25),
    Level(3.00, -5.80, 5.70, 1.080, 0.25),
]  # fmt: skip


def panel(place: Place) -> Panel:
    """Return which part a face of the wall belongs to."""
    kind = {"front": _front, "rear": _rear}.get(place.wall, _side)(place)
    return kind or ("body", "accent" if place.z < SKIRT_Z else "paint")


def _front(place: Place) -> Panel | None:
    if within(place.z, SCREEN_Z) and abs(place.y) < SCREEN_Y:
        return "windshield", "glass"
    if within(place.z, LAMP_Z) and within(abs(place.y), LAMP_Y):
        return "headlights", "headlight"
    return ("body", "trim") if within(place.z, SCREEN_Z) else None


def _rear(place: Place) -> Panel | None:
    if within(place.z, TAIL_Z) and abs(place.y) < TAIL_Y:
        return "rear_window", "glass"
    lamp = within(place.z, LAMP_Z) and within(abs(place.y), LAMP_Y)
    return ("taillights", "taillight") if lamp else None


def _side(place: Place) -> Panel | None:
    if place.wall == "corner":
        return ("body", "trim") if place.x > 0 and within(place.z, SCREEN_Z) else None
    if place.z < ARCH_Z and any(abs(place.x - x) < ARCH for x in AXLES.values()):
        return "body", "trim"
    on_door = place.wall == "right" and any(within(place.x, door) for door in DOORS)
    if on_door and within(place.z, DOOR_Z):
        return ("door_windows", "glass") if place.z > LAMP_Z[0] else ("doors", "trim")
    if not within(place.z, WINDOW_Z):
        return None
    if any(within(place.x, window) for window in SIDE_WINDOWS):
        return f"windows_{place.wall}", "glass"
    inside = SIDE_WINDOWS[0][0] < place.x < SIDE_WINDOWS[-1][1]
    return ("body", "trim") if inside else None


def vehicle() -> dict[str, Part]:
    """Return every object of the bus, wheels about their own centre."""
    arches = {x + step for x in AXLES.values() for step in (-ARCH, ARCH)}
    along = sorted(arches | {x for window in SIDE_WINDOWS for x in window})
    parts = body(LEVELS, along, list(ACROSS), panel, ("roof", "paint"), ("body", "trim"))
    parts["roof_pod"] = join(*(_pod(*ends) for ends in ((-4.6, -1.6), (0.4, 2.8))))
    for side, sign in (("left", 1), ("right", -1)):
        parts[f"mirror_{side}"] = _mirror(sign)
    return parts | four_wheels(scaled(WHEEL, WHEEL_RADIUS / 0.38), AXLES)


def _pod(rear: float, front: float) -> Part:
    sizes = ((2.97, 0.0), (3.14, 0.02), (HEIGHT, 0.12))
    levels = [Level(z, rear + cut, front - cut, 0.85 - cut, 0.15) for z, cut in sizes]
    plain = ("roof_pod", "paint")
    return body(levels, [], [], lambda _: plain, plain, plain)["roof_pod"]


def _mirror(sign: int) -> Part:
    y = sorted((sign * 1.30, sign * 1.52))
    arm = sorted((sign * 1.15, sign * 1.34))
    return join(
        box((5.98, y[0], 2.00), (6.12, y[1], 2.42), "trim"),
        box((5.88, arm[0], 2.40), (6.06, arm[1], 2.45), "trim"),
    )


def build() -> None:
    """Make the collection CityBus in an empty scene."""
    wheels = places(AXLES, TRACK, WHEEL_RADIUS)
    blend_file.build("CityBus", vehicle(), wheels, lambda points: points[:, 0], ("",))


if __name__ == "__main__":
    blend_file.main(__doc__, HERE / "city_bus.blend", build)
