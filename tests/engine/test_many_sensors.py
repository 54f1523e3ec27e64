"""Rigs of many sensors: what is computed grows with their number, not with its square."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric.frames import Frames
from pe_core.metric.fusion import Fusion
from pe_core.sensors.lidar.beams import BeamCache
from tests.engine import shapes

SAMPLES = 2048
CAMERA = pe.Camera("small", 320, 240, hfov=np.radians(60.0))


def ring(count, groups=("lidar", None)):
    """LiDARs and cameras round the roof, one of each a bearing."""
    lidar_group, camera_group = groups
    sensors = []
    for k in range(count):
        angle = 2.0 * np.pi * k / count
        x = np.cos(angle)
        y = 0.5 * np.sin(angle)
        lidar = shapes.small_lidar(8, 90)
        above = pe.Pose((x - 0.3, y, 1.75))
        ahead = pe.Pose((x - 0.3, y, 1.6), (0.0, 0.0, angle))
        sensors.append(pe.Sensor(f"lidar {k}", lidar, above, fusion=lidar_group))
        sensors.append(pe.Sensor(f"camera {k}", CAMERA, ahead, fusion=camera_group))
    return pe.Rig(sensors)


def evaluator(**model):
    return pe.Evaluator(
        shapes.small_space(),
        pe.Prior.road(),
        shapes.box_car(),
        samples=SAMPLES,
        model=pe.PerceptionModel(**model),
    )


@pytest.mark.parametrize("groups", [("lidar", None), (None, "camera"), ("lidar", "camera")])
@pytest.mark.parametrize(
    "model",
    [{}, {"blind": "literal"}, {"lidar": pe.ApCurve(0.15, 0.9, 0.2)}, {"frames": Frames(frames=3)}],
    ids=str,
)
def test_what_a_sensor_adds_is_the_rig_s_entropy_without_it_less_the_rig_s(groups, model):
    ours = evaluator(**model)
    rig = ring(3, groups)
    score = ours.score(rig)
    for sensor in rig:
        rest = pe.Rig([other for other in rig if other.name != sensor.name])
        lost = ours.entropy(rest) - ours.entropy(rig)
        assert score.per_sensor[sensor.name].lost == pytest.approx(lost, abs=2e-9)


def test_the_measurements_that_a_score_turns_into_precision_grow_with_the_sensors(monkeypatch):
    converted = []
    precision = Fusion.precision

    def counted(self, m, kind):
        converted.append(m.size)
        return precision(self, m, kind)

    monkeypatch.setattr(Fusion, "precision", counted)
    work = []
    for count in (4, 8, 16):
        converted.clear()
        evaluator().score(ring(count))
        work.append(sum(converted))
    few, more, many = work
    assert more < 2.2 * few and many < 2.2 * more


def test_sensors_of_one_model_and_orientation_share_their_rotated_beams():
    model = shapes.small_lidar()
    cache = BeamCache(None)
    left, right = (pe.Sensor(str(y), model, pe.Pose((0.0, y, 1.8))) for y in (0.5, -0.5))
    turned = pe.Sensor("turned", model, pe.Pose((0.0, 0.0, 1.8), (0.0, 0.1, 0.0)))
    shared = cache.rotated(left)
    assert cache.rotated(right) is shared and cache.rotated(turned) is not shared
    cache.keep_only([right])
    assert cache.rotated(left) is shared
    cache.keep_only([turned])
    assert cache.rotated(left) is not shared
