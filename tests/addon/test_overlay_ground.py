"""Ground map, blind ground, reach and heat as arrays: right places, figures and colours."""

import math

import numpy as np
import pytest

import pe_core as pe
from blender_addon.overlay import ground_layers, heatmap
from pe_core.scoring.sight import BlindGround, BlindSpot, GroundSight, Reach
from pe_tools.graphics import beams, colors, ground
from tests.engine.drawn import box, car, mounted


def seen(entropy=None, sensors=None, step=1.0, shape=(30, 20), coverage=None):
    """A map of places; the vehicle is in the middle."""
    nx, ny = shape
    nothing = np.zeros(shape)
    entropy = nothing if entropy is None else entropy
    sensors = np.ones(shape, int) if sensors is None else sensors
    x, y = ((np.arange(n) + 0.5 - n / 2) * step for n in (nx, ny))
    coverage = entropy if coverage is None else coverage
    return GroundSight(
        x=x,
        y=y,
        step=step,
        height=None,
        entropy=entropy,
        coverage=coverage,
        sensors=sensors,
        kinds=sensors,
    )


def test_a_scale_rises_evenly_in_lightness():
    """Perceptually even: steps of CIE lightness are of one sign, none much larger than others."""
    for scale in (colors.VIRIDIS, colors.CIVIDIS, colors.COUNTS):
        rgb = np.array(scale)
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        lightness = 116.0 * np.cbrt(linear @ [0.2126, 0.7152, 0.0722]) - 16.0
        steps = np.diff(lightness)
        assert steps.min() > 0.0 and steps.max() < 2.5 * steps.mean()


def test_the_map_lies_where_it_was_looked_and_is_clear_in_the_vehicle():
    entropy = np.full((30, 20), 16.651)
    entropy[:15] = -10.976  # behind: as good as can be
    entropy[14:16, 9:11] = np.nan
    shape = ground.ground_map(seen(entropy), ground.ENTROPY, 0.5, faded=False)
    sheet = shape.sheet
    assert sheet.low == (-15.0, -10.0) and sheet.high == (15.0, 10.0)
    assert sheet.image.shape == (20, 30, 4) and sheet.image.flags.c_contiguous
    assert (sheet.image[9:11, 14:16, 3] == 0.0).all() and sheet.image[0, 0, 3] == 0.5
    np.testing.assert_allclose(sheet.image[3, 2, :3], colors.VIRIDIS[-1], atol=1e-4)
    np.testing.assert_allclose(sheet.image[3, 27, :3], colors.VIRIDIS[0], atol=1e-4)
    assert shape.legend.ticks == ("unseen", "well seen")
    assert shape.legend.values == ("16.7 nats", "2.8 nats", "−11.0 nats"), "small, below the words"
    assert shape.legend.scale[0][:3] == pytest.approx(colors.VIRIDIS[0], abs=1e-6)


def test_colours_fit_what_is_shown_and_the_bright_end_is_good():
    entropy = np.linspace(-4.0, 2.0, 600).reshape(30, 20)
    # a few do not count
    entropy[0, 0] = -10.9
    entropy[-1, -1] = 16.6
    entropy[5, 5] = np.nan
    assert ground.fitted_bounds(seen(entropy), ground.ENTROPY) == (2.0, -4.0)
    shape = ground.ground_map(seen(entropy), ground.ENTROPY, 1.0, faded=False, bounds=(2.0, -4.0))
    assert shape.legend.values == ("2.0 nats", "−1.0 nats", "−4.0 nats")
    assert shape.legend.ticks == ("badly seen", "well seen")
    assert shape.legend.bounds == (2.0, -4.0)
    image = shape.sheet.image.transpose(1, 0, 2)
    np.testing.assert_allclose(image[0, 0, :3], colors.VIRIDIS[-1], atol=1e-6)
    np.testing.assert_allclose(image[-1, -1, :3], colors.VIRIDIS[0], atol=1e-6)
    coverage = np.full((30, 20), 0.97)
    low, high = ground.fitted_bounds(seen(coverage=coverage), ground.COVERAGE)
    assert 0.0 < low < 0.97 < high <= 1.0 and high - low >= 0.05
    nothing = np.full((30, 20), np.nan)
    whole = ground.QUANTITIES[ground.ENTROPY]
    assert ground.fitted_bounds(seen(nothing), ground.ENTROPY) == (whole.low, whole.high)


def square(low, high):
    x0, y0 = low
    x1, y1 = high
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)], float)


