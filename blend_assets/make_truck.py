"""Build the tractor with its trailer: `python make_truck.py --out PATH` with the bpy module.

Deterministic. Parts of the tractor are named cab..., those of the trailer trailer..., and the hitch
between them is where the trailer turns. Wheelbase, hitch, trailer and width are those of a common
combination: 3.60 m, 0.30 m ahead of the rear axle, 8.20 m from the kingpin to the axles, overhangs
of 1.00 and 2.80 m, 2.50 m wide. All other lengths are this file's own.
"""

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

WHEELBASE = 3.60
HITCH_AHEAD = 0.30
KINGPIN_TO_AXLES = 8.20
TRAILER_FRONT = 1.00
TRAILER_REAR = 2.80
WIDTH = 2.50
CAB_FRONT = 1.40
CAB_LENGTH = 2.30
"""Front overhang of the tractor, and length of its cab."""
LENGTH = CAB_FRONT + WHEELBASE - HITCH_AHEAD + KINGPIN_TO_AXLES + TRAILER_REAR
FRONT = LENGTH / 2
AXLES = {"front": FRONT - CAB_FRONT, "rear": FRONT - CAB_FRONT - WHEELBASE}
HITCH_X = AXLES["rear"] + HITCH_AHEAD
"""Where the trailer turns: the kingpin, on the centre line."""
TRAILER_AXLE = HITCH_X - KINGPIN_TO_AXLES
AXLE_APART = 1.31
CAB_REAR = FRONT - CAB_LENGTH
BOX_ENDS = (HITCH_X - KINGPIN_TO_AXLES - TRAILER_REAR, HITCH_X + TRAILER_FRONT)
BOX_Z = (1.15, 3.95)
WHEEL_RADIUS = 0.50
TRACK = 2.20
SCREEN_Z = (1.75, 2.70)
SIDE_Z = (1.75, 2.55)
LAMP_Z = (0.80, 1.02)
SCREEN_Y = 0.95
SIDE_X = (FRONT - 1.45, FRONT - 0.45)
ARCH = 0.62


def cab_levels() -> list[Level]:
    """Return the outline of the cab at each height."""
    shape = ((0.40, 0.06, 1.20), (0.55, 0.0, 1.25), (0.80, 0.0, 1.25), (1.02, 0.0, 1.25),
             (1.15, 0.0, 1.25), (1.75, 0.02, 1.25), (2.55, 0.14, 1.235), (2.70, 0.18, 1.23),
             (3.00, 0.28, 1.22), (3.45, 0.75, 1.15), (3.55, 1.00, 1.05))  # fmt: skip
    return [Level(z, CAB_REAR, FRONT - lean, half, 0.18) for z, lean, half in shape]


def panel(place: Place) -> Panel:
    """Return which part of the cab a face of its wall belongs to."""
    if place.wall == "front" and abs(place.y) < SCREEN_Y and within(place.z, SCREEN_Z):
        return "cab_windshield", "glass"
    if place.wall == "front" and within(place.z, LAMP_Z) and abs(place.y) > 0.6:
        return "cab_headlights", "headlight"
    if place.wall == "front" and within(place.z, (1.02, 1.75)) and abs(place.y) < SCREEN_Y:
        return "cab", "accent"
    in_side = place.wall in ("left", "right") and within(place.x, SIDE_X)
    if in_side and within(place.z, SIDE_Z):
        return f"cab_windows_{place.wall}", "glass"
    dark = place.z < 0.80 or (place.z < 1.15 and abs(place.x - AXLES["front"]) < ARCH)
    return "cab", "trim" if dark and place.wall != "rear" else "paint"


