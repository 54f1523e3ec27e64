"""Our own study: its plan, scenes, points, targets, average precision, runs and page."""

import hashlib
import json
import re
import subprocess
import sys
from collections import Counter

import numpy as np
import pytest

from benchmarks.embree import Embree
from pe_core import InputError
from pe_core.geometry.ray_traversal import TriangleTree
from pe_core.geometry.raycast import VisibleTriangles
from pe_core.metric import H_BLIND
from pe_core.metric.entropy import ap_of_entropy
from studies.detectors.after_search import searched_placements
from studies.detectors.batches import (
    NEITHER,
    ClassScene,
    average_precision,
    detections,
    in_ring,
    inputs,
    targets,
)
from studies.detectors.casting import GROUND_M, MAX_POINTS, Caster, FreeBeams
from studies.detectors.page import Study, page, short_answer
from studies.detectors.placements import camera_placements, listing, placements
from studies.detectors.plan import (
    ACROSS,
    AFTER_SEARCH,
    CAMERAS,
    FIXED,
    GOOD,
    MIXED,
    OWN,
    PLAIN,
    SEARCHES,
    TOWN,
    full_after_search_plan,
    full_camera_plan,
    full_plan,
    quick_camera_plan,
    quick_plan,
    shape_of,
)
from studies.detectors.runs import RunFiles, run_digest, runs, seed_by_seed
from studies.detectors.scenes import scene
from studies.detectors.scores import COVERAGE, EXPECTED_AP, PRIMARY
from studies.detectors.second.analysis import FINDS_MORE
from tests.limits import HANG_S
from tests.studies.conftest import ROOT, study

FOLDER = ROOT / "docs" / "validity" / "own"
PLAN = full_plan()
DIGEST = "33306cc19714a1fa"
"""Of the plan that the study began with. A changed plan is another study, with its own results."""
SCENE = "bdedc09a393d7688"
"""Digest of what a placement sees in a scene: results of several sessions belong together."""
COARSE = """
import pe_core, studies.detectors.scores
studies.detectors.scores.SPACE = pe_core.PerceptionSpace(interval=0.2)
"""
"""Scores of an eighth of the voxels: here they only have to come."""
QUICKLY = f"""{COARSE}
import json, runpy, sys
folder, *options = sys.argv[1:]
for option in options:
    sys.argv = ["detectors", "--quick", "--resume", "--output", folder, option]
    try:
        runpy.run_module("studies.detectors", run_name="__main__")
    except SystemExit as end:
        assert not end.code, (option, end.code)
"""
TOWN_RUN = """
from studies.detectors.training import result_of
from studies.detectors.placements import placements
from studies.detectors.plan import POINTS, TOWN, quick_plan
from studies.detectors.runs import Run
plan = quick_plan()
counts = {"train": 4, "validation": 4, "test": 4}
plan = plan.but(scenes=counts)
print(json.dumps(result_of(plan, Run(placements(plan)[0], 1, TOWN, POINTS))))
"""


@pytest.fixture(scope="module")
def placement():
    return placements(PLAN)[0]


@pytest.fixture(scope="module")
def caster(placement):
    return Caster(PLAN, placement, PLAIN)


@pytest.fixture(scope="module")
def voxels(caster):
    return [caster.voxels("test", number) for number in range(4)]


def test_the_plan_and_its_placements_are_those_that_the_study_began_with():
    assert PLAN.digest == DIGEST != quick_plan().digest
    drawn = placements(PLAN)
    assert json.loads((FOLDER / "placements.json").read_text("utf-8")) == listing(DIGEST, drawn)
    assert len({p.name for p in drawn}) == len({p.poses for p in drawn}) == len(drawn)
    fixed = Counter((p.vehicle, p.all_round) for p in drawn if p.design == FIXED)
    assert fixed == {(v, r): 12 if r else 4 for v in ("sedan", "bus") for r in (True, False)}
    across = [p for p in drawn if p.design == ACROSS]
    hardware = {(len(p.poses), p.model) for p in across}
    assert hardware == {(n, model) for n in (1, 2, 4) for model in PLAN.hardware.values()}
    assert all(p.all_round for p in across) and len(across) == 18
    assert sum(p.design == MIXED for p in drawn) == 68
    assert sum(p.design != MIXED for p in placements(quick_plan())) == 3


