"""Study files: round trip to the bit, and one clear line for whatever is wrong."""

import math
import tomllib

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.table_reader import dumps
from tests.engine import shapes
from tests.engine.refusals import wrongly_refused

MINIMAL = """
[[sensor]]
name = "roof"
model = "Pandar64"
position = [-0.43, 0.0, 1.80]
"""

FULL = """
samples = 5000
[space]
x = [-20, 20]
y = [-10, 10]
z = [0, 4]
interval = 0.5
[prior]
model = "road"
[[prior.focus]]
factor = 2.0
x = [5, inf]
classes = ["cone", "car"]
[ap.lidar]
a = 0.2
b = 0.5
[fusion]
blind = "literal"
[vehicle]
mesh = "car.npz"
glass = ["cabin"]
clearance = 0.05
[[sensor]]
name = "roof"
model = "Pandar64"
position = [-0.43, 0.0, 1.80]
rotation = [0.1, -0.2, 0.3]
fusion = "top"
free = ["z", "yaw"]
bounds = { z = [1.5, 2.0], yaw = [-10, 10] }
[[sensor]]
name = "own"
position = [1.0, 0.0, 1.2]
[sensor.model]
kind = "lidar"
elevations_deg = [-10, 0.1, 5]
azimuth_step_deg = 0.4
max_range_m = 80
[[sensor]]
name = "cam"
model = "Camera 60 deg"
position = [1.0, 0.0, 1.5]
[optimize]
free = ["x"]
seed = 7
samples = 4096
method = "random"
candidates = 12
"""


RANDOM = 'method = "random"\n'
BAD = [
    ("study", "a = ["),
    ("spce", MINIMAL + "[spce]\n"),
    ("sensor[0].colour", MINIMAL + "colour = 3\n"),
    ("sensor[0].model", MINIMAL.replace("Pandar64", "Pandar65")),
    ("sensor[0].name", MINIMAL.replace('name = "roof"', "")),
    ("sensor", "[space]\n"),
    ("rig: sensor name", MINIMAL + MINIMAL),
    ("space.interval", MINIMAL + "[space]\ninterval = 0.3\n"),
    ("prior.model", MINIMAL + '[prior]\nmodel = "city"\n'),
    ("prior.focus[0].factor", MINIMAL + "[[prior.focus]]\nx = [0, 1]\n"),
    ("sensor[0].free", MINIMAL + 'free = ["up"]\n'),
    ("roof: bounds of z", MINIMAL + "bounds = {z = [2, 3]}\n"),
    ("sensor[0].bounds.w", MINIMAL + "bounds = {w = [2, 3]}\n"),
    ("optimize.candidates", MINIMAL + f"[optimize]\n{RANDOM}candidates = 0\n"),
    ("optimize.method", MINIMAL + "[optimize]\ncandidates = 9\n"),
]


@pytest.fixture
def write(tmp_path):
    car = shapes.box_car()
    pt.write_mesh(tmp_path / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))

    def to_file(text):
        path = tmp_path / "study.toml"
        path.write_text(text, "utf-8")
        return path

    return to_file


def test_what_is_not_said_has_the_paper_s_values(write):
    study = pe.load_study(write(MINIMAL))
    assert study.space == pe.PerceptionSpace()
    assert study.model == pe.PerceptionModel()
    assert study.vehicle is None and study.samples == 0
    assert study.rig["roof"].pose == pe.Pose((-0.43, 0.0, 1.80)), "upright"
    assert study.search.free == {"roof": ("x", "y", "z", "pitch")}
    assert study.search.schedule.candidates == 1000


def test_everything_that_is_said_arrives(write):
    study = pe.load_study(write(FULL))
    assert study.space.shape == (80, 40, 8)
    assert study.prior.focus[0] == pe.Focus(2.0, (5.0, math.inf), classes=("cone", "car"))
    assert study.model == pe.PerceptionModel(lidar=pe.ApCurve(0.2, 0.5), blind="literal")
    assert study.vehicle.glass == ("cabin",) and study.vehicle.clearance == 0.05
    assert study.rig["roof"].pose.rpy == tuple(map(math.radians, (0.1, -0.2, 0.3)))
    own = study.rig["own"].model
    assert own.beam_count == 3 * 900 and own.elevations.tolist() == [
        math.radians(each) for each in (-10, 0.1, 5)
    ]
    assert study.search.free == {"roof": ("z", "yaw"), "own": ("x",), "cam": ("x",)}
    bounds = study.search_space().bounds["roof"]
    assert bounds["z"] == (1.5, 2.0)
    assert bounds["yaw"] == pytest.approx((-math.radians(10), math.radians(10)))


def test_bad_studies_are_refused(write):
    path = write(MINIMAL)
    assert wrongly_refused(lambda text: pe.load_study(write(text)), BAD, path) == []


def test_a_study_that_is_not_there(tmp_path):
    with pytest.raises(pe.InputError, match=r"none\.toml: no such file"):
        pe.load_study(tmp_path / "none.toml")


def test_toml_text_reads_back_as_it_was():
    data = {
        "a": 1,
        "b": -0.1,
        "c": [math.inf, -math.inf, 1e300, 5e-324],
        "d": 'quotes " and \\ and\nlines\x7f',
        "odd key.": {"nested": [{"x": [1, [2.5]]}, {"y": True}]},
        "empty": [],
    }
    assert tomllib.loads(dumps(data)) == data
