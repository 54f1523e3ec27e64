"""The review picture: what it says, what it shows, and that it leaves the scene as it was."""

import dataclasses
import math

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

import pe_core as pe  # noqa: E402
from blender_addon import bridge  # noqa: E402
from blender_addon.review import captions, render_review  # noqa: E402
from blender_addon.review.picture_geometry import Frame, look_at  # noqa: E402
from pe_tools.graphics import PAPER  # noqa: E402

SIZE = (800, 450)


@pytest.fixture
def scene(addon):
    """A box for a car, a LiDAR on its roof and a camera at its front."""
    found = bpy.context.scene
    collection = bpy.data.collections.new("Car")
    found.collection.children.link(collection)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.9), scale=(4.4, 1.8, 1.2))
    body = bpy.context.object
    body.name = "body"
    found.collection.objects.unlink(body)
    collection.objects.link(body)
    found.perception_entropy.vehicle = collection
    add_sensor(found, "roof", "Pandar40", (0.0, 0.0, 1.8))
    add_sensor(found, "front", "Camera 60 deg", (2.3, 0.0, 1.2))
    bpy.context.view_layer.update()
    return found


def add_sensor(scene, name, model, location):
    thing = bpy.data.objects.new(name, None)
    thing.location = location
    scene.collection.objects.link(thing)
    thing.perception_entropy.is_sensor, thing.perception_entropy.model = True, model


@pytest.fixture
def outcome(scene):
    """A sampled score: quick."""
    study = bridge.study_from_scene(scene, bpy.context.evaluated_depsgraph_get())
    job = pe.ScoreJob(dataclasses.replace(study, samples=4096))
    for _ in job:
        pass
    return job.outcome


def optimized(outcome):
    """As if a search had raised the LiDAR by 0.4 m."""
    poses = [dataclasses.replace(s.pose) for s in outcome.study.rig]
    index = [s.name for s in outcome.study.rig].index("roof")
    poses[index] = pe.Pose((0.0, 0.0, 2.2), (0.0, math.radians(2.5), 0.0))
    study = outcome.study.with_rig(outcome.study.rig.with_poses(poses))
    after = dataclasses.replace(outcome.after, entropy=outcome.after.entropy - 0.5)
    return dataclasses.replace(outcome, kind="optimize", study=study, after=after)


def pixels_of(path):
    """(H, W, 3) sRGB values, 0 to 1."""
    image = bpy.data.images.load(str(path))
    values = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(image.size[1], image.size[0], image.channels)[..., :3]
    bpy.data.images.remove(image)
    return values


def state_of(scene):
    """Everything of the file that the review could have changed."""
    kinds = [
        each
        for each in dir(bpy.data)
        if isinstance(getattr(bpy.data, each), type(bpy.data.objects))
    ]
    names = {kind: sorted(each.name_full for each in getattr(bpy.data, kind)) for kind in kinds}
    render = scene.render
    settings = (
        render.engine, render.filepath, render.resolution_x, render.resolution_y,
        render.resolution_percentage, render.image_settings.file_format,
        scene.view_settings.view_transform, scene.display.shading.light, scene.display.render_aa,
    )  # fmt: skip
    users = {each.name: each.users for each in bpy.data.objects}
    places = {each.name: [list(row) for row in each.matrix_world] for each in scene.objects}
    camera, world = scene.camera, scene.world
    return names, settings, users, places, camera, world, bpy.context.scene.name


def near(pixels, color, least=0.1):
    """How many pixels have the hue of that sRGB colour: thin lines are mixed with grey."""
    wanted = np.array(color[:3]) - np.mean(color[:3])
    chroma = pixels - pixels.mean(axis=-1, keepdims=True)
    along = chroma @ (wanted / np.linalg.norm(wanted))
    aside = np.sqrt(np.maximum((chroma**2).sum(axis=-1) - along**2, 0.0))
    return int(((along > least) & (aside < 0.4 * along)).sum())


