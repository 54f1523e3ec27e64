"""Build bus.blend, the example shuttle: `python make_bus.py` with the bpy module, or
`blender -b --python make_bus.py`; `-- --out PATH` writes elsewhere. Deterministic."""

from __future__ import annotations

import copy
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import blend_file  # noqa: E402
import bus_panels as panels  # noqa: E402
import bus_parts  # noqa: E402
import bus_profile as profile  # noqa: E402
from bus_lines import arch  # noqa: E402
from bus_skin import sample  # noqa: E402
from parts import Part, flipped, join, plate  # noqa: E402
from shell import half_shell  # noqa: E402
from wheels import four_wheels, places  # noqa: E402


def halves() -> tuple[dict[str, Part], dict[str, Part]]:
    """Named parts of the left and of the right half of the skin."""
    left = sample()
    panels.cut_common(left)
    right = copy.deepcopy(left)
    panels.cut_left(left)
    panels.cut_right(right)
    shells = [half_shell(skin, which, arch, profile.WELL_Y)
              for skin, which in ((left, panels.LEFT), (right, panels.RIGHT))]  # fmt: skip
    return shells[0], {name: flipped(part) for name, part in shells[1].items()}


def vehicle() -> dict[str, Part]:
    """Every object of the bus in bus coordinates, wheels about their own centre."""
    left, right = halves()
    result = {"windows_left": left.pop("windows"), "windows_right": right.pop("windows")}
    for name, part in right.items():
        result[name] = join(left[name], part) if name in left else part
    result |= four_wheels(bus_parts.WHEEL, profile.AXLES)
    result["roof_pod"] = bus_parts.pod()
    result["plate_front"] = plate(profile.solid, 2.5, 0.385)
    result["plate_rear"] = plate(profile.solid, -2.5, 0.385)
    return result


def build() -> None:
    """The Bus collection in an empty scene."""
    wheels = places(profile.AXLES, profile.TRACK, profile.WHEEL_RADIUS)
    blend_file.build("Bus", vehicle(), wheels, profile.solid, ("wheel", "roof_pod", "plate"))


if __name__ == "__main__":
    blend_file.main(__doc__, HERE / "bus.blend", build)
