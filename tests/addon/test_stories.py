"""Ways through the add-on from beginning to end, each in one scene, as a designer goes.

The drag that the live score follows is in `test_live`.
"""

import json
import math

import bpy
import numpy as np
import pytest

from blender_addon import document
from blender_addon.caches import consistency, result_staleness
from blender_addon.engine import exchange, jobs, outputs, page, pe, search, studies, text
from blender_addon.operators import compare_variants
from blender_addon.panels import main
from blender_addon.queries import diagnostics
from tests.addon import layouts, scenes
from tests.engine.processes import finished

PUCK = "Velodyne VLP-16 Puck"
CAMERA = "Camera 60 deg"
FORMATS = ("urdf", "carla", "autoware", "csv")
ODD = {
    "upside_down": lambda eye: setattr(eye, "rotation_euler", (math.pi, 0.0, 0.0)),
    "refused": lambda eye: setattr(eye, "scale", (2.0, 2.0, 2.0)),
    "units": lambda _: setattr(bpy.context.scene.unit_settings, "system", "IMPERIAL"),
}


def without_run(data: dict) -> dict:
    """A result without what differs from run to run."""
    data = json.loads(text.dump_json(data))
    del data["run"]
    for score in (data["before"], data["after"]):
        score.pop("figures", None)  # beside it in result.json
        score.pop("scatter", None)  # for the error of a difference: no part of result.json
    return data


def stored(scene) -> dict:
    return without_run(json.loads(scene.perception_entropy.result_json))


def poses() -> dict:
    return {sensor.name: (sensor.pose, sensor.model) for sensor in scenes.study().rig}


def names(rows) -> list[str]:
    return [row.name for row in rows]


def test_place_score_optimize_check_and_export(scene, tmp_path, small_pictures):
    settings = scene.perception_entropy
    scenes.add_car(scene)
    bpy.context.view_layer.update()

    # Place: a LiDAR by a point of the roof, a camera and its mirror image.
    assert bpy.ops.pe.place_sensor(model=PUCK, location=(-0.4, 0.0, 1.5)) == {"FINISHED"}
    roof = bpy.context.object
    assert tuple(roof.location) == pytest.approx((-0.4, 0.0, 1.65), abs=1e-6)
    eye = scenes.add_sensor("eye_left", "Camera 60 deg", location=(1.9, 0.5, 0.8))
    bpy.ops.pe.mirror_sensor(name="eye_left")
    for obj in (eye, scene.objects["eye_right"]):
        obj.perception_entropy.free = (False,) * 6
    bpy.context.view_layer.update()

    # Score: the engine's own result, to the bit.
    assert bpy.ops.pe.score() == {"FINISHED"}
    start = poses()
    assert stored(scene) == without_run(jobs.result_dict(finished(jobs.ScoreJob(scenes.study()))))
    labels = layouts.drawn(main.main, **vars(layouts.Window(scene))).texts("label")
    assert any("Blind ground" in label for label in labels)

    # Optimize: what the engine finds is placed, scored and kept; undo takes the poses back.
    first = settings.result.entropy
    expected = finished(jobs.OptimizeJob(scenes.study()))
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.pe.optimize("EXEC_DEFAULT", True) == {"FINISHED"}
    found = poses()
    assert found == {s.name: (s.pose, s.model) for s in expected.study.rig} != start
    assert found["eye_left"] == start["eye_left"], "it was held"
    assert stored(scene) == without_run(jobs.result_dict(expected))
    assert finished(jobs.ScoreJob(scenes.study())).after == expected.after
    bpy.ops.ed.undo()
    scene = bpy.context.scene
    settings = bpy.context.scene.perception_entropy
    assert poses() == start and settings.result.entropy == first
    assert names(settings.variants) == ["Before optimize", "Optimized, seed 0"]
    bpy.ops.pe.switch_variant(key=settings.variants[1].key)
    assert poses() == found and settings.result.entropy == pytest.approx(expected.after.entropy)

    # Check: rows of verdicts are the engine's.
    bpy.ops.pe.add_row(rows="requirements", kind="OWN")
    assert bpy.ops.pe.check_requirements() == {"FINISHED"}
    (verdict,) = scenes.study().verdicts()
    (row,) = settings.requirements
    assert document.stored_verdict(row) == verdict.summary

    # Export: what is written is of this scene, and scores the same.
    study, glb, review = (tmp_path / n for n in ("car.toml", "car.glb", "for <all>.html"))
    assert bpy.ops.pe.export_file(filepath=str(study)) == {"FINISHED"}
    outcome = finished(jobs.ScoreJob(pe.load_study(study)))
    assert outcome.after == expected.after
    assert bpy.ops.pe.export_file(filepath=str(glb), format="gltf") == {"FINISHED"}
    assert glb.read_bytes() == outputs.scene_files(scenes.study(), "gltf", None)[0]["scene.glb"]
    review.write_text("mine")  # the file dialog has asked
    said = {"title": "Roof & rails", "author": "A. Author", "date": "May", "revision": "B"}
    assert bpy.ops.pe.export_file(filepath=str(review), **said) == {"FINISHED"}
    told = review.read_text("utf-8")
    assert told.count('="The vehicle with 1 LiDAR') == 1
    assert "<h1>Roof &amp; rails</h1>" in told and "A. Author, May, Revision B</p>" in told
    picture = tmp_path / "car.svg"
    assert bpy.ops.pe.export_file(filepath=str(picture)) == {"FINISHED"}
    assert picture.read_bytes() == page.picture_file(scenes.study(), outcome)


