"""Rig formats that perception entropy finds by entry points."""

from pe_tools.exchange import lens_pictures as lenses
from pe_tools.exchange.frames import GROUND, REAR_AXLE, REAR_AXLE_GROUND
from pe_tools.exchange.rig_formats import BEAMS, MODEL, RigFormat

from . import argoverse2, driveworks, kitti, nuscenes, osi

ARGOVERSE2 = RigFormat(
    *("argoverse2", argoverse2.TITLE, REAR_AXLE, argoverse2.FILES, argoverse2),
    keeps=lenses.straight,
    passes_through=False,
)
KITTI = RigFormat(
    *("kitti", "KITTI calibration", GROUND, (kitti.FILE,), kitti),
    keeps=lenses.straight,
    usual_size=(1242, 375),
    passes_through=False,
)
NUSCENES = RigFormat(
    *("nuscenes", "nuScenes", REAR_AXLE_GROUND, nuscenes.FILES, nuscenes),
    keeps=lenses.opencv_of_five,
    usual_size=(1600, 900),
)
OSI = RigFormat(
    *("osi", "ASAM OSI mounting positions", REAR_AXLE, (osi.FILE,), osi, frozenset({BEAMS})),
    keeps=lenses.centred,
)
DRIVEWORKS = RigFormat(
    *("driveworks", "DriveWorks rig.json", REAR_AXLE_GROUND, (driveworks.FILE,), driveworks),
    holds=frozenset({MODEL}),
    keeps=lenses.f_theta_of_five,
    source=driveworks.source,
)