def found_blind(outlines, nearest=None, zone=None):
    nowhere = dict.fromkeys(("front", "rear", "left", "right"))
    spots = {side: BlindSpot(*spot) for side, spot in (nearest or {}).items()}
    zones = {**dict.fromkeys(nowhere, 0.0), **(zone or {})}
    return BlindGround(
        outlines,
        area=5.0,
        height=0.5,
        within=10.0,
        nearest={**nowhere, **spots},
        zone=zones,
        seen_from=nowhere,
    )


def test_blind_ground_is_measured_by_side():
    """At the body: how far it goes. Away from it: where it begins. None: no word."""
    at_body = square((2.0, -1.0), (5.0, 1.0))
    away = square((-1.0, 4.0), (1.0, 6.0))
    nearest = {"front": ((2.0, 0.0), 0.0), "left": ((0.0, 4.0), 3.0)}
    found = found_blind((at_body, away), nearest, {"front": 3.0})
    shape = ground_layers.blind_ground(found, car().bounds, 0.5)
    assert {label.text for label in shape.labels} == {"blind to 3.0 m out", "blind from 3.0 m out"}
    places = {label.text: label.place for label in shape.labels}
    assert places["blind to 3.0 m out"] == pytest.approx((5.0, 0.0, 0.0), abs=1e-6)
    assert places["blind from 3.0 m out"] == pytest.approx((0.0, 4.0, 0.0), abs=1e-6)
    assert shape.legend.classes[0][1] == "5.0 m² within 10 m" and "0.5 m" in shape.legend.title
    assert (shape.lines.points[:, 2] == 0.0).all() and len(shape.thin.points)


def found_reach(distance, limit=80.0):
    bearings = np.radians(np.arange(0, 360, 5.0))
    full = np.broadcast_to(np.asarray(distance, float), bearings.shape)
    edge = np.broadcast_to(np.asarray(limit, float), bearings.shape)
    return Reach(
        "pedestrian",
        ap=0.5,
        bearings=bearings,
        distance=full,
        per_sensor={"roof": full / 2.0},
        limit=edge,
    )


def test_reach_is_a_closed_line_with_metres():
    shape = ground_layers.reach_of_rig(found_reach(30.0))
    points = shape.lines.points.reshape(-1, 2, 3)
    assert len(points) == 72
    np.testing.assert_allclose(np.hypot(points[..., 0], points[..., 1]), 30.0, rtol=1e-6)
    np.testing.assert_array_equal(points[:, 1], np.roll(points[:, 0], -1, axis=0))
    assert [label.text for label in shape.labels] == ["30 m"] * ground_layers.LABEL_COUNT
    assert shape.labels[0].place == pytest.approx((30.0, 0.0, 0.0))
    assert "Pedestrian" in shape.legend.title and "AP" in shape.legend.title


def test_heat_is_hits_per_area_on_the_surface():
    """A plate 2 m below a LiDAR that looks straight down and about: known beams a dm2."""
    plate = box((-3.0, -3.0, -0.5), (3.0, 3.0, 0.0))
    angles = np.radians(np.arange(-90.0, -70.0, 0.25))
    sensor = mounted(pe.Lidar("down", angles, 1440, 50.0), (0.0, 0.0, 2.0))
    found = beams.cast(sensor, plate)
    shape = heatmap.hit_density([found], plate.triangles)
    assert shape.legend.scale[0][:3] == pytest.approx(colors.VIRIDIS[0])  # dark: many, bad
    assert shape.legend.ticks[0] == "100"
    points = shape.faces.points
    np.testing.assert_allclose(points[:, 2], heatmap.LIFT_M, atol=1e-6)
    radius = np.hypot(points[:, 0], points[:, 1]).max()
    assert radius == pytest.approx(2.0 * math.tan(math.radians(20.0)), abs=0.1)
    hits = found.occluded.sum()
    assert len(points) / 6 == pytest.approx(math.pi * 0.73**2 / heatmap.TILE_M**2, rel=0.15)
    upwards = np.tile([0.0, 0.0, 1.0], (hits, 1))
    tiles = heatmap._Tiles.of(found.points[found.occluded], upwards, np.ones(hits))
    ring = np.hypot(tiles.points[:, 0], tiles.points[:, 1])
    at = (ring > 0.35) & (ring < 0.45)
    # d beams / d area at radius r: beams a radian of elevation and azimuth, over the Jacobian.
    r = 0.4
    per_sr = (1440 / (2.0 * math.pi)) / math.radians(0.25)
    expected = per_sr * 2.0 / (4.0 + r**2) / r / 100.0
    assert np.median(tiles.density[at]) == pytest.approx(expected, rel=0.15)
