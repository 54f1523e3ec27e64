"""Channel angles from files: every layout, the sign of its azimuth, and one line for what is wrong.

Directions are checked as a hand would: at azimuth step 0 a counter-clockwise offset points left, to
positive y.
"""

import json
import math

import numpy as np
import pytest

from pe_core import catalog
from pe_tools.formats.angles import read_angles
from tests.engine.refusals import wrongly_refused

HESAI = "Laser id,Elevation,Azimuth\n1,14.985,0.186\n2,13.283,0.185\n3,-1.5,-3.13\n"
HESAI_DEG = [(14.985, -0.186), (13.283, -0.185), (-1.5, 3.13)]
PLAIN = [(-15.0, 1.5), (0.0, 0.0), (2.25, -3.0)]
COLUMNS = [
    "elevation,azimuth_offset\n-15,1.5\n0,0\n2.25,-3\n",
    "Vertical (deg)\tHorizontal [deg]\n-15\t1.5\n0\t0\n2.25\t-3\n",
    "Vertical angle,note,Azimuth offset [°]\n-15,low,1.5\n0,,0\n2.25,,-3,\n",
    "-15 1.5\n 0   0\n+2.25 -3.0e0\n",
    "# a comment\r\n\r\n-15, 1.5  # lowest\r\n   \r0,0\n2.25,-3.\r",
    "\ufeffelevation,azimuth\n-15,1.5\n0,-0.0\n2.25,-3\n",
    "ring elevation azimuth_deg\n1 -15 1.5\n3 2.25 -3\n2 0 0\n",
    "sep=;\nelevation;azimuth_offset\n-15;1.5\n0;0\n2.25;-3\n".encode("utf-16"),
]
HESAI_FILES = [
    HESAI.replace("\n", "\r\n"),
    "EEFF,1,1\n" + HESAI,
    "eeff,1,1\n" + HESAI + "ab" * 32 + ",,\n",
    HESAI + "0" * 64,
    "Channel,Elevation,Azimuth,Distance\n3,-1.5,-3.13,0\n1,14.985,0.186,0\n2,13.283,0.185,0",
]
MAKERS = {
    "Hesai Pandar64": (14.882, 1.042),
    "Ouster OS0-128 nominal": (46.2, -11.15),
    "RoboSense RS-LiDAR-32": (15.0167, 6.9439),
    "Velodyne HDL-64E (UTexas unit)": (2.021, 2.0),
}
"""Angles [deg] of one channel of a preset, counter-clockwise, by the formula of its driver.
Hesai, pandarGeneral_internal.cc: offset -1.042, x = d sin(azimuth), y = d cos(azimuth), clockwise.
Ouster, xyzlut.cpp: beam_azimuth_angles 11.15, encoder (counter-clockwise) - beam azimuth.
RoboSense, rawdata.cc: horizontal angle -6.9439 is added, y = -d sin(azimuth), clockwise.
Velodyne, rawdata.cc: rot_correction 0.0349066 rad is subtracted from a clockwise azimuth."""
ANGLES = {
    "beam_altitude_angles": [46.2, 45.12, 44.36],
    "beam_azimuth_angles": [11.15, 3.677, -3.639],
}
OUSTER = json.dumps({"lidar_mode": "1024x10", **ANGLES})
OUSTER_2 = json.dumps({"beam_intrinsics": ANGLES, "sensor_info": {"prod_line": "OS-0-128"}})
VELODYNE = """\
lasers:
- {dist_correction: 0.1, laser_id: 1, rot_correction: -0.0698131695389748, vert_correction: -0.1249}
- dist_correction: 0.28
  laser_id: 0
  rot_correction: 0.0349065847694874
  vert_correction: 0.0352698266506195
num_lasers: 2
"""
BAD = [
    ("file", ""),
    ("file", "elevation,azimuth\n"),
    ("file", "sep=;\n"),
    ("line 1", "hello\n"),
    ("line 1", "azimuth\n1\n"),
    ("line 1", "elevation,vertical\n1,2\n"),
    ("line 1", "elevation,azimut\n1,2\n"),
    ("line 1", "elevation_rad\n1\n"),
    ("line 1", "1,2,3\n"),
    ("line 3", "1\n\n1 2\n"),
    ("line 2", "elevation\n1 5\n"),
    ("line 3", "1\n# c\ntwo\n"),
    ("line 2", "elevation;azimuth\n1,5;2\n"),
    ("line 2", "1\n1_0\n"),
    ("line 1", "nan\n"),
    ("line 2", "0\n-90.5\n"),
    ("line 1", "0 180.5\n"),
    ("line 3", "id elevation\n1 0\n1 2\n"),
    ("channel 1", "id elevation\n0 0\n2 1\n"),
    ("line 5", HESAI + "2,1,1\n"),
    ("channel 4", HESAI + "5,1,1\n"),
    ("line 2", HESAI.replace("\n1,", "\n0,")),
    ("line 3", HESAI.replace("13.283", "91")),
    ("line 4", HESAI.replace("\n3,", "\nbeef,")),
    ("file", "Laser id,Elevation,Azimuth\n" + "a" * 64),
    ("file", "{"),
    ("beam_altitude_angles", "{}"),
    ("beam_azimuth_angles", OUSTER.replace(", -3.639", "")),
    ("beam_azimuth_angles", OUSTER.replace("-3.639", '"x"')),
    ("beam_altitude_angles[2]", OUSTER.replace("44.36", "91")),
    ("beam_intrinsics.beam_altitude_angles", OUSTER_2.replace("[46.2, 45.12, 44.36]", "[]")),
    ("lasers", "lasers: []\n"),
    ("lasers[0].laser_id", VELODYNE.replace("laser_id: 1", "laser_id: -1")),
    ("lasers[1].vert_correction", VELODYNE.replace("vert_correction: 0.03", "vert: 0.03")),
    ("lasers[1]", VELODYNE.replace("laser_id: 0", "laser_id: 1")),
    ("channel 0", VELODYNE.replace("laser_id: 0", "laser_id: 2")),
]


