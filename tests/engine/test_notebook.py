"""What notebooks use: priors and vehicles of their own, functions as objectives, short values."""

from operator import methodcaller

import numpy as np
import pytest
import trimesh

import pe_core as pe
import pe_tools as pt
from pe_core.base.notebook import Tabular
from tests.engine.processes import finished
from tests.engine.shapes import box_car

html_of = methodcaller("_repr_html_")
"""A value as a notebook asks for it."""
SPACE = pe.PerceptionSpace((-10, 10), (-6, 6), (0, 2), 0.5)
LIDAR = pe.catalog.load("Velodyne VLP-16 Puck")


def car():
    body = box_car()
    return pe.Vehicle(body.triangles, body.parts, body.part_names)


def study(**more):
    sensors = [pe.Sensor("roof", LIDAR, pe.Pose((0.0, 0.0, 1.9)))]
    return pe.Study(pe.Rig(sensors), car(), SPACE, samples=1024, **more)


def voxels(prior, space=SPACE):
    """p_S of every voxel (nx, ny, nz)."""
    return sum(each.ground[:, :, None] * each.profile for each in prior.densities(space))


def bump(x, y, z):
    return np.exp(-(x**2 + 2.0 * y**2) / 30.0) / (1.0 + z)


def test_a_grid_and_a_function_give_the_share_of_each_voxel():
    centers = [SPACE.centers(axis) for axis in range(3)]
    weights = bump(*np.meshgrid(*centers, indexing="ij"))
    expected = weights / weights.sum()
    for prior in (pe.Prior.from_grid(weights, SPACE), pe.Prior.from_function(bump, SPACE)):
        assert np.allclose(voxels(prior), expected, rtol=0, atol=1e-15)
        assert len(prior.class_names) == SPACE.shape[2]
    flat = pe.Prior.from_function(lambda x, y, z: 1.0 + 0.0 * x, SPACE)
    assert flat.class_names == ("any",) and np.allclose(voxels(flat), voxels(pe.Prior.uniform()))
    along = pe.Prior.from_function(lambda x, y, z: 3.0 - z, SPACE)  # of z alone
    assert np.allclose(voxels(along)[0, 0], voxels(along)[3, 5]) and len(along.class_names) == 4


def test_a_grid_is_read_at_the_centres_of_another_space_and_takes_focus_weights():
    prior = pe.Prior.from_function(bump, SPACE)
    finer = pe.PerceptionSpace((-4, 30), (-3, 3), (0, 3), 0.25)
    found = voxels(prior, finer)
    own = voxels(prior)
    inside = found[:56, :, :8].reshape(28, 2, 12, 2, 4, 2)
    assert np.allclose(inside.max(axis=(1, 3, 5)), inside.min(axis=(1, 3, 5)))
    wanted = own[12:, 6:18]
    assert np.allclose(inside[:, 0, :, 0, :, 0] * 8.0, wanted / wanted.sum())
    assert not found[56:].any() and not found[:, :, 8:].any()
    halved = pe.Prior.from_grid(np.ones((40, 24)), SPACE, [pe.Focus(3.0, x=(0, 10))])
    assert voxels(halved)[20:].sum() == pytest.approx(0.75)


@pytest.mark.parametrize("by_height", [False, True])
def test_a_study_with_a_grid_is_written_and_read_to_the_bit(tmp_path, by_height):
    weights = np.random.default_rng(3).random(SPACE.shape if by_height else SPACE.shape[:2])
    one = study(prior=pe.Prior.from_grid(weights, SPACE))
    pt.export_study(one, tmp_path / "car.toml")
    again = pe.load_study(tmp_path / "car.toml")
    assert again.prior == one.prior and hash(again.prior.grid) == hash(one.prior.grid)
    assert again.evaluator().entropy(again.rig) == one.evaluator().entropy(one.rig)
    pt.write_outcome(job := finished(pt.ScoreJob(again)), tmp_path / "results")
    assert (tmp_path / "results" / "prior.npy").is_file() and job.after.entropy
    (tmp_path / again.prior.grid.file).unlink()
    with pytest.raises(pe.InputError):
        pe.save_study(again, tmp_path / "other.toml")


