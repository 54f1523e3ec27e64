"""Names and defaults of NVIDIA's sensor schemas for OpenUSD, and of this project's attributes."""

from pe_core.sensors.camera import BrownConrady, KannalaBrandt, Lens

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