def test_picture(scene, outcome, tmp_path):
    before = state_of(scene)
    path = tmp_path / "review.png"
    assert render_review(scene, outcome.study, outcome, path, SIZE) == path
    assert state_of(scene) == before
    assert [each.name for each in tmp_path.iterdir()] == ["review.png"]
    pixels = pixels_of(path)
    assert pixels.shape == (450, 800, 3)
    assert pixels.std() > 0.05
    assert pixels[440, 5].min() > 0.85  # a light page
    for color in (PAPER.free, PAPER.stopped, PAPER.camera):
        assert near(pixels, color) > 50, color


def test_picture_of_a_search(scene, outcome, tmp_path):
    moved = optimized(outcome)
    render_review(scene, outcome.study, outcome, tmp_path / "a.png", SIZE)
    render_review(scene, moved.study, moved, tmp_path / "b.png", SIZE)
    first, second = pixels_of(tmp_path / "a.png"), pixels_of(tmp_path / "b.png")
    assert np.abs(first - second).mean() > 0.005


def test_picture_without_the_vehicles_collection(scene, outcome, tmp_path):
    scene.perception_entropy.vehicle = None
    before = state_of(scene)
    render_review(scene, outcome.study, outcome, tmp_path / "review.png", SIZE)
    assert state_of(scene) == before
    assert near(pixels_of(tmp_path / "review.png"), PAPER.stopped) > 50


def test_a_picture_that_fails_leaves_nothing(scene, outcome, tmp_path):
    before = state_of(scene)
    (tmp_path / "file").touch()
    with pytest.raises(pe.InputError, match="picture: expected a path that can be written"):
        render_review(scene, outcome.study, outcome, tmp_path / "file" / "review.png", SIZE)
    assert state_of(scene) == before


def test_words_of_a_score(outcome):
    words = captions.caption_of(outcome.study, outcome)
    assert words.headline == f"Perception entropy  {outcome.after.entropy:.3f}"
    assert f"{outcome.after.coverage:.1%}" in words.detail
    rows = {row[0]: row for row in words.table[1:]}
    assert rows["front"][:5] == ("front", "Camera 60 deg", "2.30, 0.00, 1.20", "0.0°", "0.0°")
    assert rows["front"][5] == "0.0%", "it looks away from the body"
    assert rows["roof"][5].endswith("% (body)")


def test_words_of_a_search(outcome):
    moved = optimized(outcome)
    words = captions.caption_of(moved.study, moved)
    entropies = f"{outcome.before.entropy:.3f} → {outcome.before.entropy - 0.5:.3f}"
    assert words.headline.endswith(entropies)
    rows = {row[0]: row for row in words.table[1:]}
    assert rows["roof"][2:4] == ("0.00, 0.00, 2.20", "2.5°")
    assert rows["roof"][6] == "0.00, 0.00, 1.80, 0.0°"


def test_numbers_as_people_write_them():
    assert captions.position(pe.Pose((-0.43, -0.001, 1.8))) == "−0.43, 0.00, 1.80"
    assert captions.angle(-2.46) == "−2.5°"
    assert captions.angle(-180.0) == "180.0°"


def test_the_view_holds_its_points_and_touches_its_frame():
    points = np.random.default_rng(0).uniform((-3, -2, 0), (3, 2, 2), (50, 3))
    frame = Frame(1600, 900, left=40, right=1500, top=100, bottom=700)
    view = look_at(points, frame)
    seen = view.pixels(points)
    low, high = seen.min(axis=0), seen.max(axis=0)
    assert (low > [39.99, 99.99]).all() and (high < [1500.01, 700.01]).all()
    gaps = [low[0] - 40, 1500 - high[0], low[1] - 100, 700 - high[1]]
    assert max(min(gaps[:2]), 0) < 0.01 or max(min(gaps[2:]), 0) < 0.01
    assert (view.depth(points) > 0).all()