def test_scenes_and_their_noise_are_the_same_in_every_session(voxels):
    digest = hashlib.sha256(voxels[0].cells.tobytes() + voxels[0].counts.tobytes())
    digest.update(voxels[0].beams.tobytes() + voxels[0].centers.tobytes())
    assert digest.hexdigest()[:16] == SCENE


@pytest.mark.parametrize("world", [PLAIN, TOWN])
def test_beams_end_where_embree_says(placement, world):
    content = scene(PLAN, "sedan", "train", world, number=1)
    embree = Embree.of(content.triangles)
    if embree is None:
        pytest.skip("embreex is not installed")
    lidar = FreeBeams(placement, 0)
    hits = VisibleTriangles(TriangleTree(content.triangles), lidar.origin)
    face = hits.first_hit(lidar.directions).face
    expected = embree.first_hit(lidar.origin, lidar.directions)
    owners, named = (np.where(f >= 0, content.owners[f], f) for f in (face, expected))
    assert (owners >= 0).sum() > 500
    assert ((owners != named) | ((face < 0) != (expected < 0))).mean() < 2e-4  # along an edge


@pytest.mark.parametrize("mirror", [NEITHER, (True, False), (False, True), (True, True)])
def test_a_perfect_heat_map_gives_the_objects_back(voxels, mirror):
    """Targets as outputs: every object that a beam meets is found where it is, mirrored alike."""
    heat, offsets, _ = targets(voxels, PLAN.region, [mirror] * len(voxels))
    signs = np.where(mirror, -1.0, 1.0)
    for k, each in enumerate(voxels):
        for c, (_, centers) in enumerate(detections(heat[k], offsets[k], PLAN.region)):
            objects = each.centers[(each.labels == c) & (each.beams > 0)] * signs
            tops = centers[: len(objects)]
            gaps = np.linalg.norm(objects[:, None] - tops[None], axis=2).min(axis=1, initial=9.0)
            assert (gaps < 1.2).all()  # two in one cell are one peak
            assert len(objects) == 0 or np.median(gaps) < 1e-4


