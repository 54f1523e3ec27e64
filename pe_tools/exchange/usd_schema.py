"""Names and defaults of NVIDIA's sensor schemas for OpenUSD, and of this project's attributes."""

from collections.abc import Mapping
from typing import Any

from pe_core.base.values import degrees_in_file
from pe_core.sensors.camera import BrownConrady, KannalaBrandt, Lens
from pe_core.sensors.radar import Radar

FILE = "rig.usda"
VEHICLE_FILE = "vehicle.usda"
OURS = "perceptionEntropy:"
CORE = "omni:sensor:Core:"
STATES = f"{CORE}emitterState:"
SCANS = "omni:sensor:WpmDmat:scan:"
ACOUSTIC = "omni:sensor:WpmAcoustic:"
MARKET_NAME = "omni:sensor:marketName"
LENS_MODEL = "omni:lensdistortion:model"
LENSES: dict[str, tuple[type[Lens], str]] = {
    "opencvPinhole": (BrownConrady, "OmniLensDistortionOpenCvPinholeAPI"),
    "opencvFisheye": (KannalaBrandt, "OmniLensDistortionOpenCvFisheyeAPI"),
}
"""Lens and API schema by the token of `LENS_MODEL`."""
USUAL_SIZE = (1920, 1080)
SCAN_RATE_HZ = 10.0
NEAR_M = 0.3
DEFAULT_RANGE_M = 200.0
"""Defaults of the LiDAR's schema: full scans a second, nearest and farthest range."""
ALIKE_RAD = 1e-6  # Single precision rounds 180 degrees by 1.3e-7 rad
FOCAL_LENGTH = 50.0
APERTURE = (20.955, 15.2908)
"""Defaults of a Camera: focal length, and width and height of the aperture."""
SQUARE_WITHIN = 1e-3
FULL_DEG = 360.0

RadarScan = tuple[str, float, float, float, Mapping[str, float]]
"""Name, range [m], half azimuth and half elevation [deg], and resolutions, of a scan."""
RESOLUTIONS = {
    "rangeResM": "range_resolution",
    "boreAzResDeg": "azimuth_resolution",
    "boreElResDeg": "elevation_resolution",
}
"""Fields of a radar's mode by the attribute of a scan."""


def scans_of(model: Radar) -> list[RadarScan]:
    """Return the scans of a radar's modes, whose fields the schema has symmetric."""
    rows: list[RadarScan] = []
    for number, mode in enumerate(model.modes, 1):
        across, up = (
            degrees_in_file(max(abs(float(ends[0])), abs(float(ends[-1]))))
            for ends in (mode.azimuths, mode.elevations)
        )
        fine = {}
        for key, name in RESOLUTIONS.items():
            value = getattr(mode, name)
            if value is not None:
                fine[key] = value if key.endswith("M") else degrees_in_file(value)
        rows.append((f"s{number:03d}", float(mode.max_range or 0.0), across, up, fine))
    return rows


def spans_of(model: Any) -> tuple[float, float]:
    """Return the spans of azimuth and elevation [deg] of an ultrasonic sensor."""
    (left, right), (low, high) = model.window
    return degrees_in_file(right - left), degrees_in_file(high - low)
