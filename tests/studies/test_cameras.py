"""The study of cameras: placements, pictures, where cells of the ground are in them, statements."""

import json

import numpy as np
import pytest

from studies.detectors import pictures as rendering
from studies.detectors.analysis import HOLDS, OPEN, camera_analysis
from studies.detectors.batches import STRIDE
from studies.detectors.page import answer_of_cameras
from studies.detectors.pictures import HEIGHTS_M, Lifting
from studies.detectors.placements import (
    Placement,
    camera_model,
    camera_placements,
    in_picture,
    listing,
)
from studies.detectors.plan import CAMERAS, full_camera_plan, quick_camera_plan
from studies.detectors.runs import seed_by_seed
from studies.detectors.scenes import Scene
from studies.detectors.shapes import solid
from tests.studies.conftest import ROOT

PLAN = full_camera_plan()
MODEL = camera_model(PLAN.cameras.rig)
FOLDER = ROOT / "docs" / "validity" / "own" / "cameras"
DIGEST = "ab094c698eca1191"
"""Of the plan that the study began with. A changed plan is another study, with its own results."""
AHEAD = Placement(
    "one", "sedan", ((1.9, 0.0, 1.5, 0.0, 0.0, 0.0),), all_round=False, design=CAMERAS, model=""
)
"""One level camera in front of the windscreen."""


def test_the_plan_is_the_one_that_the_study_began_with():
    assert PLAN.digest == DIGEST != quick_camera_plan().digest


def test_the_placements_are_those_that_the_rule_draws_and_look_outwards():
    drawn = camera_placements(PLAN)
    assert json.loads((FOLDER / "placements.json").read_text("utf-8")) == listing(DIGEST, drawn)
    assert [p.all_round for p in drawn] == 6 * [True] + 2 * [False]
    assert len({p.poses for p in drawn}) == 8
    for placement in drawn:
        poses = np.array(placement.poses)
        directions = np.stack([np.cos(a := np.radians(poses[:, 5])), np.sin(a)], axis=1)
        assert (poses[:, :2] * directions).sum() > 1.0  # outwards on the whole [m]
        gaps = np.diff(np.sort(poses[:, 5] % 360.0))
        assert (
            (gaps > 90.0 - 2.0 * PLAN.cameras.placements.yaw_deg - 0.1)
            & (gaps < 90.0 + 2.0 * PLAN.cameras.placements.yaw_deg + 0.1)
        ).all()


def test_rays_through_pixels_are_where_the_lens_puts_them():
    camera = rendering.FreePixels(PLAN, AHEAD, 0)
    columns, rows, inside = in_picture(MODEL, camera.directions)  # level: axes are the ground's
    at = np.argwhere(camera.free) + 0.5
    assert inside.all()
    assert np.abs(np.stack([columns, rows], axis=1) - at).max() < 1e-6


@pytest.fixture
def box_ahead(monkeypatch):
    """A scene with a cube of 2 m, 10 m ahead, as the only object."""
    triangles = solid((9.0, 11.0), (-1.0, 1.0), (0.0, 2.0))
    none = np.zeros(len(triangles), np.int64)
    content = Scene(triangles, none, none, np.array([[10.0, 0.0]]), labels=np.array([0]), flat=True)
    monkeypatch.setattr(rendering, "scene", lambda *_, **__: content)


def test_a_cube_covers_the_pixels_that_its_face_does(box_ahead):
    scene = rendering.Renderer(PLAN, AHEAD).pictures("test", 0)
    f = MODEL.focal_px
    distance = 9.0 - 1.9
    width = 2.0 * f / distance
    height = 2.0 * f / distance
    assert scene.beams[0] == pytest.approx(width * height, rel=0.12)
    picture = scene.pictures[0].astype(float)
    row = MODEL.height // 2
    middle, beside = (picture[slice(*c), row].mean(axis=0) for c in ((90, 102), (20, 60)))
    assert np.abs(middle - beside).max() > 15.0
    edges = np.abs(np.diff(picture[:, row + 2].sum(axis=-1)))
    assert sorted(np.argsort(edges)[-2:]) == pytest.approx(
        [96 - width / 2, 96 + width / 2], abs=1.5
    )


