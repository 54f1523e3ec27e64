"""Files of the forms of other programs: their sensors stand where the form says; the page of them
is what the script writes."""

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest

from tests.engine.foreign_forms import FORMS

CHECKOUT = Path(__file__).parents[2]
AHEAD = {
    "Lidar": ((0.5, 0.0, 2.0), (1.0, 0.0, 0.0)),
    "Front": ((1.5, -0.2, 1.4), (1.0, 0.0, 0.0)),  # first about y: what is left is a roll
    "velodyne_rear": ((-1.78, 0.0, 1.6), (-math.cos(0.7), 0.0, -math.sin(0.7))),
    "rgb_front": (
        (1.5, 0.1, 1.7),
        (math.cos(math.radians(10.0)), 0.0, -math.sin(math.radians(10.0))),
    ),
}
"""Position [m] and viewing direction of a sensor of each form."""


@pytest.mark.parametrize("form", FORMS, ids=lambda form: Path(form.path).name)
def test_a_form_is_read_where_it_is(form, tmp_path):
    rig = form.read(tmp_path).rig
    known = [sensor for sensor in rig if sensor.name in AHEAD]
    assert len(known) == 1, [sensor.name for sensor in rig]
    position, direction = AHEAD[known[0].name]
    assert known[0].pose.position == pytest.approx(position, abs=1e-6)
    ahead = known[0].pose.ground_from_sensor[:, 0]
    assert np.abs(ahead - direction).max() < 2e-3  # yaw 3.14 is not half a turn
    assert len(form.commit) == 40


def test_the_page_is_what_the_script_writes():
    spec = importlib.util.spec_from_file_location("page", CHECKOUT / "tools" / "foreign_files.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    assert script.PAGE.read_text("utf-8") == script.page(), "run python tools/foreign_files.py"
