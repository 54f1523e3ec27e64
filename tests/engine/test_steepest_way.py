"""The steepest way of a sensor: slopes that a hand can work out, noise that is not told."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import search
from pe_core.scoring.score import Scatter
from pe_core.study import load_study
from pe_tools import advice
from pe_tools.cli.verbs import main
from tests.engine import shapes

BATCHES = 16
ON_ROOF = (-0.4, 0.0, 1.5)


class ByPose:
    """An evaluator whose entropy is a function of the first sensor's pose, with noise by batch."""

    samples = 1024

    def __init__(self, entropy, noise=0.0):
        self.entropy_of = entropy
        self.noise = noise

    def summary(self, rig):
        pose = next(iter(rig)).pose
        seed = abs(hash((pose.position, pose.rpy))) % 2**32
        row = np.random.default_rng(seed).normal(0.0, self.noise, BATCHES)
        residuals = {("rig", "", "entropy"): tuple((row - row.mean()).tolist())}
        return SimpleNamespace(entropy=self.entropy_of(pose), scatter=Scatter("one", residuals))


def places_at(position, standoff=0.1, **options):
    """Where a LiDAR on the car's body and cabin may go."""
    car = shapes.box_car()
    lidar = pe.Sensor("roof", shapes.small_lidar(8, 90), pe.Pose(position, (0.0, 0.0, 0.0)))
    mount = search.SurfaceMount(car.part_names, standoff=standoff)
    mounting = search.Mounting({"top": mount}, {"roof": "top"})
    limits = pe.Study(pe.Rig([lidar])).limits
    return search.OwnPlaces(pe.Rig([lidar]), "roof", car, mounting, limits=limits, **options)


def test_the_arrow_is_the_slope_of_a_plane():
    found = advice.steepest_way(
        places_at(ON_ROOF),
        ByPose(lambda pose: 3.0 - 1.2 * pose.position[0] + 0.9 * pose.position[1]),
    )
    assert found.direction == pytest.approx((0.8, -0.6, 0.0))
    assert found.along.change == pytest.approx(-1.5 * 0.05)  # 1.5 nats a metre
    assert found.along.is_clear and not found.along.blocked
    assert advice.way_text(np.array(found.direction)) == "forward and right"
    assert not found.clear_turns and found.better is None


def test_turns_have_their_better_sense():
    found = advice.steepest_way(
        places_at(ON_ROOF), ByPose(lambda pose: pose.rpy[2] - 2.0 * pose.rpy[1])
    )
    assert found.direction is None  # no place is better than another
    changes = {turn.name: turn.change for turn in found.clear_turns}
    degree = np.radians(1.0)
    assert changes == pytest.approx({"yaw right": -degree, "pitch nose down": -2.0 * degree})


def test_a_gain_within_three_errors_is_not_told():
    slanted = ByPose(lambda pose: -0.2 * pose.position[0], noise=0.0)
    noisy = ByPose(slanted.entropy_of, noise=0.05)
    assert advice.steepest_way(places_at(ON_ROOF), slanted).direction is not None
    found = advice.steepest_way(places_at(ON_ROOF), noisy, screen=noisy)
    assert found.direction is None and found.better is None and not found.clear_turns
    assert found.along.error > abs(found.along.change) / 3.0


def test_where_the_roof_ends_the_arrow_follows_its_edge():
    corner = (0.8, 0.0, 1.5)
    slanted = ByPose(lambda pose: -2.0 * pose.position[0] - 0.5 * pose.position[1])
    found = advice.steepest_way(places_at(corner), slanted)
    assert found.direction == pytest.approx((0.0, 1.0, 0.0), abs=1e-9)
    assert found.along.change == pytest.approx(-0.025)


def test_the_best_place_is_chosen_within_20_cm_and_judged():
    aim = np.array([-0.4 + 0.2, 0.0])
    bowl = ByPose(lambda pose: float(np.sum((np.array(pose.position[:2]) - aim) ** 2)))
    found = advice.steepest_way(places_at(ON_ROOF), bowl, screen=bowl)
    assert found.better.pose.position == pytest.approx((-0.2, 0.0, 1.5))
    assert found.better.change == pytest.approx(-0.04)
    assert set(found.better.poses) == {"roof"}
    there = advice.steepest_way(places_at((-0.2, 0.0, 1.5)), bowl, screen=bowl)
    assert there.better is None


def test_a_sensor_moves_along_its_free_axes_within_its_bounds():
    study = shapes.car_study(pe.Rig([shapes.lidar_on_roof()]))
    own = replace(study.search, free={"roof": ("z",)}, limits={"roof": {"z": (1.5, 1.83)}})
    places = advice.places_of(replace(study, search=own), "roof")
    assert places.tangents().tolist() == [[0.0, 0.0, 1.0]]
    up = places.moved(np.array([0.5, 0.5, 0.5]))["roof"].pose.position
    assert up == pytest.approx((-0.43, 0.0, 1.83))
    found = advice.steepest_way(places, ByPose(lambda pose: pose.position[2]))
    assert found.along.name == "down" and found.direction == (0.0, 0.0, -1.0)


@pytest.fixture(scope="module")
def skyward():
    """A study of a camera on a roof that looks far too high."""
    car = shapes.box_car()
    eye = shapes.camera(position=(0.5, 0.0, 1.5), rotation=(0.0, -25.0, 0.0), name="eye")
    return pe.Study(pe.Rig([eye]), car, shapes.small_space(), samples=8192)


def test_the_command_tells_the_same(skyward, tmp_path, capsys):
    file = tmp_path / "study.toml"
    pt.export_study(skyward, file)
    assert main(["explain", str(file), "--sensor", "eye", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["steepest"]
    study = load_study(file)
    found = advice.steepest_way(
        advice.places_of(study, "eye"), study.evaluator(), screen=advice.screen_of(study)
    )
    assert told == json.loads(json.dumps(found.to_dict()))
