"""Rig formats that perception entropy finds by entry points."""

from pe_tools.exchange import lens_pictures as lenses
from pe_tools.exchange.frames import REAR_AXLE, REAR_AXLE_GROUND
from pe_tools.exchange.rig_formats import BEAMS, MODEL, RigFormat

from . import argoverse2, driveworks, osi

ARGOVERSE2 = RigFormat(
    *("argoverse2", argoverse2.TITLE, REAR_AXLE, argoverse2.FILES, argoverse2),
    keeps=lenses.straight,
    passes_through=False,
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
