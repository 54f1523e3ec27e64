"""Kinds of sensors, one folder for each: intrinsics, the definition of m, and fast kernels."""

from .camera import CAMERA, BrownConrady, Camera, FTheta, KannalaBrandt, Lens, Pinhole
from .coincidence import coinciding
from .field_of_view import FieldPicture, ViewPatch
from .kernels import (
    GridKernel,
    GroundKernel,
    GroundView,
    Measured,
    ObjectKernel,
    ObjectView,
    Occlusion,
    SampleKernel,
    VisibleGround,
    Voxels,
)
from .kind import (
    KINDS,
    Kind,
    derived_object_curves,
    kind_named,
    kind_of,
    measure,
    measure_objects,
    register,
    unregister,
)
from .lidar import LIDAR, BeamField, Lidar, RangePicture, beam_field, range_picture
from .measurement_cache import MeasurementCache, ObjectMeasurementCache, VisibleGroundCache
from .perception import (
    BLIND_RULES,
    CURVE_MODELS,
    SCANS,
    PerceptionModel,
    curve_source,
    detectors,
    fitted_curves,
    scan_curves,
)
from .radar import RADAR, Radar, RadarMode
from .ultrasonic import ULTRASONIC, Ultrasonic
from .weather import Weather, returning, with_returns

for _kind in (LIDAR, CAMERA, RADAR, ULTRASONIC):
    register(_kind)