def cab() -> dict[str, Part]:
    """Return the parts of the tractor without its wheels."""
    arch = (AXLES["front"] - ARCH, AXLES["front"] + ARCH)
    along = sorted({x for x in (*SIDE_X, *arch) if CAB_REAR + 0.2 < x < FRONT - 1.2})
    parts = body(cab_levels(), along, [-SCREEN_Y + 0.1, -0.6, 0.6, SCREEN_Y - 0.1], panel,
                 ("cab", "paint"), ("cab", "trim"))  # fmt: skip
    frame = box((AXLES["rear"] - 0.85, -0.42, 0.70), (CAB_REAR + 0.1, 0.42, 0.98), "trim")
    tanks = [box((CAB_REAR - 1.45, low, 0.42), (CAB_REAR - 0.10, high, 0.95), "rim")
             for low, high in ((-1.18, -0.55), (0.55, 1.18))]  # fmt: skip
    parts["chassis"] = join(frame, *tanks)
    parts["hitch"] = box((HITCH_X - 0.45, -0.45, 0.98), (HITCH_X + 0.45, 0.45, BOX_Z[0]), "trim")
    for side, sign in (("left", 1), ("right", -1)):
        y = sorted((sign * 1.32, sign * 1.54))
        arm = sorted((sign * 1.15, sign * 1.34))
        parts[f"mirror_{side}"] = join(
            box((FRONT - 0.32, y[0], 1.85), (FRONT - 0.16, y[1], 2.65), "trim"),
            box((FRONT - 0.40, arm[0], 2.55), (FRONT - 0.26, arm[1], 2.60), "trim"),
        )
    return parts


def trailer() -> dict[str, Part]:
    """Return the parts of the trailer without its wheels."""
    low, high = BOX_Z
    levels = [Level(z, *BOX_ENDS, WIDTH / 2, 0.05) for z in (low, 1.28, high - 0.08, high)]
    parts = body(levels, [], [], _trailer_panel, ("trailer", "plate"), ("trailer", "trim"))
    ahead = HITCH_X - 2.2
    behind = TRAILER_AXLE + 2.1
    frame = box((BOX_ENDS[0] + 0.2, -0.5, 0.92), (ahead + 0.6, 0.5, low), "trim")
    legs = [box((ahead, y - 0.07, 0.25), (ahead + 0.14, y + 0.07, low), "rim") for y in (-0.8, 0.8)]
    parts["trailer_chassis"] = join(frame, *legs)
    guard = [box((behind, y - 0.02, z), (ahead - 0.2, y + 0.02, z + 0.16), "rim")
             for y in (-1.2, 1.2) for z in (0.50, 0.82)]  # fmt: skip
    parts["trailer_guards"] = join(*guard)
    rear = BOX_ENDS[0]
    parts["trailer_underrun"] = join(
        box((rear + 0.05, -1.2, 0.45), (rear + 0.15, 1.2, 0.60), "rim"),
        *[box((rear + 0.15, y - 0.05, 0.45), (rear + 0.3, y + 0.05, low), "trim")
          for y in (-0.6, 0.6)],
    )  # fmt: skip
    return parts


def _trailer_panel(place: Place) -> Panel:
    if place.z < 1.28:
        return "trailer", "trim"
    if place.wall == "rear":
        return "trailer_doors", "rim"
    return "trailer", "plate"


def axles() -> dict[str, float]:
    """Return the x of all axles, by the beginning of their wheels' names."""
    steps = {str(k + 1): TRAILER_AXLE + (1 - k) * AXLE_APART for k in range(3)}
    return AXLES | {f"trailer_{name}": x for name, x in steps.items()}


def named(wheels: dict) -> dict:
    """Return wheels with the trailer's named trailer_wheel_... ."""
    return {name.replace("wheel_trailer", "trailer_wheel"): what for name, what in wheels.items()}


def build() -> None:
    """Make the collection Truck in an empty scene."""
    shape = scaled(WHEEL, WHEEL_RADIUS / 0.38)
    vehicle = cab() | trailer() | named(four_wheels(shape, axles()))
    where = named(places(axles(), TRACK, WHEEL_RADIUS))
    blend_file.build("Truck", vehicle, where, lambda points: points[:, 0], ("",))


if __name__ == "__main__":
    blend_file.main(__doc__.splitlines()[0], HERE / "truck.blend", build)
