"""Radars: formulas at round numbers, m against an oracle, kernels, bad input."""

import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core import sensors as kinds
from pe_core.scoring.requirements import BODIES, Body, Criterion, sees
from pe_core.sensors.radar import Reflectivity, detection_probability, signal_to_noise, snr_for
from pe_tools.advice.mount_checks import SensorAtBody, odd_mounting
from pe_tools.advice.vehicle_checks import Bodywork
from pe_tools.verify.radar_oracle import expected_detections
from tests.engine import shapes

ARS = "Continental ARS408-21"
MODE = {
    "name": "scan",
    "azimuth_deg": [-50, 0, 50],
    "range_m": [40, 100, 60],
    "elevation_deg": [-15, 0, 15],
    "elevation_scale": [0.5, 1.0, 0.6],
    "range_resolution_m": 0.5,
    "azimuth_resolution_deg": 2.0,
    "elevation_resolution_deg": 4.0,
    "min_range_m": 1.0,
}
TABLE = {"kind": "radar", "mode": [MODE], "list_length": 400}
SIZES = {"car": (4.6, 1.9, 1.7), "pedestrian": (0.8, 0.7, 1.75), "truck": (7.5, 2.55, 3.0)}
EDGES = {
    "side": ({"azimuth_deg": [-20, 20]}, lambda u: (8.0, 2.91 + u)),
    "other side": ({"azimuth_deg": [-20, 35]}, lambda u: (7.0, -2.55 + u)),
    "top": ({"elevation_deg": [-80, 5]}, lambda u: (10.0 + 4.0 * u, 0.3)),
    "bottom": ({"elevation_deg": [-7, 60]}, lambda u: (7.0 + 3.0 * u, -0.7)),
    "far": ({"max_range_m": 30.0}, lambda u: (30.0 + u, 1.0)),
    "near": ({"min_range_m": 6.0}, lambda u: (6.0 + u, -0.5)),
}


def radar(table=TABLE, position=(2.6, 0.1, 0.55), rotation=(0, 0, 0), name="front"):
    model = table if not isinstance(table, dict) else catalog.from_table("own", table)
    return pe.Sensor(name, model, pe.Pose.from_degrees(position, rotation))


def objects(seed=3, count=60, names=tuple(SIZES), ground=30.0):
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, len(names), count)
    sizes = np.array([SIZES[names[k]] for k in labels]) * rng.uniform(0.9, 1.1, (count, 3))
    x = rng.uniform(6, 6 + 2 * ground, count)
    y = rng.uniform(-ground, ground, count)
    centers = np.column_stack([x, y, sizes[:, 2] / 2])
    return pe.Objects(centers, sizes, rng.uniform(-3, 3, count), labels, class_names=names)


def test_a_requirement_takes_the_rcs_that_nearly_all_bodies_exceed():
    """An ARS408's 250 m for 10 dBsm: a pedestrian of -20.7 dBsm at 42.7 m, of -11.1 at 74.2.

    What the user states is taken where it is less; a body without a class sends no echo.
    """
    far = 250.0 * 10 ** ((-20.7 - 10.0) / 40.0)
    model = catalog.load(ARS)
    assert far == pytest.approx(42.7, abs=0.01)

    def seen(x, model=model, body="adult"):
        body = body if isinstance(body, Body) else BODIES[body]
        sensor = radar(model, position=(0.0, 0.0, 0.85))
        return sees(
            sensor,
            body,
            (x + body.size[0] / 2.0, 0.0, 0.0),
            heading=0.0,
            vehicle=None,
            criterion=Criterion(),
        )

    assert seen(far - 0.05) and not seen(far + 0.05)
    strong = replace(model, rcs={"pedestrian": Reflectivity((0.0,))})
    weak = replace(model, rcs={"pedestrian": Reflectivity((-30.0,))})
    assert seen(far - 0.05, strong) and not seen(far + 0.05, strong)
    assert not seen(far - 0.05, weak) and seen(0.55 * far, weak)
    own = Body("post", (0.3, 0.3, 1.7))
    assert not seen(10.0, body=own) and not seen(10.0, body="patch")
    assert seen(10.0, replace(model, rcs={"post": Reflectivity((-20.0,))}), own)
    assert model.cautious is model.cautious and not model.is_cautious  # caches hold on to it


