"""A built rig against the designed one: pairs, offsets in a known frame, costs, verdicts."""

import json
import math
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import requirements
from pe_tools import advice
from pe_tools.cli.verbs import main
from pe_tools.jobs import BuiltJob
from tests.engine import shapes

DEG = math.radians(1.0)


def sensors():
    lidar = pe.Sensor("roof", shapes.small_lidar(8, 90), pe.Pose((0.0, 0.0, 1.8), (0, 0, 0)))
    return [
        lidar,
        shapes.camera(position=(2.2, 0.0, 1.2), name="front"),
        shapes.camera(position=(-2.3, 0.0, 1.2), rotation=(0, 0, 180), name="rear"),
    ]


def moved(sensor, by=(0.0, 0.0, 0.0), yaw=0.0, name=None):
    position = tuple(a + b for a, b in zip(sensor.pose.position, by, strict=True))
    roll, pitch, own = sensor.pose.rpy
    pose = pe.Pose(position, (roll, pitch, own + yaw))
    return replace(sensor, name=name or sensor.name, pose=pose)


@pytest.fixture(scope="module")
def study():
    zone = requirements.Zone(spots=((5.0, 0.0),))
    cone = requirements.Requirement("ahead", zone, (requirements.BODIES["child"],))
    base = shapes.car_study(pe.Rig(sensors()), samples=8192)
    return replace(base, requirements=(cone,))


def compared(study, built, **options):
    job = BuiltJob(study, built, workers=1, **options)
    for _ in job:
        pass
    return job.result


def test_pairs_are_by_name_then_by_the_nearest_pose_of_the_kind():
    roof, front, rear = sensors()
    built = [moved(roof), moved(rear, (0.02, 0, 0), name="cam_1"), moved(front, name="cam_0")]
    found = advice.paired(pe.Rig([roof, front, rear]), pe.Rig(built))
    assert {pair.name: pair.built.name for pair in found.pairs} == {
        "roof": "roof",
        "front": "cam_0",
        "rear": "cam_1",
    }
    assert found.missing == found.extra == ()
    one = advice.paired(pe.Rig([roof, front]), pe.Rig([moved(front, name="only")]))
    assert [pair.name for pair in one.pairs] == ["front"] and one.missing == ("roof",)


def test_an_offset_is_in_the_ground_frame_and_a_turn_in_the_sensors_own():
    roof, _, rear = sensors()
    pair = advice.BuiltPair(rear, moved(rear, (0.003, -0.004, 0.0), yaw=2.0 * DEG))
    assert pair.offset == pytest.approx((0.003, -0.004, 0.0))
    assert pair.distance == pytest.approx(0.005)
    assert pair.turn == pytest.approx((0.0, 0.0, 2.0 * DEG), abs=1e-9)
    assert pair.angle == pytest.approx(2.0 * DEG, rel=1e-6)
    assert not pair.is_as_designed and advice.BuiltPair(roof, roof).is_as_designed


def test_costs_are_differences_of_scores_with_one_sensor_as_built(study):
    roof, front, rear = sensors()
    built = pe.Rig([moved(roof, (0.0, 0.0, -0.1)), moved(front, yaw=60.0 * DEG), rear])
    found = compared(study, built)
    assert set(found.moved) == {"roof", "front"}
    evaluator = study.evaluator()
    alone = pe.Rig([roof, moved(front, yaw=60.0 * DEG), rear])
    rise = evaluator.entropy(alone) - evaluator.entropy(study.rig)
    assert found.costs("front")["entropy"] == pytest.approx(rise, abs=3e-9)
    whole = found.of_rigs[0]
    assert whole.measure == "entropy" and len(whole.values) == 2
    assert whole.values[1] == evaluator.entropy(built)
    weights = [found.weight(pair.name) for pair in found.worst_first]
    assert weights == sorted(weights, reverse=True)


def test_one_command_checks_a_calibration(study, tmp_path, capsys):
    design = tmp_path / "design.toml"
    pt.export_study(study, design)
    roof, front, rear = sensors()
    built = pe.Rig([moved(roof, (0.012, 0.0, -1.0)), moved(front, yaw=180.0 * DEG), rear])
    pt.export_rig(built, "urdf", tmp_path / "built.urdf")
    options = ["--workers", "1", "--json"]
    assert main(["compare", str(design), str(tmp_path / "built.urdf"), *options]) == 3
    data = json.loads(capsys.readouterr().out)["as_built"]
    by_name = {row["sensor"]: row for row in data["sensors"]}
    assert by_name["roof"]["offset_mm"] == pytest.approx([12.0, 0.0, -1000.0], abs=1e-3)
    assert by_name["front"]["angle_deg"] == pytest.approx(180.0, abs=1e-3)
    assert set(data["worst_first"]) == {"roof", "front"} and data["fallen"] == ["ahead"]
    assert main(["compare", str(design), "--built", str(tmp_path / "built.urdf"), *options]) == 3