def test_cells_take_their_features_from_where_they_are_in_the_picture():
    placement = camera_placements(PLAN)[0]
    lifting = Lifting.of(PLAN, placement)
    cameras = rendering.Renderer(PLAN, placement).cameras
    _, columns, rows, _ = lifting.nearness.shape
    region = PLAN.region
    side = STRIDE * PLAN.region.cell_m
    total = len(cameras) * columns * rows
    rng = np.random.default_rng(4)
    cells = rng.choice(np.flatnonzero((lifting.pixels[:, :, 0] < total).all(axis=1)), 60)
    for cell in cells:
        i, j = divmod(int(cell), lifting.cells.shape[1])
        for k, z in enumerate(HEIGHTS_M):
            point = ((i + 0.5) * side - region.x_m, (j + 0.5) * side - region.y_m, z)
            number, column, row = np.unravel_index(
                lifting.pixels[cell, k, 0], (len(cameras), columns, rows)
            )
            camera = cameras[number]
            rays = np.full((*camera.free.shape, 3), np.nan)
            rays[camera.free] = camera.directions
            block = rays[STRIDE * column : STRIDE * (column + 1), STRIDE * row : STRIDE * (row + 1)]
            offset = np.array(point) - camera.origin
            cosines = block @ (offset / np.linalg.norm(offset))
            assert np.nanmax(cosines) > np.cos(1.0 / MODEL.focal_px)  # within a pixel
    assert set(np.unique(lifting.shares)) <= {0.0, 0.5, 1.0}
    assert (lifting.shares[lifting.pixels == total] == 0.0).all()


def made_up(noise=0.0, missing=0, sign=1.0):
    """Results in which AP follows the primary score; the last `missing` runs are not done."""
    names = [p.name for p in camera_placements(PLAN)]
    rng = np.random.default_rng(5)
    runs = seed_by_seed(PLAN, camera_placements(PLAN))
    aps = {r.name: 0.3 + sign * 0.01 * names.index(r.placement.name) for r in runs}
    part = {"entropy": 1.0, "ap": 0.5}
    training = {"epochs": 20, "converged": False}
    rows = {"training": training, "seconds": 300.0, "made": {"commit": "abc"}}
    done = {
        name: {"ap": ap + noise * float(rng.uniform()), **rows}
        for name, ap in list(aps.items())[: len(aps) - missing]
    }
    scores = {
        name: {
            "road": {"entropy": -float(k), "coverage": 0.5},
            "uniform": -float(k % 3),
            "alone": part,
            "traffic": part,
            "beams": 0,
        }
        for k, name in enumerate(names)
    }
    return done, scores


def said(done, scores):
    plan = PLAN.but(statistics={"permutations": 999, "resamples": 60})
    found = camera_analysis(plan, done, scores)
    return found["verdict"], found, answer_of_cameras(plan, found)


def test_a_statement_needs_all_runs():
    verdict, found, text = said(*made_up())
    assert verdict == HOLDS and "finds more" in text
    assert found["scores"][PLAN.statistics.primary]["rho"] == pytest.approx(1.0)
    assert "holm" not in found["scores"][PLAN.statistics.primary]
    verdict, found, text = said(*made_up(missing=1))
    assert verdict == OPEN and "no statement before all runs are done" in text
    assert (found["done"], found["planned"]) == (15, 16)
    done, scores = made_up()
    few = {name: run for name, run in done.items() if "sedan-01" not in name}
    verdict, found, text = said(few, scores)  # five that see all round: too few for their column
    assert verdict == OPEN and found["all_round"] == {}
    verdict, found, text = said({}, {})
    assert verdict == OPEN and found["scores"] == {} and found["done"] == 0