@pytest.fixture
def write(tmp_path):
    def to_file(text, name="angles.txt"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return to_file


def degrees(path):
    return [(c.elevation_deg, c.azimuth_offset_deg) for c in read_angles(path)]


def test_columns_are_elevation_and_counter_clockwise_offset(write):
    assert [text for text in COLUMNS if degrees(write(text)) != PLAIN] == []


def test_hesai_offsets_are_clockwise_and_are_turned(write):
    assert [text for text in (HESAI, *HESAI_FILES) if degrees(write(text)) != HESAI_DEG] == []


def test_hesai_and_the_catalogue_agree_on_the_sign(write):
    """The OT128's first two lines in its maker's file are those of HESAI."""
    ours = catalog.load("Hesai OT128 (Pandar128E4X)")
    read = degrees(write(HESAI))[:2]
    assert np.degrees(ours.elevations[:2]) == pytest.approx([e for e, _ in read])
    assert np.degrees(ours.azimuth_offsets[:2]) == pytest.approx([a for _, a in read])


def test_each_maker_s_azimuths_have_the_sign_of_its_driver():
    for name, (elevation, offset) in MAKERS.items():
        lidar = catalog.load(name)
        row = np.argmin(np.abs(np.degrees(lidar.elevations) - elevation))
        assert np.degrees(lidar.elevations[row]) == pytest.approx(elevation, abs=1e-6), name
        assert np.degrees(lidar.azimuth_offsets[row]) == pytest.approx(offset, abs=1e-6), name
    makers = {catalog.entries()[name].maker for name in MAKERS}
    with_offsets = {
        entry.maker for entry in catalog.entries().values() if "azimuth_offsets_deg" in entry.table
    }
    assert with_offsets == makers


def test_ouster_s_metadata_has_the_beams_of_the_preset(write):
    ours = catalog.load("Ouster OS0-128 nominal")
    for text in (OUSTER, OUSTER_2):
        read = degrees(write(text))
        assert np.degrees(ours.elevations[:3]) == pytest.approx([e for e, _ in read])
        assert np.degrees(ours.azimuth_offsets[:3]) == pytest.approx([a for _, a in read])


def test_velodyne_s_calibration_has_the_beams_of_the_preset(write):
    """Laser 0 is laser 29 of the driver's 64e_utexas.yaml, the first of the preset."""
    ours = catalog.load("Velodyne HDL-64E (UTexas unit)")
    read = degrees(write(VELODYNE))
    first = np.degrees([ours.elevations[0], ours.azimuth_offsets[0]])
    assert read[0] == pytest.approx(first, abs=1e-3)
    assert read[1] == pytest.approx((math.degrees(-0.1249), -4.0), abs=1e-5)


def test_bad_files_are_refused_by_their_line(write):
    assert wrongly_refused(lambda text: read_angles(write(text)), BAD) == []
