"""What a format cannot hold of a rig is said in one line; what it holds comes back."""

import math

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.exchange import RIG_FORMATS, rig_files

AXLE = pe.Reference(-1.31, 0.33)
CURVE = pe.ApCurve(0.2, 0.1)
NEAR = pe.Camera("near", 640, 480, math.radians(70.0), min_range=0.3, max_range=40.0)
BEAMS = pe.Lidar("own", np.radians([-20, -10, 0]), 36, 80.0, min_range=0.5)
RIG = pe.Rig(
    [
        pe.Sensor("roof", BEAMS, pe.Pose((0.0, 0.0, 1.8)), fusion="top"),
        pe.Sensor("puck", pe.catalog.load("Velodyne VLP-16 Puck"), pe.Pose((1.0, 0.0, 1.0))),
        pe.Sensor("eye", NEAR, pe.Pose((1.5, 0.1, 1.3)), curve=CURVE),
    ]
)
RANGES = "minimum range of eye; maximum range of eye"
NOTHING_BUT_POSES = f"beams of roof, puck; {RANGES}; fusion group of roof; AP curve of eye"
EVERY_BEAM = (
    "minimum range of roof, eye; maximum range of eye; fusion group of roof; AP curve of eye"
)
LOST = {
    "csv": "beams of roof; AP curve of eye",
    "urdf": "AP curve of eye",
    "carla": EVERY_BEAM,
    "osi": EVERY_BEAM,
    "driveworks": f"beams of roof; {RANGES}; fusion group of roof; AP curve of eye",
    "kitti": f"beams of roof; {RANGES}; fusion group of roof; AP curve of eye",
}


def test_what_a_format_cannot_hold_is_one_line():
    pytest.importorskip("pyarrow", reason="of the extra argoverse")
    for name, row in RIG_FORMATS.items():
        rig = pe.Rig([s for s in RIG if s.name != "puck"]) if name == "kitti" else RIG
        _, lines = rig_files(rig, name, AXLE)
        told = [each for each in lines if each.startswith("left out of ")]
        assert told == [f"left out of {row.title}: {LOST.get(name, NOTHING_BUT_POSES)}"]


@pytest.mark.parametrize("name", ["csv", "urdf"])
def test_ranges_and_fusion_groups_come_back(name, tmp_path):
    (path,), _ = pt.export_rig(RIG, name, tmp_path / RIG_FORMATS[name].files[0])
    found = pt.import_rig(path).rig
    assert (found["eye"].model.min_range, found["eye"].model.max_range) == (0.3, 40.0)
    assert (found["roof"].fusion, found["eye"].fusion) == ("top", None)
    assert found["puck"].model.max_range == RIG["puck"].model.max_range
    if name == "urdf":
        assert (found["roof"].model.min_range, found["roof"].model.max_range) == (0.5, 80.0)


def test_gazebo_s_clip_is_the_camera_s_ranges_and_a_foreign_clip_is_not():
    """Every URDF has a clip of some size, to draw with; a sensor's range is another thing."""
    files, _ = rig_files(RIG, "urdf")
    text = files["rig.urdf"].decode()
    assert "<near>0.3</near>" in text and "<far>40.0</far>" in text
    plain = pe.Rig([pe.Sensor("eye", pe.catalog.load("KITTI cam2"), pe.Pose((1.0, 0.0, 1.5)))])
    assert "<clip>" not in rig_files(plain, "urdf")[0]["rig.urdf"].decode()