def test_points_are_in_their_pillars_and_those_of_objects_come_first(caster):
    cloud = caster.cloud("test", 0)
    assert len(cloud.points) == MAX_POINTS
    heights = cloud.points[:, 2] > GROUND_M
    assert heights.any() and (heights == np.sort(heights)[::-1]).all()
    (features, pillars), (mirrored, others) = (
        inputs([cloud], PLAN.region, [mirror]) for mirror in (NEITHER, (True, False))
    )
    nx, ny = shape_of(PLAN.region)
    i, j = np.divmod(pillars[0], ny)
    x = (i + 0.5 + features[0, :, 0]) * PLAN.region.cell_m - PLAN.region.x_m
    y = (j + 0.5 + features[0, :, 1]) * PLAN.region.cell_m - PLAN.region.y_m
    assert np.abs(np.stack([x, y], axis=1) - cloud.points[:, :2]).max() < 1e-4
    same = (nx - 1 - others[0] // ny == i) & (others[0] % ny == j)
    assert same.mean() > 0.999  # but for points on an edge
    assert np.abs(mirrored[0, same, 1:] - features[0, same, 1:]).max() == 0.0


def scenes_of(*rows):
    """Scenes of a class, each with (scores, detected x, objects' x)."""
    return [
        ClassScene(np.array(s, float), on_axis(detected), on_axis(objects))
        for s, detected, objects in rows
    ]


def on_axis(x):
    return np.column_stack([x, np.zeros(len(x))]).astype(float).reshape(-1, 2)


def test_average_precision_by_hand():
    scenes = scenes_of(([0.9, 0.6], [10.3, 30.0], [10.0, 20.0]), ([0.8], [5.0], [5.1]))
    # right, right, wrong; three objects: precision 1 to a recall of 2/3
    assert average_precision(scenes, 0.5) == pytest.approx(2 / 3)
    assert average_precision(scenes, 0.2) == pytest.approx(
        (1 / 2) / 3
    )  # the second of two is right
    assert average_precision(scenes_of(([0.9], [1.0], [])), 1.0) is None
    assert average_precision(scenes_of(([], [], [1.0])), 1.0) == 0.0


def test_an_object_is_found_once_and_rings_cut_both():
    twice = scenes_of(([0.9, 0.8], [10.0, 10.1], [10.0, 40.0]))
    assert average_precision(twice, 1.0) == pytest.approx(1 / 2)
    assert average_precision([in_ring(twice[0], 0.0, 15.0)], 1.0) == 1.0
    assert average_precision([in_ring(twice[0], 30.0, 60.0)], 1.0) == 0.0


def test_files_of_another_plan_are_refused(tmp_path):
    files = RunFiles(tmp_path, quick_plan(), runs(quick_plan()))
    first, second = files.all[:2]
    files.write(first, {"ap": 0.5})
    assert files.missing()[0] == second and files.read() == {
        first.name: {"schema": 1, "plan": quick_plan().digest, "run": first.name, "ap": 0.5}
    }
    other = RunFiles(tmp_path, quick_plan().but(digest="other"), files.all)
    with pytest.raises(InputError, match="plan"):
        other.read()
    files.write(first, {"ap": 1.5})
    with pytest.raises(InputError, match="ap"):
        files.read()


def in_a_process(script, *arguments):
    """Run Python beside this one: what TensorFlow loads would end a later picture of bpy's."""
    command = [sys.executable, "-c", script, *map(str, arguments)]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=HANG_S)
    assert answer.returncode == 0, answer.stderr
    return answer.stdout


@pytest.mark.trains_detectors
def test_the_quick_studies_run_whole_and_repeated_runs_have_the_same_results(tmp_path):
    """All in one process, but for what is repeated."""
    said = in_a_process(QUICKLY + TOWN_RUN, tmp_path, "--runs=4", "--cameras", "--after-search")
    for told in ("4 of 4 runs", "2 of 2 runs of cameras", "3 of 3 runs before and after a search"):
        assert f"{told} are done" in said
    assert "## After a search" in (tmp_path / "README.md").read_text("utf-8")
    step = json.loads(said.splitlines()[-1])
    assert step["training"]["epochs"] == 2 and 0.0 <= step["ap"] <= 1.0
    made = {k: step["made"][k] for k in ("python", "numpy", "tensorflow")}
    assert step["made"]["digest"] == run_digest(quick_plan().digest, made)
    names = ("runs/fixed-sedan-01-s1.json", "cameras/runs/cameras-sedan-01-s1.json")
    first = results_of_runs(tmp_path, names)
    for name in names:
        (tmp_path / name).unlink()
    in_a_process(QUICKLY, tmp_path, "--runs=4", "--cameras")
    assert results_of_runs(tmp_path, names) == first
    assert all(0.0 < data["ap"] < 1.0 for data in first)


def results_of_runs(folder, names):
    """What two runs of the same detector have in common."""
    found = [json.loads((folder / name).read_text("utf-8")) for name in names]
    for data in found:
        del data["seconds"], data["training"]["training_seconds"]
        del data["made"]["commit"]  # another one if someone commits meanwhile
    return found


def saved(folder="."):
    return json.loads((FOLDER / folder / "results.json").read_text("utf-8"))