def test_import_rigs_and_compare_them(car, tmp_path):
    settings = car.perception_entropy
    place = {"location": (1.5, 0.1, 1.3), "rotation_euler": (0.0, 0.1, 0.2)}
    scenes.add_sensor("eye", "Front 120 deg 8 MP", **place)
    document.put(settings, document.REFERENCE, studies.write(pe.Reference(-1.31, 0.33, 2.8)))
    before = scenes.study().rig

    # A rig leaves for another program and comes back as a variant; what stood here is kept.
    for name in FORMATS:
        row = exchange.rig_format(name)
        path = tmp_path / (row.files[0] if len(row.files) == 1 else name)
        assert bpy.ops.pe.export_file(filepath=str(path), format=name) == {"FINISHED"}
        chosen = path / row.files[0] if len(row.files) > 1 else path
        assert bpy.ops.pe.import_file(filepath=str(chosen)) == {"FINISHED"}
        assert settings.variants[0].name == "Unsaved"
        assert document.active_variant(car).note.startswith("Read from")
        theirs = sorted(scenes.study().rig, key=lambda s: s.pose.position)
        for ours, other in zip(sorted(before, key=lambda s: s.pose.position), theirs, strict=True):
            assert other.kind == ours.kind
            assert other.pose.position == pytest.approx(ours.pose.position, abs=1e-5)
            turned = other.pose.ground_from_sensor - ours.pose.ground_from_sensor
            assert np.abs(turned).max() < 1e-5

    # A known rig is fitted to this vehicle.
    bpy.ops.pe.switch_variant(key=settings.variants[0].key)
    count = len(settings.variants)
    bpy.ops.pe.add_rig(key="kitti")
    assert len(settings.variants) == count + 1 and not settings.variant_changed
    top = scenes.study().vehicle.bounds[1][2]
    lidar = scenes.study().rig["velodyne"].pose.position
    assert lidar[2] == pytest.approx(top + 1.73 - 1.52, abs=1e-4)

    # Compared: each is scored as if it stood there, and nothing in the scene moves.
    for name in [row.name for row in settings.variants if row.name not in ("Unsaved", "KITTI")]:
        bpy.ops.pe.remove_row(rows="variants", index=settings.variants.find(name))
    start = poses()
    study = scenes.study()
    assert bpy.ops.pe.compare_variants() == {"FINISHED"} and poses() == start
    shown, table = compare_variants.comparison_of(car)
    assert shown == ["KITTI", "Unsaved"]
    whole = next(row for row in table if row.group == "rig" and row.measure == "entropy")
    assert whole.values[0] == study.evaluator().score(study.rig).entropy
    order = [[*search.FIGURES].index(each) for each in ("blind_ground", "reach", "entropy")]
    assert order == sorted(order), "what a designer asks for comes first"
    text, _, change, _ = compare_variants.cell_of(whole, 1)
    assert text == f"{whole.values[1]:.3f}"
    assert change.startswith(f"({whole.differences[1]:+.3f} ± "), "with its standard error"
    bpy.ops.pe.switch_variant(key=settings.variants["Unsaved"].key)
    assert {s.name for s in scenes.study().rig} == {"roof", "eye"}


