"""Published camera rigs: made-up ones are read, scored and judged by the plan's rules."""

import json
import math
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

import pe_core as pe
from pe_core import InputError
from pe_core.metric import H_BLIND
from studies.cameras import camera_curve, scores, statements
from studies.cameras.__main__ import QUICK, conclusions, tasks_of
from studies.cameras.published_rigs import FAMILY, JUDGED, RIGS, SIZES_M, PublishedRigs, read_rigs
from studies.detectors.scan_curves import A_BOUNDS, counts_of
from studies.ranks import bca_limits

from .conftest import study

ETRON = "vehicle.audi.etron"
TRUCK = "vehicle.carlamotors.firetruck"
AP = np.array([0.30, 0.25, 0.42, 0.33, 0.28, 0.36, 0.31, 0.45, 0.2, 0.22, 0.5, 0.38, 0.27, 0.41])


def made_up(change=lambda data: None):
    """Rigs of few cameras: the more rigs were before, the more cameras, and the higher AP."""

    def camera(yaw, hfov=65.0, z=1.5):
        pose = {"position": [0.0, 0.0, z], "rotation": [0.0, 0.0, yaw]}
        return {"name": "camera", "hfov_deg": hfov, **pose}

    rigs = {}
    ap = {"BEVDet": {}, "BEVFusion": {}}
    for k, name in enumerate(RIGS):
        count = 1 + k % 4
        rigs[name] = {
            "vehicle": TRUCK if name == "R6" else ETRON,
            "cameras": [camera(360.0 * c / count, 60.0 + k) for c in range(count)],
        }
        for shift, own in enumerate(ap.values()):
            own[name] = {key: 0.3 + 0.02 * k + 0.01 * shift for key in ("car", "adult", "mAP")}
    data = {"source": "made up", "rigs": rigs, "ap": ap}
    change(data)
    return data


@pytest.fixture
def rig_file(tmp_path):
    def write(change=lambda data: None):
        path = tmp_path / "rigs.json"
        path.write_text(json.dumps(made_up(change)), "utf-8")
        return path

    return write


def test_rigs_and_rivals_are_read(rig_file):
    rigs = read_rigs(rig_file())
    assert [rig.name for rig in rigs.rigs] == list(RIGS)
    assert rigs.rigs[0].rivals == {
        "number of cameras": 1.0,
        "pixels per degree": pytest.approx(1280 / 60),
        "mean height": 1.5,
    }
    assert rigs.ap("car")[:2] == pytest.approx([0.305, 0.325])
    sensor = rigs.rigs[1].rig["camera 1"]
    assert sensor.pose.rotation_deg[2] == pytest.approx(180.0, abs=1e-9)


def lower(data):
    data["rigs"]["R3"]["cameras"][0]["position"][2] = 0.2


def unknown(data):
    data["rigs"]["R3"]["vehicle"] = "vehicle.unknown"


def gone(data):
    del data["ap"]["BEVDet"]["R9"]["adult"]


def fewer(data):
    del data["rigs"]["R9"]


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (lower, "rigs.R3.cameras[0].position"),
        (unknown, "rigs.R3.vehicle"),
        (gone, "ap.BEVDet.R9.adult"),
        (fewer, "rigs"),
    ],
)
def test_a_file_with_other_rigs_is_refused(rig_file, change, field):
    with pytest.raises(InputError) as refused:
        read_rigs(rig_file(change))
    assert refused.value.field == field


def test_detectors_are_chosen_by_name(rig_file):
    assert list(read_rigs(rig_file(), ["BEVFusion"]).by_detector) == ["BEVFusion"]
    with pytest.raises(InputError):
        read_rigs(rig_file(), ["another"])


def test_entropy_of_the_seen_is_the_mean_of_seen_voxels():
    values = np.array([2.0, 4.0, H_BLIND, H_BLIND])
    assert scores.seen_entropy(float(values.mean()), 0.5) == pytest.approx(3.0)
    assert scores.seen_entropy(H_BLIND, 0.0) is None


def test_the_bodies_have_the_vehicles_size():
    for body, height in ((scores.PLATE, 0.3), (scores.SEDAN, None)):
        corners = scores.body_of(ETRON, body).triangles.reshape(-1, 3)
        size = np.ptp(corners, axis=0)
        assert size[:2] == pytest.approx(SIZES_M[ETRON])
        assert height is None or size[2] == pytest.approx(height)
    assert scores.body_of(ETRON, scores.SEDAN).clearance == 0.3