def test_the_page_is_that_of_the_saved_results():
    cameras = full_camera_plan()
    searches = full_after_search_plan()
    done = RunFiles(FOLDER, PLAN, runs(PLAN)).read()
    with_cameras = seed_by_seed(cameras, camera_placements(cameras))
    camera_runs = RunFiles(FOLDER / CAMERAS, cameras, with_cameras).read()
    after = seed_by_seed(searches, searched_placements(searches, FOLDER / AFTER_SEARCH))
    after_runs = RunFiles(FOLDER / AFTER_SEARCH, searches, after).read()
    found = {name: saved(name) for name in (OWN, CAMERAS, AFTER_SEARCH)}
    for results, runs_done in ((found[OWN]["runs"], done), (found[CAMERAS], camera_runs)):
        assert results["done"] == len(runs_done)
    plans = {OWN: PLAN, CAMERAS: cameras, AFTER_SEARCH: searches}
    whole = Study(plans, found, {OWN: done, AFTER_SEARCH: after_runs, CAMERAS: camera_runs})
    outside = json.loads((FOLDER / "segmentation.json").read_text("utf-8"))
    assert (FOLDER / "README.md").read_text("utf-8") == page(whole, outside)
    answer = short_answer(PLAN, found[OWN], found[AFTER_SEARCH], found[CAMERAS])
    assert found[OWN]["answer"] == answer


def test_the_page_of_validity_gives_the_answer_of_the_study():
    answer = saved()["answer"]
    blocks = (ROOT / "docs/validity/README.md").read_text("utf-8").split("\n\n")
    (told,) = (text for b in blocks if answer in (text := " ".join(b.split())))
    study = told.find("ur own study]")
    published = told.find("ublished")
    assert study >= 0 and (published < 0 or study < published), "our own study comes first"


def test_the_readme_says_in_few_words_what_to_go_by_and_what_a_number_means():
    """Ninety, and twenty-five about cameras."""
    whole = (ROOT / "README.md").read_text("utf-8")
    section = whole.split("## Is it valid?\n")[1].split("\n## ")[0]
    told = re.sub(r"\]\([^)]*\)", "]", " ".join(section.split()))
    assert len(told.replace("- ", "").split()) <= 115
    second = json.loads((FOLDER / "second/results.json").read_text("utf-8"))
    searches = second[SEARCHES]["minus_entropy"]
    good = second[GOOD]
    more = [ring for ring, row in searches.items() if row["verdict"] == FINDS_MORE[1]]
    assert more == list(searches)[1:]
    figures = (good["figures"][name]["rho"] for name in (EXPECTED_AP, COVERAGE, PRIMARY))
    of_the_study = [str(len(good["placements"])), *(f"{rho:.2f}" for rho in figures)]
    entropy = re.search(r"^entropy +([\d.]+) ", whole, re.MULTILINE)[1]
    of_a_number = [entropy, f"{float(ap_of_entropy(float(entropy))):.2f}", f"{H_BLIND:.2f}"]
    cameras = json.loads((ROOT / "docs/validity/cameras/results.json").read_text("utf-8"))
    of_cars = cameras["outcomes"]["car"]
    seen = of_cars["scores"]["entropy of the seen"]["rho"]
    rival = of_cars["rivals"]["pixels per degree"]["rho"]
    of_cameras = [str(len(cameras["scores"])), f"{seen:.2f}", f"{rival:.2f}"]
    expected = [*of_the_study, more[0].split()[0], *of_a_number, *of_cameras]
    assert re.findall(r"\d+(?:\.\d+)?", told) == expected
    assert told.index("blind sector") < told.index("Cameras") < told.index("Not shown")


@pytest.mark.parametrize(
    ("folder", "option", "told"),
    [(".", "--quick", "1 of 4 runs"), (CAMERAS, "--cameras", "1 of 2 runs")],
)
def test_results_that_are_there_are_gone_on_with_by_resume_alone(tmp_path, folder, option, told):
    run = "fixed-sedan-01-s1" if folder == "." else "cameras-sedan-01-s1"
    plan = quick_plan() if folder == "." else quick_camera_plan()
    path = tmp_path / folder / "runs" / f"{run}.json"
    path.parent.mkdir(parents=True)
    data = {"schema": 1, "plan": plan.digest, "run": run, "ap": 0.5}
    path.write_text(json.dumps(data), "utf-8")
    answer = study("detectors", "--quick", option, f"--output={tmp_path}")
    assert answer.returncode == 1 and f"{told}; pass --resume" in answer.stderr