@pytest.mark.parametrize(
    "body, low_dbsm", [("adult", -20.7), ("cyclist", -14.6), ("motorcyclist", -14.6), ("car", -2.6)]
)
def test_each_class_has_the_rcs_of_its_weak_bodies(body, low_dbsm):
    """9.6 dB below the median, the spread of pedestrians: -11.1, -5 and 7 dBsm.

    The mode sees each body as one cell; the range is 250 m for 10 dBsm, so 250 m times 10 to the
    power of (low - 10) / 40 for the body.
    """
    mode = {"name": "a", "azimuth_deg": [-45, 45], "range_m": 250, "elevation_deg": [-30, 30]}
    found = BODIES[body]
    sensor = radar({"kind": "radar", "mode": [mode]}, position=(0.0, 0.0, found.size[2] / 2.0))
    far = 250.0 * 10.0 ** ((low_dbsm - 10.0) / 40.0)

    def seen(front):
        foot = (front + found.size[0] / 2.0, 0.0, 0.0)
        return sees(sensor, found, foot, heading=0.0, vehicle=None, criterion=Criterion())

    assert seen(far - 0.3) and not seen(far + 0.3)
    mild = catalog.from_table("own", {"kind": "radar", "mode": [mode], "rcs_dbsm": {"car": 9.0}})
    assert mild.cautious.reflectivity("car").dbsm == (-2.6,)


def test_rare_detections_in_many_cells_are_no_point():
    """Of a car in 8.2 cells of range: the probability of any detection, by the cells alike."""
    mode = {"name": "a", "azimuth_deg": [-9, 9], "range_m": 100, "elevation_deg": [-9, 9]}
    mode |= {"range_resolution_m": 0.5, "max_range_m": 300}
    sensor = radar({"kind": "radar", "mode": [mode]}, position=(0.0, 0.0, 0.65))
    snr = snr_for(0.9, 1e-6) * 10 ** ((-2.6 - 10.0) / 10.0)
    count = 4.1 / 0.5
    seen = []
    sure = []
    expected = []
    for x in np.arange(30.0, 120.0, 0.5):
        seen.append(
            sees(
                sensor,
                BODIES["car"],
                (x, 0.0, 0.0),
                heading=0.0,
                vehicle=None,
                criterion=Criterion(),
            )
        )
        pd = detection_probability(snr / count * (100.0 / (x - 2.05)) ** 4, 1e-6)
        pd = pd * (pd >= 0.1)
        sure.append(1.0 - (1.0 - pd) ** count >= 0.9)
        expected.append(count * pd >= 0.9)
    assert all(truth for is_seen, truth in zip(seen, sure, strict=True) if is_seen)
    assert 0 <= sum(sure) - sum(seen) <= 5 and sum(seen) + 10 < sum(expected) < len(seen)


