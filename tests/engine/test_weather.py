"""Weather: ranges against figures worked out by hand, and m without measuring again."""

import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors import weather
from pe_core.sensors.weather import Weather, camera_range, fog_return_range, lidar_range
from tests.engine import shapes


def named(**values):
    return Weather("w", **values)


@pytest.mark.parametrize(
    ("values", "metres"),
    [
        ({}, 200.0),
        ({"rain_mm_h": 10.0}, 157.0),
        ({"rain_mm_h": 50.0}, 120.0),
        ({"snow_mm_h": 2.5}, 142.0),
        ({"fog_mor_m": 200.0}, 70.0),
        ({"fog_mor_m": 50.0}, 31.0),
    ],
)
def test_a_lidar_s_range_is_that_of_the_literature_s_extinction(values, metres):
    found = lidar_range(200.0, named(**values))
    assert found == pytest.approx(metres, abs=0.6)
    alpha = named(**values).extinction
    assert found**2 * math.exp(2 * alpha * found) <= 200.0**2
    further = found + 0.011
    assert further**2 * math.exp(2 * alpha * further) > 200.0**2


def test_dark_targets_shorten_and_bright_ones_do_not_lengthen_a_lidar_s_range():
    assert lidar_range(100.0, named(reflectivity=0.25)) == 50.0
    assert lidar_range(100.0, named(reflectivity=4.0)) == 100.0


def test_fog_s_own_return_beats_a_target_where_both_are_equally_strong():
    """By a fine sum of the same integral with NumPy."""
    mor = 50.0
    alpha = math.log(20.0) / mor
    time = (np.arange(20_000) + 0.5) / 20_000 * 2 * weather.PULSE_S
    best = 0.0
    for distance in np.arange(0.9, 8.0, 0.02):
        r = distance - weather.LIGHT_M_S * time / 2
        seen = np.clip((r - 0.9) / 0.1, 0.0, 1.0)
        pulse = np.sin(np.pi * time / (2 * weather.PULSE_S)) ** 2
        with np.errstate(over="ignore"):
            power = np.where(r > 0.9, pulse * seen * np.exp(-2 * alpha * r) / r**2, 0.0)
        best = max(best, power.mean() * 2 * weather.PULSE_S)
    soft = 0.046 / mor * best
    r = fog_return_range(mor)
    hard = weather.TARGET_BACKSCATTER * math.exp(-2 * alpha * r) / r**2
    assert hard == pytest.approx(soft, rel=0.02)
    assert fog_return_range(mor, 0.1) < r


def test_a_camera_s_range_is_where_contrast_ends_or_the_lamps_light():
    fog = camera_range(math.inf, named(fog_mor_m=100.0))
    assert fog == pytest.approx(76.86, abs=0.02)
    assert camera_range(50.0, named(fog_mor_m=100.0)) == 50.0
    assert camera_range(math.inf, named()) == math.inf
    assert camera_range(math.inf, named(night=True)) == math.floor(2500 * math.sqrt(4.8)) / 100
    both = camera_range(math.inf, named(night=True, fog_mor_m=50.0))
    lamps = 24.0 * (25.0 / both) ** 2 * math.exp(-math.log(20) / 50.0 * both)
    assert 5.0 <= lamps < 5.01


def test_a_sensor_in_a_weather_has_the_bits_of_one_with_that_range():
    """m by what is known of clear air against m measured anew, on several samples."""
    body = pe.Vehicle(shapes.box((-2.0, -0.9, 0.3), (2.0, 0.9, 1.5)))
    rig = pe.Rig(
        [
            pe.Sensor("roof", pe.catalog.load("Pandar40"), pe.Pose((0.1, 0.02, 1.9))),
            pe.Sensor(
                "side",
                pe.catalog.load("Velodyne VLP-16 Puck"),
                pe.Pose.from_degrees((0.5, 0.95, 1.2), (3.0, 11.0, 80.0)),
            ),
            pe.Sensor("front", pe.Camera("c", 640, 480, 1.5), pe.Pose((1.0, 0.0, 1.4))),
        ]
    )
    for number, mor in enumerate((12.0, 20.0, 30.0)):
        evaluator = pe.Evaluator(
            shapes.small_space(), pe.Prior.road(), body, samples=4096, shift=(0.1 * number,) * 3
        )
        evaluator.score(rig)
        foggy = Weather("fog", fog_mor_m=mor)(rig)[0]
        anew = pe.Rig([replace(s, model=replace(s.model)) for s in foggy])
        assert [s.model.max_range for s in anew] == [s.model.max_range for s in foggy]
        assert evaluator.score(foggy).to_dict() == evaluator.score(anew).to_dict()
        assert evaluator.entropies([rig, foggy]) == [evaluator.entropy(r) for r in (rig, anew)]
        assert evaluator.entropy(foggy) > evaluator.entropy(rig)


def test_rain_damps_a_radar_and_fog_does_not():
    """ITU-R P.838-3 at 77 GHz: 5.9 and 18.8 dB/km at 10 and 50 mm/h."""
    assert weather.rain_db_per_km(10.0) == pytest.approx(5.9, abs=0.05)
    assert weather.rain_db_per_km(50.0) == pytest.approx(18.8, abs=0.05)
    name = next(n for n, e in pe.catalog.entries().items() if e.kind == "radar")
    rig = pe.Rig([pe.Sensor("radar", pe.catalog.load(name), pe.Pose((2.0, 0.0, 0.5)))])
    assert named(fog_mor_m=50.0)(rig)[0]["radar"] is rig["radar"]
    wet = named(rain_mm_h=10.0)(rig)[0]["radar"].model
    assert wet.attenuation_db_km == weather.rain_db_per_km(10.0)
    evaluator = pe.Evaluator(pe.PerceptionSpace(), pe.Prior.road(), samples=4096)
    assert evaluator.entropy(named(rain_mm_h=50.0)(rig)[0]) > evaluator.entropy(rig)
