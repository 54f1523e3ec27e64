"""Files of the forms of other programs: their sensors stand where the form says; the page of them
is what the script writes."""

import importlib.util
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_tools.exchange.frames import composed
from tests.engine.foreign_forms import AXLE, FORMS

CHECKOUT = Path(__file__).parents[2]
ONLY_READ = ("usd", "kitti", "argoverse2")
MERGED = [f for f in FORMS if f.format not in ONLY_READ and not f.path.endswith(".sdf")]
"""Forms that an export goes into."""
AHEAD = {
    "Lidar": ((0.5, 0.0, 2.0), (1.0, 0.0, 0.0)),
    "Front": ((1.5, -0.2, 1.4), (1.0, 0.0, 0.0)),  # first about y: what is left is a roll
    "velodyne_rear": ((-1.78, 0.0, 1.6), (-math.cos(0.7), 0.0, -math.sin(0.7))),
    "C1_front60Single": ((0.42, 0.2, 1.5), (0.0, 1.0, 0.0)),
    "gpu_lidar": ((0.1, 0.05, 0.6), (0.0, 1.0, 0.0)),  # in its model, not in the world
    "front_laser_link": ((0.0, -2.3, 0.5), (0.0, -math.cos(0.05), -math.sin(0.05))),
    "hesai_left": ((-0.58, 0.55, 1.6464), (0.0, 1.0, 0.0)),  # its type says its height
    "traffic_light_camera": ((0.7, -0.2, 1.5), (0.0, -1.0, 0.0)),  # left-handed
    "CAM_FRONT": ((0.3, 0.0, 1.5), (1.0, 0.0, 0.0)),
    "ring_front_center": ((0.22, 0.0, 1.7), (1.0, 0.0, 0.0)),
    "camera_2": ((0.65, 0.15, 1.65), (1.0, 0.0, 0.0)),
    "lidar_3": ((0.72, 0.0, 1.9), (0.0, 1.0, 0.0)),
    "camera": ((-0.02, 0.05, 0.4), (1.0, 0.0, 0.0)),
    "rgb_front": (
        (1.5, 0.1, 1.7),
        (math.cos(math.radians(10.0)), 0.0, -math.sin(math.radians(10.0))),
    ),
}
"""Position [m] and viewing direction of a sensor of each form."""


@pytest.mark.parametrize("form", FORMS, ids=lambda form: f"{form.format}-{Path(form.path).name}")
def test_a_form_is_read_where_it_is(form, tmp_path):
    if form.library:
        pytest.importorskip(form.library, reason=f"of the extra for {form.format}")
    rig = form.read(tmp_path).rig
    known = [sensor for sensor in rig if sensor.name in AHEAD]
    assert len(known) == 1, [sensor.name for sensor in rig]
    position, direction = AHEAD[known[0].name]
    assert known[0].pose.position == pytest.approx(position, abs=1e-6)
    ahead = known[0].pose.ground_from_sensor[:, 0]
    assert np.abs(ahead - direction).max() < 2e-3  # yaw 3.14 is not half a turn
    assert len(form.commit) == 40


@pytest.mark.parametrize("form", MERGED, ids=lambda form: f"{form.format}-{Path(form.path).name}")
def test_a_moved_rig_goes_back_into_its_form(form, tmp_path):
    """All sensors are moved by the same step."""
    path = form.make(tmp_path)
    rig = form.read(tmp_path).rig
    step = pe.Pose.from_degrees((0.01, 0.25, -0.02), (1.0, 2.0, 3.0))
    moved = pe.Rig([each.moved(composed(each.pose, step)) for each in rig])
    pt.export_rig(moved, form.format, path, AXLE, into=path, replace=True)
    again = pt.import_rig(path, form.format, AXLE).rig
    assert [each.name for each in again] == [each.name for each in moved]
    for one, other in zip(again, moved, strict=True):
        assert one.pose.position == pytest.approx(other.pose.position, abs=2e-5)
        turn = one.pose.ground_from_sensor - other.pose.ground_from_sensor
        assert np.abs(turn).max() < 1e-5
        assert one.model.name == other.model.name


def test_another_model_than_a_kit_s_type_says_is_kept(tmp_path):
    form = next(each for each in FORMS if each.repository == "tier4/aip_launcher")
    path = form.make(tmp_path)
    rig = form.read(tmp_path).rig
    other = catalog.load("Hesai Pandar64")
    assert other.name != rig["hesai_left"].model.name
    changed = [replace(s, model=other) if s.name == "hesai_left" else s for s in rig]
    pt.export_rig(pe.Rig(changed), form.format, path, AXLE, into=path, replace=True)
    again = pt.import_rig(path, form.format, AXLE).rig
    assert again["hesai_left"].model.name == other.name
    assert again["hesai_front_left"].model.name == rig["hesai_front_left"].model.name


def test_the_page_is_what_the_script_writes():
    spec = importlib.util.spec_from_file_location("page", CHECKOUT / "tools" / "foreign_files.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    head, *rows = script.PAGE.read_text("utf-8").split("\n| [")
    assert head.startswith(f"{script.TITLE}\n\n{script.ABOUT}")
    assert len(rows) == len(FORMS)
    for form, written in zip(FORMS, rows, strict=True):
        if form.can_be_read:
            row = script.row(form).removeprefix("| [")
            assert written.strip() == row, "run python tools/foreign_files.py"