@pytest.mark.parametrize("name", EDGES)
def test_what_an_edge_of_the_field_cuts_is_detected_with_its_probability(name):
    """Bodies are moved over an edge. Where the verdict changes, P of the part in the field is at
    least 0.9 if it is met, by the rays of the oracle (which are right to 0.004).

    A body is one cell of a mode of 200 m, so it is detected nearly surely where it is whole.
    """
    own, place = EDGES[name]
    mode = {"name": "a", "azimuth_deg": [-60, 60], "range_m": 200.0, "elevation_deg": [-60, 60]}
    mode |= {"range_resolution_m": 50, "azimuth_resolution_deg": 90, "elevation_resolution_deg": 90}
    mode |= own
    table = {"kind": "radar", "mode": [mode], "rcs_dbsm": {"post": 7.0}}
    sensor = radar(table, position=(0.0, 0.0, 0.7))
    rng = np.random.default_rng(4)
    found = []
    for _ in range(8):
        body = Body("post", tuple(rng.uniform((0.3, 0.3, 0.8), (3.0, 1.2, 1.8)).tolist()))
        yaw = float(rng.uniform(-3.0, 3.0))
        feet = [(*place(u), 0.0) for u in np.linspace(-1.6, 1.6, 81)]
        met = np.array(
            [sees(sensor, body, at, yaw, vehicle=None, criterion=Criterion()) for at in feet]
        )
        for k in np.flatnonzero(met[1:] != met[:-1]):
            x, y, _ = feet[k + 1 if met[k + 1] else k]
            box = pe.Objects(
                [[x, y, body.size[2] / 2.0]], [body.size], [yaw], [0], class_names=("car",)
            )
            # a car of the oracle has 7 dBsm
            found.append(expected_detections({"mode": [mode]}, sensor.pose, box)[0])
    assert len(found) > 5 and min(found) >= 0.896, sorted(found)
    assert max(found) < 1.0 and min(found) < 0.99  # some are cut


def test_formulas_at_round_numbers():
    """21.1 dB for Pd 0.9 at Pfa 1e-6; twice the range is 12 dB; 6 dB of cover both ways, too."""
    snr = snr_for(0.9, 1e-6)
    assert 10 * math.log10(snr) == pytest.approx(21.14, abs=0.01)
    assert detection_probability(snr, 1e-6) == pytest.approx(0.9)
    assert detection_probability(0.0, 1e-6) == pytest.approx(1e-6)
    anchor = (snr, 10.0)
    assert signal_to_noise(10.0, 100.0, 100.0, anchor) == pytest.approx(snr)
    assert signal_to_noise(10.0, 200.0, 100.0, anchor) == pytest.approx(snr / 16)
    assert signal_to_noise(1.0, 100.0, 100.0, anchor) == pytest.approx(snr / 10)
    lossy = signal_to_noise(10.0, 100.0, 100.0, anchor, attenuation_db_km=30.0)
    assert lossy == pytest.approx(snr * 10 ** (-0.6))


def test_a_reference_target_is_detected_with_its_probability_at_its_range():
    mode = {**MODE, "azimuth_deg": [-20, 20], "range_m": 80.0, "max_range_m": 200.0}
    mode = {k: v for k, v in mode.items() if "resolution" not in k and k != "elevation_scale"}
    table = {"kind": "radar", "mode": [mode], "rcs_dbsm": {"ball": 10.0}}
    sensor = radar(table, (0, 0, 1))
    ball = pe.Objects([[80.05, 0, 1.0]], [[0.1, 0.1, 0.1]], [0], [0], class_names=("ball",))
    assert kinds.measure_objects(sensor, ball)[0] == pytest.approx(0.9, abs=1e-4)
    covered = radar({**table, "cover_loss_db": 2.0}, (0, 0, 1))
    near = pe.Objects(
        [[80 / 10**0.1 + 0.05, 0, 1.0]], [[0.1, 0.1, 0.1]], [0], [0], class_names=("ball",)
    )
    assert kinds.measure_objects(covered, near)[0] == pytest.approx(0.9, abs=1e-4)


def assert_close_but_at_edges(found, expected):
    """Within 1 %, but where an edge of the field or of the body cuts an object."""
    apart = np.abs(found - expected) / np.maximum(expected, 0.5)
    assert np.quantile(apart, 0.85) < 0.01 and apart.max() < 0.06, np.sort(apart)[-12:]


def test_objects_are_those_of_the_oracle():
    """The oracle integrates over rays of its own and computes in dB."""
    sensor = radar(rotation=(2, 3, 10))
    some = objects()
    found = kinds.measure_objects(sensor, some)
    expected = expected_detections(tomllib_of(TABLE), sensor.pose, some)
    assert_close_but_at_edges(found, expected)
    assert (found > 1.0).sum() > 15 and (found == 0.0).sum() > 5


