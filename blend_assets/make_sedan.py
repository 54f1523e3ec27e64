"""Build sedan.blend, the example vehicle: `python make_sedan.py` with the bpy module, or
`blender -b --python make_sedan.py`; `-- --out PATH` writes elsewhere. Deterministic."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import blend_file  # noqa: E402
import sedan_panels as panels  # noqa: E402
import sedan_parts  # noqa: E402
import sedan_profile as profile  # noqa: E402
from parts import Part, flipped, join, plate  # noqa: E402
from sedan_lines import arch  # noqa: E402
from sedan_skin import sample  # noqa: E402
from shell import half_shell  # noqa: E402
from wheels import four_wheels, places  # noqa: E402


def half_body() -> dict[str, Part]:
    """The left half of the skin as named parts."""
    skin = sample()
    panels.cut_panels(skin)
    return half_shell(skin, panels.PANELS, arch, profile.WELL_Y)


def vehicle() -> dict[str, Part]:
    """Every object of the car in car coordinates, wheels about their own centre."""
    result = {}
    for name, part in half_body().items():
        if name == "windows":
            result |= {"windows_left": part, "windows_right": flipped(part)}
        else:
            result[name] = join(part, flipped(part))
    mirror = sedan_parts.mirror()
    result |= {"mirror_left": mirror, "mirror_right": flipped(mirror)}
    result |= four_wheels(sedan_parts.WHEEL, profile.AXLES)
    result["plate_front"] = plate(profile.solid, 1.6, 0.48)
    result["plate_rear"] = plate(profile.solid, -1.6, 0.66)
    return result


def build() -> None:
    """The Sedan collection in an empty scene."""
    wheels = places(profile.AXLES, profile.TRACK, profile.WHEEL_RADIUS)
    loose = ("wheel", "mirror", "plate")
    blend_file.build("Sedan", vehicle(), wheels, profile.solid, loose)


if __name__ == "__main__":
    blend_file.main(__doc__, HERE / "sedan.blend", build)