def base_of(name) -> float:
    """Height of the middle of a puck's base [m]: 37.7 mm below its origin."""
    pose = scenes.study().rig[name].pose
    return float((np.array(pose.position) - 0.0377 * pose.ground_from_sensor[:, 2])[2])


def test_mount_bound_tie_and_search(car, tmp_path):
    settings = car.perception_entropy
    settings.score_samples = settings.search_samples = 1024
    settings.candidates = 1
    roof = car.objects["roof"]
    cabin = car.objects["cabin"]

    # A mount of painted faces: the sensor moves onto it.
    scenes.paint(cabin, "top", lambda co: 1.0 if co.z > 0 else 0.0)
    scenes.add_mount(car, "roof area", faces="GROUP", group="top", standoff=0.04)
    roof.location.y = 0.3
    assert bpy.ops.pe.mount_sensor(name="roof", mount="roof area") == {"FINISHED"}
    bpy.context.view_layer.update()
    faces = scenes.study().search.mounting.mounts["roof area"].area.triangles
    assert len(faces) == 2 and np.abs(faces[..., 2] - 1.5).max() < 1e-6
    assert base_of("roof") == pytest.approx(1.54, abs=1e-5)

    # Its mirror image follows, a camera is bound, and no sensor may be in a box.
    bpy.ops.pe.mirror_sensor(name="roof", linked=True)
    eye = scenes.add_sensor("eye", "Camera 60 deg", location=(1.9, 0.0, 0.8))
    eye.perception_entropy.free = (True, *(False,) * 5)
    eye.perception_entropy.bounded[0] = True
    car.cursor.location = (0.0, 0.0, 3.0)
    bpy.ops.pe.add_no_go()
    bpy.context.view_layer.update()
    study = scenes.study()
    assert study.search.mounting.on == {"roof": "roof area"}
    assert study.search.limits == {"eye": {"x": pytest.approx((1.4, 2.4))}}
    assert names(study.search.mounting.constraints.no_go) == ["no_go"]

    # The search keeps to all of it; the study's file gives the same search.
    bpy.ops.pe.export_file(filepath=str(tmp_path / "car.toml"))
    there = jobs.OptimizeJob(pe.load_study(tmp_path / "car.toml"))
    outcome = finished(there)
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    consistency.repair_scenes()
    rig = scenes.study().rig
    assert [s.pose for s in rig] == [s.pose for s in outcome.study.rig]
    assert base_of("roof") == pytest.approx(1.54, abs=1e-5), "still on the roof"
    image = rig["roof right"].pose.position
    assert image == pytest.approx(np.array(rig["roof"].pose.position) * (1, -1, 1), abs=2e-5)
    assert 1.4 <= rig["eye"].pose.position[0] <= 2.4

    # A variant holds what ties the sensors.
    bpy.ops.pe.save_variant()
    bpy.ops.pe.unlink_mirror(name="roof")
    roof.perception_entropy.mount = ""
    bpy.ops.pe.switch_variant(key=settings.variants[-1].key)
    own = roof.perception_entropy
    assert (own.mirror_of, own.mount) == ("roof right", "roof area")