def test_a_scene_of_trimesh_is_a_vehicle_with_its_parts_in_place():
    low = trimesh.creation.box((4, 2, 1))
    scene = trimesh.Scene({"body": low, "path": trimesh.load_path(np.zeros((2, 2)))})
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 0, 1))
    turned[2, 3] = 1.0
    scene.add_geometry(trimesh.creation.box((2, 1, 1)), node_name="cabin", transform=turned)
    found = pe.Vehicle.from_trimesh(scene, glass=["cabin"], clearance=0.05)
    assert found.part_names == ("body", "cabin") and found.clearance == 0.05
    cabin = found.triangles[np.asarray(found.parts) == 1].reshape(-1, 3)
    assert np.allclose([cabin.min(axis=0), cabin.max(axis=0)], [[-0.5, -1, 0.5], [0.5, 1, 1.5]])
    one = pe.Vehicle.from_trimesh(low)
    assert np.array_equal(one.triangles, low.triangles) and one.part_names == ("vehicle",)
    for wrong in (3, trimesh.Scene(), trimesh.PointCloud(np.zeros((2, 3)))):
        with pytest.raises(pe.InputError):
            pe.Vehicle.from_trimesh(wrong)


def height(rig):
    return rig["roof"].pose.position[2]


def test_a_function_is_an_objective_here_and_in_workers():
    one = study()
    steps = [*pe.optimize(height, one.rig, one.search_space(), seed=2, evaluations=60)]
    assert steps[-1].entropy == height(steps[-1].best) < height(one.rig) - 0.5
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(2) as pool:
        there = pe.optimize(
            height, one.rig, one.search_space(), seed=2, evaluations=60, executor=pool
        )
        assert [step.entropy for step in there]


@pytest.fixture(scope="module")
def values():
    """Values of many types, big ones among them."""
    one = study()
    score = one.evaluator().score(one.rig)
    sight = one.sight()
    grid = pe.Prior.from_grid(np.ones((40, 24)), SPACE)
    boxes = pe.Boxes.of([("car", 5.0, 0.0, 0.75, 4.5, 1.8, 1.5, 0.0)] * 50)
    outcome = finished(pt.ScoreJob(one))
    step = next(pe.optimize(height, one.rig, one.search_space()))
    seen = sight.ground(one.rig), sight.blind(one.rig), sight.reach(one.rig, "car")
    area = pe.MountArea(car().triangles)
    field = pe.beam_field(one.rig["roof"], one.vehicle)
    maps = pe.Evaluator(SPACE, one.prior, one.vehicle).score(one.rig).ground_map
    return [
        one,
        one.rig,
        one.rig["roof"],
        one.vehicle,
        one.prior,
        grid,
        grid.grid,
        boxes,
        one.search,
        score,
        score.scatter,
        one.evaluator().summary(one.rig),
        outcome,
        step,
        *seen,
        area,
        LIDAR,
        pe.catalog.load("Camera 60 deg"),
        field,
        maps,
        one.search_space(),
        one.model,
    ]


def test_tables_are_html_and_data_frames(values):
    tabular = [value for value in values if isinstance(value, Tabular)]
    assert {type(value).__name__ for value in tabular} == {
        "Study",
        "Rig",
        "Vehicle",
        "Score",
        "Outcome",
    }
    for value in tabular:
        html = html_of(value)
        frame = value.to_pandas()
        assert html.count("<tr>") == len(frame) + 1 and html.count("<table>") == 1
        assert len(html) < 20_000
    score = next(value for value in values if isinstance(value, pe.Score))
    frame = score.to_pandas().set_index(["of", "name"])
    assert frame.loc[("rig", ""), "entropy [nats]"] == score.entropy
    assert frame.loc[("class", "car"), "share"] == score.per_class["car"].share
    lost = score.per_sensor["roof"]
    assert frame.loc[("sensor", "roof"), "occluded"] == lost.occluded / lost.beams
    named = study().rig.with_poses([pe.Pose((1, 2, 3))]).to_pandas()
    assert named.loc[0, ["x [m]", "y [m]", "z [m]"]].tolist() == [1, 2, 3]
    assert "&lt;b&gt;" in html_of(pe.Rig([pe.Sensor("<b>", LIDAR)]))


def test_plots_draw_on_given_axes_and_refuse_what_is_none():
    import matplotlib.pyplot as plt

    figure, ((top, right), (low, last)) = plt.subplots(2, 2)
    one = study()
    assert pt.plot.rig(one, view="top", axes=top) is top and len(top.lines) == 2
    assert pt.plot.beams(one, "roof", axes=right) is right
    drawn = sum(len(line.get_xdata()) for line in right.lines)
    assert drawn == LIDAR.beam_count
    assert pt.plot.ground(one, quantity="coverage", axes=low) is low and len(low.images) == 1
    score = one.evaluator().score(one.rig)
    pt.plot.compare({"one": score, "two": score}, axes=last)
    assert last.lines[0].get_xdata()[0] == score.entropy
    for wrong in (
        lambda: pt.plot.rig(one, view="left"),
        lambda: pt.plot.beams(one, "rof"),
        lambda: pt.plot.ground(one, quantity="price"),
        lambda: pt.plot.compare({}),
        lambda: pt.plot.compare({"one": 3}),
    ):
        with pytest.raises(pe.InputError):
            wrong()
    plt.close(figure)
