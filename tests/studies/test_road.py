"""Points on the road: logs read, figures by hand, values found again, saved conclusions."""

import json
from pathlib import Path

import numpy as np
import pytest

from pe_core import InputError
from pe_core.scene.objects import Objects
from pe_core.sensors.lidar.returns import ANY, SURFACES
from studies.ranks import spearman
from studies.road import models
from studies.road.__main__ import kept_step, predicted
from studies.road.logs import CLASSES, Log, read_lidars, read_logs
from studies.road.models import FADING, SOLID, Fitted, cells_of, crossings, fit, loss
from studies.road.statistics import (
    HOLDS,
    OPEN,
    REFUTED,
    none_excess,
    rank_correlation,
    ratio,
    statements,
    verdict,
)

RESULTS = Path(__file__).parents[2] / "docs/validity/road/results.json"
COLUMNS = ["length_m", "width_m", "height_m", "qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m"]


def write_log(folder, rows):
    """Write boxes (time, track, category, points, x, y, yaw) of 4 by 2 by 1.5 m."""
    feather = pytest.importorskip("pyarrow.feather")
    from pyarrow import table

    folder.mkdir(parents=True)
    data = {"timestamp_ns": [r[0] for r in rows], "track_uuid": [r[1] for r in rows]}
    data |= {"category": [r[2] for r in rows], "num_interior_pts": [r[3] for r in rows]}
    values = [
        (4.0, 2.0, 1.5, np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2), x, y, 0.7)
        for *_, x, y, yaw in rows
    ]
    data |= dict(zip(COLUMNS, map(list, zip(*values, strict=True)), strict=True))
    feather.write_feather(table(data), folder / "annotations.feather")


def write_calibration(folder):
    feather = pytest.importorskip("pyarrow.feather")
    from pyarrow import table

    folder.mkdir(parents=True)
    names = ["up_lidar", "down_lidar"]
    data = {"sensor_name": names, "qw": [1.0, 0.0], "qx": [0.0, 1.0]}
    data |= {key: [0.0, 0.0] for key in ("qy", "qz", "ty_m")} | {"tx_m": [1.3, 1.3]}
    feather.write_feather(
        table(data | {"tz_m": [1.6, 1.5]}), folder / "egovehicle_SE3_sensor.feather"
    )


@pytest.mark.thorough
def test_a_log_is_read_without_the_vehicle_itself(tmp_path):
    rows = [
        (20, "b", "PEDESTRIAN", 7, 3.0, 4.0, 0.5),
        (10, "a", "REGULAR_VEHICLE", 90, 10.0, 0.0, -2.0),
        (10, "c", "EGO_VEHICLE", 0, 0.0, 0.0, 0.0),
        (10, "d", "ANIMAL", 1, 8.0, 6.0, 0.0),
    ]
    write_log(tmp_path / "one", rows)
    (log,) = read_logs(tmp_path)
    assert [CLASSES[k] for k in log.objects.labels] == ["pedestrian", "car", "other"]
    assert log.points.tolist() == [7, 90, 1] and log.objects.scenes.tolist() == [1, 0, 0]
    assert log.objects.yaws == pytest.approx([0.5, -2.0, 0.0])
    assert log.distance == pytest.approx([5.0, 10.0, 10.0])
    write_calibration(tmp_path / "one" / "calibration")
    up, down = read_lidars(tmp_path)
    assert up.pose.position == (1.3, 0.0, 1.6) and abs(down.pose.rotation_deg[0]) == 180.0
    with pytest.raises(InputError):
        read_logs(tmp_path / "one")


def test_figures_by_hand():
    n = np.array([0, 0, 2, 8, 5])
    m = np.array([0.0, 4.0, 2.0, 10.0, 0.2])
    assert ratio(n, m) == 0.8  # of 0, 1 and 0.8
    assert none_excess(n, m) == pytest.approx(0.0)
    assert none_excess(n, np.zeros(5)) == pytest.approx(0.6)
    assert rank_correlation(n, m) == pytest.approx(spearman(n.tolist(), m.tolist()))
    assert verdict("ratio", 0.85, 1.2) == HOLDS and verdict("ratio", 1.3, 2.0) == REFUTED
    assert verdict("none", -0.2, 0.05) == OPEN and verdict("rho", 0.3, 0.79) == REFUTED


def test_a_step_is_kept_for_a_percent_of_loss():
    losses = [
        dict(zip(models.STEPS, values, strict=True)) for values in [(1, 0.8, 0.7, 0.6, 0.597)]
    ]
    assert kept_step(losses) == FADING


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    """Cars in 30 frames whose points are those of a fill and a half distance."""
    write_calibration(tmp_path_factory.mktemp("road") / "log" / "calibration")
    rig = read_lidars(tmp_path_factory.getbasetemp() / "road0")
    rng = np.random.default_rng(3)
    count = 240
    distance = rng.uniform(6.0, 100.0, count)
    angle = rng.uniform(-3.0, 3.0, count)
    centers = np.stack([distance * np.cos(angle), distance * np.sin(angle), 0.0 * angle + 0.7], 1)
    objects = Objects(
        centers,
        np.tile([4.5, 1.9, 1.6], (count, 1)),
        rng.uniform(-3.0, 3.0, count),
        np.zeros(count, int),
        class_names=CLASSES,
        scenes=np.arange(count) // 8,
    )
    log = Log("simulated", objects, np.zeros(count, int), np.arange(count))
    truth = Fitted(FADING, np.full(len(CLASSES), 0.5), np.full(len(CLASSES), 56.2))
    (m,) = predicted(log, rig, [truth])
    return Log("simulated", objects, np.round(m).astype(int), np.arange(count)), rig


@pytest.mark.thorough
def test_the_fit_finds_the_values_of_simulated_points(simulated, monkeypatch):
    log, rig = simulated
    monkeypatch.setattr(models, "HALVES_M", np.array([30.0, 56.2, 100.0]))
    monkeypatch.setattr(models, "FILLS", np.array([0.3, 0.5, 0.8, 1.0]))
    beams = crossings(log, rig)
    found = fit(FADING, [beams])
    assert found.fill[0] == 0.5 and found.half[0] == 56.2
    solid = fit(SOLID, [beams]).predicted(beams)
    assert loss(log, found.predicted(beams)) < 0.1 < loss(log, solid)
    assert {name for name, _ in cells_of(log)} == {"car"}


def test_saved_conclusions_follow_from_the_cells():
    found = json.loads(RESULTS.read_text("utf-8"))
    assert kept_step(list(found["steps"].values())) == found["kept"]
    for step, saved in found["statements"].items():
        assert statements({log: by[step] for log, by in found["logs"].items()}) == saved


def test_the_engine_has_the_values_that_are_fitted_to_all_logs():
    saved = json.loads(RESULTS.read_text("utf-8"))["values"]["all logs"]
    shipped = {name: values for name, values in SURFACES.items() if name != ANY}
    assert shipped == {n: (saved[n]["fill"], saved[n]["half_m"]) for n in shipped}
    assert set(shipped) == set(saved) - {"other"}
    assert SURFACES[ANY] == (saved["other"]["fill"], saved["other"]["half_m"])