@pytest.fixture(scope="module")
def scored(tmp_path_factory):
    """One made-up rig, scored with little effort."""
    path = tmp_path_factory.mktemp("rigs") / "rigs.json"
    path.write_text(json.dumps(made_up()), "utf-8")
    rig = read_rigs(path).rigs[3]
    return rig, scores.scored_rig(rig, scores.PLATE, QUICK)


def test_scores_are_those_of_the_engine(scored):
    rig, found = scored
    space = pe.PerceptionSpace((-40, 40), (-40, 40), (0, 5), QUICK.interval)
    body = scores.body_of(rig.vehicle, scores.PLATE)
    part = pe.Evaluator(space, pe.Prior.road(), body).score(rig.rig).per_class["pedestrian"]
    adults = found["scores"]["adult"]
    assert adults[scores.ENTROPY] == -part.entropy
    assert adults[scores.COVERAGE] == part.coverage
    assert adults[scores.SEEN] == pytest.approx(-scores.seen_entropy(part.entropy, part.coverage))
    assert adults[scores.BLIND_SECTOR] == found["scores"]["car"][scores.BLIND_SECTOR]
    assert adults[scores.ENTROPY] != found["scores"]["car"][scores.ENTROPY]


def test_pixels_are_of_objects_that_are_seen_and_near(scored):
    _, found = scored
    for own in found["pixels"].values():
        assert len(own["m"]) == len(own["weights"]) > 0 and min(own["m"]) > 0.0
    cars = scores.targets_on(ETRON, scores.PLATE, 50.0, QUICK).drawn.objects
    assert len(found["pixels"]["car"]["m"]) < (cars.labels == 0).sum()


def figures_of(score, ap):
    """Figures of made-up scores: all five are `score` (14,), AP (14,) is that of all outcomes."""
    rows = {"car": ap, "adult": ap, "mAP": ap}

    rivals = ({"odd": float(k % 5), "even": float(k % 3)} for k in range(len(RIGS)))
    rigs = PublishedRigs(
        [SimpleNamespace(rivals=r) for r in rivals], {"one": rows, "two": rows}, ""
    )
    own = {
        name: {o: dict.fromkeys(scores.SCORES, float(v)) for o in rows}
        for name, v in zip(RIGS, score, strict=True)
    }
    effort = scores.CameraEffort(permutations=999, resamples=400)
    return statements.all_figures(rigs, own, effort)


def test_a_score_that_ranks_as_ap_does_holds_everywhere():
    figures = figures_of(AP * 2.0, AP)
    row = statements.verdicts(figures)[scores.ENTROPY]
    assert [row[k] for k in "12346"] == [statements.HOLDS] * 5
    assert set(row["5"].values()) == {statements.HOLDS} and row["shown"]
    assert statements.seen_becomes_figure(statements.verdicts(figures))
    cars = figures["outcomes"]["car"]["scores"][scores.ENTROPY]
    assert cars["family"] == {"rho": pytest.approx(1.0), "p": pytest.approx(2 / math.factorial(6))}


def test_a_score_against_ap_is_refuted():
    row = statements.verdicts(figures_of(-AP, AP))[scores.COVERAGE]
    assert [row[k] for k in "12346"] == [statements.REFUTED] * 5
    assert set(row["5"].values()) == {statements.REFUTED} and not row["shown"]


def test_a_score_that_does_not_differ_decides_nothing():
    row = statements.verdicts(figures_of(np.ones(14) + 1e-12 * AP, AP))[scores.SEEN]
    assert [row[k] for k in "1234"] == [statements.UNDECIDED] * 4 and not row["shown"]
    assert row["6"] == statements.REFUTED  # a tie is wrong


def test_ranking_needs_the_sign_over_rigs_that_are_apart():
    row = {"rho": 0.7, "interval": [0.2, 0.9], "holm": 0.01, "apart": {"rho": -0.1}}
    assert statements.ranks(row) == statements.UNDECIDED
    assert statements.ranks({**row, "apart": {"rho": 0.1}}) == statements.HOLDS
    assert statements.ranks({**row, "holm": 0.06}) == statements.UNDECIDED
    assert statements.ranks({**row, "interval": [-0.9, -0.1]}) == statements.REFUTED


def test_values_that_nearly_agree_are_equal():
    found = statements.near_equal(np.array([3.0, 1.0, 1.0 + 1e-12, 2.0]))
    assert found.tolist() == [3.0, 1.0, 1.0, 2.0]


