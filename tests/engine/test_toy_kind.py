"""The kind of sensor in `toy_kind` goes all the way: study, grid, sample, search, result.

A toy ring: m depends on the distance alone, and so does what is expected of every score.
"""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core import sensors as kinds
from pe_core.metric import entropy_of, late_fusion, precision_of
from pe_tools.cli.verbs import main
from tests.engine import shapes
from tests.engine.toy_kind import CURVE, RING, Ring

SPACE = pe.PerceptionSpace((-8, 8), (-6, 6), (0, 3), 0.5)
STUDY = """
[space]
x = [-8, 8]
y = [-6, 6]
z = [0, 3]
interval = 0.5

[ap.toyring]
a = 0.2
b = 0.4

[[sensor]]
name = "bumper"
model = { kind = "toyring", range_m = 4.0 }
position = [2.0, 0.0, 0.5]
free = ["x", "y"]

[[sensor]]
name = "roof"
model = "Pandar64"
position = [0.0, 0.0, 1.8]

[optimize]
method = "random"
candidates = 4
samples = 1024
"""


@pytest.fixture
def ring_kind():
    """Have the kind in the table for a test."""
    kinds.register(RING)
    yield RING
    kinds.unregister(RING.name)


def ring(name="bumper", position=(2.0, 0.0, 0.5), range_m=4.0, fusion=None):
    return pe.Sensor(name, Ring("ring", range_m), pe.Pose(position), fusion)


def centers_of(space):
    index = np.stack(np.meshgrid(*map(np.arange, space.shape), indexing="ij"), axis=-1)
    return space.center_of(index.reshape(-1, 3))


def expected_entropy(measured, curve):
    """Mean entropy under the uniform prior, by the equations: one group a row of `measured`."""
    return float(np.mean(entropy_of(late_fusion([precision_of(m, curve) for m in measured]))))


def test_the_grid_is_the_definition_and_the_equations(ring_kind):
    sensors = [ring("a"), ring("b", (-2.0, 1.0, 0.5), 3.0)]
    score = pe.Evaluator(SPACE, pe.Prior.uniform()).score(pe.Rig(sensors))
    measured = [pe.measure(s, centers_of(SPACE), SPACE.interval) for s in sensors]
    assert score.entropy == pytest.approx(expected_entropy(measured, CURVE), abs=1e-9)
    seen = np.mean((measured[0] > 0) | (measured[1] > 0))
    assert score.coverage == pytest.approx(seen, abs=1e-9) and 0.02 < seen < 0.5
    alone = [expected_entropy([m], CURVE) for m in measured]
    assert score.per_sensor["a"].entropy == pytest.approx(alone[0], abs=1e-9)
    assert score.per_sensor["b"].lost == pytest.approx(alone[0] - score.entropy, abs=2e-9)


def test_one_group_of_two_is_fused_early(ring_kind):
    sensors = [ring("a", fusion="both"), ring("b", (3.0, 1.0, 0.5), 5.0, fusion="both")]
    entropy = pe.Evaluator(SPACE, pe.Prior.uniform()).entropy(pe.Rig(sensors))
    total = sum(pe.measure(s, centers_of(SPACE), SPACE.interval) for s in sensors)
    assert entropy == pytest.approx(expected_entropy([total], CURVE), abs=1e-9)


def test_a_sample_is_as_good_as_the_grid_beside_lidar_and_camera(ring_kind):
    lidar = shapes.lidar_on_roof(shapes.small_lidar(32, 360))
    rig = pe.Rig([ring(), lidar, shapes.camera()])
    grid = pe.Evaluator(SPACE, pe.Prior.road(), shapes.box_car()).score(rig)
    sample = pe.Evaluator(SPACE, pe.Prior.road(), shapes.box_car(), samples=60_000).score(rig)
    assert sample.entropy == pytest.approx(grid.entropy, abs=0.08)
    for name, own in grid.per_sensor.items():
        assert sample.per_sensor[name].entropy == pytest.approx(own.entropy, abs=0.1)


def test_a_study_holds_it_and_its_curve(ring_kind, tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    study = pe.load_study(path)
    assert study.rig["bumper"].model.range_m == 4.0
    assert study.model.curve("toyring") == study.model.toyring == pe.ApCurve(0.2, 0.4)
    pe.save_study(study, tmp_path / "again.toml")
    again = pe.load_study(tmp_path / "again.toml")
    assert pe.study_to_dict(again) == pe.study_to_dict(study)
    assert again.model == study.model


@pytest.mark.usefixtures("few_errors", "no_key_figures")
def test_the_command_scores_searches_and_leaves_results(ring_kind, tmp_path, capsys):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    assert main(["optimize", "--no-review", str(path), "-o", str(tmp_path / "out"), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result == json.loads((tmp_path / "out" / "result.json").read_text())
    bumper = result["after"]["per_sensor"]["bumper"]
    assert math.isfinite(bumper["entropy"]) and bumper["beams"] == bumper["occluded"] == 0
    assert result["inputs"]["study"]["sensor"][0]["model"] == {
        "name": "bumper",
        "kind": "toyring",
        "range_m": 4.0,
    }
    moved = {p["placements"]["bumper"]["position"][0] for p in result["history"]}
    assert len(moved) > 1, "the search never moved the ring"


def test_kernels_of_ones_own_are_asked():
    """A kind with a grid kernel of its own is measured by it: here one that sees everything."""

    class Everything(kinds.GridKernel):
        def prepare(self, sensor):
            return sensor

        def planes(self, groups, pool):
            _, ny, nz = SPACE.shape
            return [
                lambda planes: np.full((planes.stop - planes.start, ny, nz), 9, np.uint8)
                for _ in groups
            ]

    kinds.register(replace(RING, on_grid=lambda *_: Everything()))
    try:
        score = pe.Evaluator(SPACE, pe.Prior.uniform()).score(pe.Rig([ring()]))
    finally:
        kinds.unregister(RING.name)
    assert score.coverage == 1.0
    nine = float(entropy_of(precision_of(9, CURVE)))
    assert score.entropy == pytest.approx(nine, abs=1e-9)
