"""Layouts of data sets: KITTI's three benchmarks, nuImages' distortion of six numbers."""

import json

import numpy as np
import pytest

import pe_core as pe
from pe_tools.exchange import import_rig

P0 = "718.856 0 607.1928 0 0 718.856 185.2157 0 0 0 1 0"
P2 = "718.856 0 607.1928 45.38225 0 718.856 185.2157 -0.1130887 0 0 1 0.003779761"
TR = (
    "0.0004276802 -0.9999672 -0.008084492 -0.0119846 -0.007210627 0.008081198 -0.9999413 "
    "-0.05403985 0.9999739 0.000485949 -0.007206934 -0.2921969"
)
"""Of odometry's sequence 00: the LiDAR to the rectified first camera."""
R = "0.9999239 0.00983776 -0.007445048 -0.009869795 0.9999421 -0.004278459 0.007402527 "
R += "0.004351614 0.9999631"
TO_FIRST = (
    "0.007533745 -0.9999714 -0.000616602 -0.004069766 0.01480249 0.0007280733 -0.9998902 "
    "-0.07631618 0.9998621 0.00752379 0.01480755 -0.2717806"
)
LAYOUTS = {
    "calib.txt": f"P0: {P0}\nP2: {P2}\nTr: {TR}\n",
    "000007.txt": f"P0: {P0}\nP2: {P2}\nR0_rect: {R}\nTr_velo_to_cam: {TO_FIRST}\n\n",
    "0007.txt": f"P0: {P0}\nP2: {P2}\nR_rect {R}\nTr_velo_cam {TO_FIRST}\nTr_imu_velo {TR}\n",
}
"""As the benchmarks of odometry, objects and tracking have them."""


@pytest.mark.parametrize("name", LAYOUTS)
def test_kitti_s_layouts_are_read(name, tmp_path):
    """Camera 0 by hand: where the transform takes the LiDAR's origin to, seen from the camera."""
    (tmp_path / name).write_text(LAYOUTS[name])
    found = import_rig(tmp_path / name).rig
    assert [each.name for each in found] == ["velodyne", "camera_0", "camera_2"]
    to_first = np.array((TR if name == "calib.txt" else TO_FIRST).split(), dtype=float)
    turn = to_first.reshape(3, 4)[:, :3]
    camera = -turn.T @ to_first.reshape(3, 4)[:, 3]
    assert found["camera_0"].pose.position == pytest.approx(tuple(camera), abs=1e-6)
    axis = found["camera_0"].pose.ground_from_sensor[:, 0]
    rectified = np.eye(3) if name == "calib.txt" else np.array(R.split(), float).reshape(3, 3)
    assert axis == pytest.approx((rectified @ turn)[2], abs=1e-6)
    assert found["camera_2"].pose.position[1] == pytest.approx(camera[1] + 0.06, abs=0.01)


def test_objects_without_their_rectification_are_refused(tmp_path):
    (tmp_path / "1.txt").write_text(f"P0: {P0}\nTr_velo_to_cam: {TO_FIRST}\n")
    with pytest.raises(pe.InputError, match="R0_rect: expected 3 x 3 numbers"):
        import_rig(tmp_path / "1.txt")


def nuimages(folder, distortion):
    """A table with the camera behind; what is read of it."""
    sensor = {"token": "s", "channel": "CAM_BACK", "modality": "camera"}
    row = {
        "token": "c",
        "sensor_token": "s",
        "translation": [0.0, 0.0, 1.5],
        "rotation": [0.5, -0.5, 0.5, -0.5],
        "camera_intrinsic": [[800.0, 0, 800.0], [0, 800.0, 450.0], [0, 0, 1]],
        "camera_distortion": distortion,
    }
    (folder / "sensor.json").write_text(json.dumps([sensor]))
    (folder / "calibrated_sensor.json").write_text(json.dumps([row]))
    return import_rig(folder, None, pe.Reference(-1.4, 0.3))


def test_of_six_numbers_of_nuimages_the_last_is_left_out_and_a_seventh_is_too_many(tmp_path):
    for sixth in (0.00048, 0.0):
        found = nuimages(tmp_path, [-0.23, 0.061, 4e-4, -3e-4, -0.0085, sixth])
        lens = found.rig["CAM_BACK"].model.projection
        assert (lens.k1, lens.k2, lens.k3, lens.k4) == (-0.23, 0.061, -0.0085, 0.0)
        assert (lens.p1, lens.p2) == (4e-4, -3e-4)
        assert any("its sixth coefficient" in line for line in found.lines) == (sixth != 0.0)
    with pytest.raises(pe.InputError, match="4 to 6 numbers"):
        nuimages(tmp_path, [0.1] * 7)