def test_the_body_hides_as_rays_of_the_oracle_do():
    sensor = radar(position=(1.0, 1.1, 0.6), rotation=(0, 0, -20))
    some = objects(ground=12.0, count=40)
    car = shapes.box_car()
    found = kinds.measure_objects(sensor, some, car)
    expected = expected_detections(tomllib_of(TABLE), sensor.pose, some, car.triangles)
    assert_close_but_at_edges(found, expected)
    hidden = kinds.measure_objects(sensor, some) - found
    assert (hidden > 0.5).any()


def tomllib_of(table):
    """The table as a file has it: the oracle reads no model."""
    lines = [f"{key} = {value}" for key, value in table.items() if key not in ("kind", "mode")]
    for mode in table["mode"]:
        lines += ["[[mode]]", *(f"{k} = {v!r}".replace("'", '"') for k, v in mode.items())]
    return tomllib.loads("\n".join(lines))


def test_a_cover_takes_decibels_and_a_bumper_blocks():
    wall = _wall(1.0)
    body = _wall(-2.0)
    triangles = np.concatenate([wall, body])
    parts = np.repeat([0, 1], [len(wall), len(body)])
    names = ("bumper", "body")
    sensor = radar(catalog.load(ARS), (0.0, 0.0, 0.6))
    target = pe.Objects([[30, 0, 0.85]], [SIZES["car"]], [0], [0], class_names=("car",))
    plain = pe.Vehicle(triangles, parts, names)
    covered = pe.Vehicle(triangles, parts, names, covers={"bumper": 2.0})
    free = kinds.measure_objects(sensor, target)[0]
    assert kinds.measure_objects(sensor, target, plain)[0] == 0.0
    through = kinds.measure_objects(sensor, target, covered)[0]
    assert 0.0 < through < free
    lossy = catalog.from_table("lossy", {**catalog.to_table(sensor.model), "cover_loss_db": 2.0})
    same = kinds.measure_objects(pe.Sensor("x", lossy, sensor.pose), target)[0]
    assert through == pytest.approx(same, rel=1e-9)
    with pytest.raises(pe.InputError, match="covers: expected bumper, or one of body"):
        pe.Vehicle(triangles, parts, names, covers={"bumber": 2.0})
    with pytest.raises(pe.InputError, match=r"covers\.bumper: expected.*0.*100"):
        pe.Vehicle(triangles, parts, names, covers={"bumper": -2.0})


def _wall(x):
    corners = np.array([[x, -3, -3], [x, 3, -3], [x, 3, 3], [x, -3, 3]], float)
    return corners[[[0, 1, 2], [0, 2, 3]]]


def test_a_study_of_radars_scores_voxels_and_objects(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(
        f'[[sensor]]\nname = "front"\nmodel = "{ARS}"\nposition = [2.6, 0.0, 0.5]\n'
        "[optimize]\nsamples = 2048\n"
    )
    study = pe.load_study(path)
    score = study.evaluator().score(study.rig)
    assert score.entropy < 16.0 and 0.05 < score.coverage < 0.7
    scored = pe.ObjectEvaluator(study.space, study.prior).score(study.rig)
    assert scored.entropy < 16.6 and scored.per_sensor["front"].coverage > 0.05


def test_a_cover_is_told_and_a_radar_behind_it_is_not_inside():
    """In a closed box: without the cover it is inside; with it the loss is told, once."""
    shell = shapes.box((1.0, -0.8, 0.2), (2.3, 0.8, 0.9))
    sensor = radar(catalog.load(ARS), (2.2, 0.0, 0.5))
    told = {}
    for covers in ({}, {"bumper": 2.0}):
        vehicle = pe.Vehicle(shell, None, ("bumper",), covers=covers)
        mounted = SensorAtBody(sensor, Bodywork(vehicle))
        told[bool(covers)] = {advice.code: advice.text for advice in odd_mounting(mounted)}
    assert "inside" in told[False] and "inside" not in told[True]
    assert told[True]["cover"] == "the cover bumper takes 2 dB one way from 100% of its field"