def pixel_rows(rng, means):
    return {
        name: {
            "car": {"m": m.tolist(), "weights": [1.0] * len(m)},
            "adult": {"m": (m / 9.0).tolist(), "weights": [1.0] * len(m)},
        }
        for name, m in ((n, rng.lognormal(mean, 1.0, 60)) for n, mean in means.items())
    }


def test_the_curve_of_made_up_detectors_is_found_and_judged():
    rng = np.random.default_rng(4)
    pixels = pixel_rows(rng, {name: 5.0 + 0.2 * k for k, name in enumerate(RIGS)})
    truth = pe.ApCurve(0.11, -0.35)
    counts = counts_of([(np.array(r["car"]["m"]), np.ones(60)) for r in pixels.values()])
    ap = counts.expected_ap(truth) + 0.001 * rng.normal(size=len(RIGS))
    level = np.where(np.isin(RIGS, JUDGED), 0.1, 0.0)  # the level is the detector's own

    rigs = PublishedRigs([], {"one": dict.fromkeys(("car", "adult"), ap + level)}, "")
    effort = scores.CameraEffort(resamples=60)
    found = camera_curve.camera_curves(rigs, pixels, effort)["car"]
    assert found["a"] == pytest.approx(0.11, abs=0.01)
    assert found["rmse"]["fitted"] < 0.01 < found["plain_rmse"]["fitted"]
    assert found["verdicts"] == {k: statements.HOLDS for k in "789"}
    assert found["at_bound"] == 0 and found["m"][0] < found["m"][1]
    assert len(FAMILY) + len(JUDGED) == len(RIGS)


def test_bounds_and_centred_errors():
    assert camera_curve.is_at_bound(pe.ApCurve(A_BOUNDS[1], 0.0))
    assert not camera_curve.is_at_bound(pe.ApCurve(0.1, 0.0))
    assert camera_curve.centred_rmse(np.array([1.0, 3.0])) == pytest.approx(1.0)
    errors = np.array([0.1, -0.1, 0.2, -0.2])
    less, limits = camera_curve.difference_of(errors, 2.0 * errors, scores.CameraEffort())
    assert less == pytest.approx(-math.sqrt(0.025)) and limits[0] < less < limits[1] <= 0.0


def test_bca_limits_of_a_symmetric_statistic_are_percentiles():
    rng = np.random.default_rng(1)
    drawn = rng.normal(size=20_001)
    drawn -= np.median(drawn)
    low, high = bca_limits(0.0, drawn, np.array([-1.0, 1.0, -2.0, 2.0]))
    assert (low, high) == pytest.approx(np.percentile(drawn, [2.5, 97.5]), abs=0.05)


@pytest.mark.thorough
def test_the_command_scores_judges_and_goes_on(tmp_path, rig_file):
    path = rig_file()
    begin = partial(study, "cameras", path, "--quick", f"--work={tmp_path / 'work'}")
    run = begin("--workers=1", "-o", tmp_path / "page")
    assert run.returncode == 0, run.stderr
    data = json.loads((tmp_path / "page" / "results.json").read_text("utf-8"))
    assert len(data["scores"]) == len(RIGS) and set(data["verdicts"]) == set(scores.SCORES)
    text = (tmp_path / "page" / "README.md").read_text("utf-8")
    assert "0.305" not in json.dumps(data)  # no row of the file is kept
    again = begin("--workers=1", "-o", tmp_path / "page")
    assert again.returncode == 0 and "going on from" in again.stderr
    alone = study("cameras", "--page-only", "-o", tmp_path / "page")
    assert alone.returncode == 0 and (tmp_path / "page" / "README.md").read_text("utf-8") == text
    assert study("cameras", "-o", tmp_path / "page").returncode == 1


def test_conclusions_are_made_of_all_tasks(rig_file):
    rigs = read_rigs(rig_file())
    tasks = tasks_of(rigs, QUICK)
    assert len(tasks) == 14 + 13  # one rig is on no car
    own = {o: dict.fromkeys(scores.SCORES, 0.5) for o in ("car", "adult", "mAP")}
    pixels = {o: {"m": [50.0, 500.0], "weights": [1.0, 2.0]} for o in scores.CURVES}
    values = {task.name: {"scores": own, "pixels": pixels} for task in tasks}
    found = conclusions(rigs, values, scores.CameraEffort(permutations=9, resamples=9))
    assert not any(row["shown"] for row in found["verdicts"].values())
    assert found["data"] == rigs.digest and found["sedan"]["rigs"] == 13