def test_undo_save_and_reload(car, tmp_path):
    settings = car.perception_entropy
    bpy.ops.ed.undo_push(message="before")
    start = poses()

    # Each act is one step of undo.
    acts = (
        (lambda: bpy.ops.pe.add_sensor("EXEC_DEFAULT", True, model="Camera 60 deg"), "sensors"),
        (lambda: bpy.ops.pe.add_row("EXEC_DEFAULT", True, rows="focus", kind="front"), "focus"),
        (
            lambda: bpy.ops.pe.add_row("EXEC_DEFAULT", True, rows="weathers", kind="RAIN"),
            "weathers",
        ),
        (lambda: bpy.ops.pe.add_row("EXEC_DEFAULT", True, rows="states"), "states"),
        (
            lambda: bpy.ops.pe.add_row("EXEC_DEFAULT", True, rows="requirements", kind="OWN"),
            "requirements",
        ),
        (lambda: bpy.ops.pe.save_variant("EXEC_DEFAULT", True), "variants"),
        (
            lambda: bpy.ops.pe.add_row("EXEC_DEFAULT", True, rows="own_sensors", kind="lidar"),
            "own_sensors",
        ),
    )

    def count(what) -> int:
        scene = bpy.context.scene
        if what == "sensors":
            return len(document.sensor_objects(scene))
        return len(getattr(scene.perception_entropy, what))

    for act, what in acts:
        before = count(what)
        assert act() == {"FINISHED"}
        assert count(what) == before + 1, what
        bpy.ops.ed.undo()
        assert count(what) == before, what
    assert poses() == start

    # What is saved comes back: sensors, settings, result, variants, and what stands here.
    for act, _ in acts:
        act()
    settings = bpy.context.scene.perception_entropy
    settings.own_sensors[0].channels = 5
    consistency.repair_scenes()  # as Blender's timer does: each sensor has a colour
    bpy.ops.pe.score()
    before = poses()
    entropy = settings.result.entropy
    table = pe.study_to_dict(scenes.study())
    blend = str(tmp_path / "car.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert "My LiDAR" not in pe.catalog.entries()
    bpy.ops.wm.open_mainfile(filepath=blend)
    scene = bpy.context.scene
    settings = bpy.context.scene.perception_entropy
    assert poses() == before and pe.study_to_dict(scenes.study()) == table
    assert settings.has_result and settings.result.entropy == entropy
    assert len(pe.catalog.load("My LiDAR").elevations) == 5
    assert names(settings.variants) == ["Variant"] and document.active_variant(scene) is not None
    result_staleness.update_result()
    result_staleness.update_variants()
    assert not settings.result_stale and not settings.variant_changed
    scene.objects["roof"].location.x += 0.1
    bpy.context.view_layer.update()
    result_staleness.update_result()
    assert settings.result_stale


def turn():
    """Let the add-on have its turn, as Blender's timer does."""
    bpy.context.view_layer.update()
    consistency.repair_scenes()
    bpy.context.view_layer.update()


def test_rename_duplicate_and_remove_what_others_are_tied_to(car):
    settings = car.perception_entropy
    roof = car.objects["roof"]

    # A pair keeps together under other names; its duplicate is nobody's image.
    left = scenes.add_sensor("front_left", CAMERA, location=(1.9, 0.5, 0.8))
    assert bpy.ops.pe.mirror_sensor(name="front_left", linked=True) == {"FINISHED"}
    turn()
    left.name = "another"
    turn()
    left.location = (1.5, 0.9, 1.0)
    turn()
    right = car.objects["front_right"]
    assert tuple(right.location) == pytest.approx((1.5, -0.9, 1.0), abs=2e-5)
    right.select_set(False)
    left.select_set(True)
    bpy.ops.object.duplicate()
    turn()
    copied = next(s for s in document.sensor_objects(car) if s.name.startswith("another."))
    assert copied.perception_entropy.mirror_of == "" and document.mirror_of(left, car) == right
    right.hide_set(True)
    assert scenes.study().search.mounting.pairs == ()
    bpy.data.objects.remove(right)
    turn()
    assert left.perception_entropy.mirror_of == ""
    bpy.data.objects.remove(copied)
    turn()

    # A mount takes its sensors along under another name, and lets them go.
    cabin = car.objects["cabin"]
    scenes.add_mount(car, "roof area", cabin)
    assert bpy.ops.pe.mount_sensor(name="roof", mount="roof area") == {"FINISHED"}
    settings.mounts[0].name = "top"
    assert roof.perception_entropy.mount == "top"
    scenes.add_mount(car, "top")
    assert names(settings.mounts) == ["top", "top 2"], "no name is there twice"
    settings.mount_index = 0
    bpy.ops.pe.remove_row(rows="mounts")
    assert not roof.perception_entropy.mount

    # So does a model of one's own; models to choose from come and go.
    bpy.ops.pe.add_row(rows="own_sensors", kind="lidar")
    roof.perception_entropy.model = "My LiDAR"
    settings.own_sensors[0].name = "Mine"
    document.sync_own_sensors()
    assert roof.perception_entropy.model == "Mine"
    bpy.context.view_layer.objects.active = roof
    assert [bpy.ops.pe.add_row(rows="options") for _ in range(2)] == 2 * [{"FINISHED"}]
    assert bpy.ops.pe.remove_row(rows="options", index=1) == {"FINISHED"}
    assert [row.model for row in roof.perception_entropy.options] == ["Mine"]
    bpy.ops.pe.remove_row(rows="own_sensors")
    with pytest.raises(RuntimeError, match=r"roof.*model"):
        bpy.ops.pe.score()
    roof.perception_entropy.model = PUCK
    roof.perception_entropy.options.clear()

    # The eye takes a sensor out of the score; parts are found; a state is shown and left.
    bpy.ops.pe.toggle_sensor(name="another")
    assert {s.name for s in scenes.study().rig} == {"roof"}
    bpy.ops.pe.toggle_sensor(name="another")
    assert {s.name for s in scenes.study().rig} == {"roof", "another"}
    assert bpy.ops.pe.select_object(name="cabin") == {"FINISHED"} and bpy.context.object == cabin
    car.frame_set(20)
    bpy.ops.pe.add_row(rows="states")
    car.frame_set(1)
    for index, frame in ((0, 20), (-1, 1)):
        bpy.ops.pe.show_state(index=index)
        assert car.frame_current == frame

    # Rows of a list keep their order, and the selection is where the removed one was.
    for _ in range(3):
        bpy.ops.pe.add_row(rows="focus")
    settings.focus_index = 1
    bpy.ops.pe.remove_row(rows="focus")
    assert (names(settings.focus), settings.focus_index) == (["Focus 1", "Focus 3"], 1)
    assert scenes.study()


def test_what_is_odd_is_told_with_a_button_that_mends_it(car):
    eye = scenes.add_sensor("eye", CAMERA, location=(0.7, 0.0, 1.55))

    def told():
        bpy.context.view_layer.update()
        diagnostics.run_checks()
        return {row.code: row for row in car.perception_entropy.result_warnings}

    assert not told()
    for code, change in ODD.items():
        change(eye)
        row = told()[code]
        amount = (*row.amount, 0.0, 0.0, 0.0)[:3]
        assert bpy.ops.pe.fix_warning(fix=row.fix, subject=row.subject or "", amount=amount)
        assert not told(), code
    assert scenes.study().rig["eye"].pose.position == pytest.approx((0.7, 0.0, 1.55), abs=1e-5)
    curve = car.objects["roof"].driver_add("location", 0)
    curve.driver.expression = "no_such_thing + 1"
    scenes.depsgraph().update()
    assert told()["driver"].subject == "roof"
    for factor in (1e30, 1e-30, 0.0, -1.0, math.nan, math.inf):
        with pytest.raises(RuntimeError, match="fix: amount: expected a"):
            bpy.ops.pe.fix_warning(fix="scale_vehicle", amount=(factor, 0.0, 0.0))
