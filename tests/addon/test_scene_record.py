"""One record: a scene, a variant of it and an imported study give one study, field by field."""

import dataclasses
import re
from collections.abc import Mapping

import bpy
import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from blender_addon import document
from blender_addon.engine import search, studies
from pe_core.scoring.sampling import FIRST_SAMPLES
from tests.addon import scenes

CORNERS = scenes.ASSETS / "examples" / "four_corners" / "four_corners.blend"
CAN = "Velodyne VLP-16 Puck"
NOT_OF_A_SCENE = {
    *(f"study.axes.{key}" for key in ("forward", "rotation_deg", "scale", "up")),
    "study.faces",
    "study.mesh_notes",  # its vehicle is no file
    "study.prior.boxes",  # needs a file of labels
    "study.prior.density",
    "study.prior.grid",  # of Python and of files
    "study.search.tolerance.draws",  # of Python alone
}
"""Fields that no scene sets: its vehicle is in the ground frame, a panel has fewer settings."""


def flat(value, path="study"):
    """Yield (path, value) of everything in a study that is no dataclass, mapping or sequence."""
    if isinstance(value, pe.PerceptionModel):
        value = value.curves  # a scene sets no other part of it
    if dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            yield from flat(getattr(value, field.name), f"{path}.{field.name}")
    elif isinstance(value, Mapping):
        yield f"{path}.keys", tuple(value)
        for key, item in value.items():
            yield from flat(item, f"{path}[{key!r}]")
    elif isinstance(value, tuple | list):
        yield f"{path}.len", len(value)
        for number, item in enumerate(value):
            yield from flat(item, f"{path}[{number}]")
    elif isinstance(value, np.ndarray):
        yield path, (value.shape, value.tobytes())
    else:
        yield path, value


def fields_of(study):
    """Return all of a study by path; models are those of the catalogue, one object each."""
    return dict(flat(study))


def differences(one, other):
    """Return the paths at which two studies differ."""
    one = fields_of(one)
    other = fields_of(other)
    return sorted(path for path in {*one, *other} if one.get(path, ...) != other.get(path, ...))


def variant_study(scene, row):
    return document.study_of_variant(scene, row, scenes.depsgraph())


def set_what_is_by_default(settings):
    """Give declared numbers and switches that are not set above another value than the default."""
    for _, setting, *_ in studies.setting_keys(of_scene=True):
        name = None if setting.panel is None else setting.panel.property
        value = None if name is None else getattr(settings, name)
        if name is not None and value == settings.bl_rna.properties[name].default:
            if studies.is_switch(setting):
                setattr(settings, name, True)
            elif isinstance(value, bool | int | float):
                setattr(settings, name, not value if isinstance(value, bool) else value + 1)


@pytest.fixture
def rich(car):
    """Return a scene in which everything is set that a study can have of one."""
    settings = car.perception_entropy
    settings.limit_height = 2.6
    settings.limit_width = 2.4
    settings.limit_distance = 0.1
    for key in search.LIMITED:
        if key != search.REQUIREMENTS and getattr(settings, f"limit_{key}") == document.NONE:
            setattr(settings, f"limit_{key}", 0)
    settings.clear_housings = True
    assert bpy.ops.pe.add_no_go() == {"FINISHED"}
    bpy.context.object.location = (0.0, 0.0, 9.0)
    settings.space_x = (-40.0, 40.0)
    settings.space_interval = 0.2
    settings.clearance = 0.03
    settings.space_y = (-20.0, 20.0)
    settings.space_z = (0.0, 3.0)
    settings.prior = "highway"
    settings.returns = "road"
    assert bpy.ops.pe.add_row(rows="focus", kind="front") == {"FINISHED"}
    settings.targets = "objects"
    settings.traffic = True
    settings.scenes = 24
    settings.ap_model = "scans"
    curve = settings.curves.add()
    curve.name = "lidar"
    curve.own = True
    curve.a = 0.2
    curve.b = 0.1
    curve.c = 0.1
    settings.score_samples = 2048
    settings.figures = {"blind_ground", "entropy"}
    settings.search_samples = 1024
    settings.method = "random"
    settings.candidates = 3
    settings.evaluations = 7
    settings.seed = 5
    settings.mounting_errors = True
    settings.failures = True
    settings.worst = True
    settings.axles_known = True
    settings.wheelbase = 2.7
    settings.front_overhang = 0.9
    settings.rear_overhang = 0.6
    document.put(settings, ("time", "noises"), {"car": 1.0})
    document.put(settings, ("time", "rates"), {"camera": 30.0})
    document.put(settings, ("selection", "max_of_kind"), {"camera": 5})
    settings.time_frames = 5
    settings.time_q = 2.0
    settings.track_needed = 2
    settings.track_window = 4
    settings.track_correlation = 0.5
    bpy.ops.pe.add_row(rows="scenarios", kind="cut_in")
    settings.scenarios[0].speed_kmh = 50.0
    settings.limit_price = 9000.0
    settings.max_sensors = 9
    settings.currency = "EUR"
    scenes.add_mount(car, "cabin", bpy.data.objects["cabin"], standoff=0.04, orientation="normal")
    scenes.paint(bpy.data.objects["cabin"], "top", lambda co: 1.0 if co.z > 0 else 0.0)
    scenes.add_mount(car, "painted", faces="GROUP", group="top")
    rack = scenes.add_collection(car.collection, "Rack")
    slot = bpy.data.objects.new("front", None)
    slot.location = (0.2, 0.0, 1.9)
    rack.objects.link(slot)
    scenes.add_mount(car, "slots", kind="SLOTS", slots=rack)
    roof = bpy.data.objects["roof"]
    roof.location.y = 0.4
    document.add_edge(car, pe.Edge("seam", [(0.7, -0.8, 1.5), (0.7, 0.8, 1.5)]))
    roof.perception_entropy.edge_x = "seam"
    bpy.context.view_layer.update()
    assert bpy.ops.pe.mount_sensor(name="roof", mount="painted") == {"FINISHED"}
    assert bpy.ops.pe.mirror_sensor(name="roof", linked=True) == {"FINISHED"}
    one = scenes.add_sensor("slotted", CAN, location=(0.2, 0.0, 1.9)).perception_entropy
    one.mount = "slots"
    one.fusion = "front"
    for name, y in (("arm", 0.4), ("arm end", 0.5)):
        scenes.add_sensor(name, CAN, location=(0.0, y, 2.2)).perception_entropy.rack = "r"
    for name, y in (("bar", -0.4), ("bar end", -0.5)):
        scenes.add_sensor(name, CAN, location=(0.5, y, 2.2)).perception_entropy.rack = "bar"
    eye = scenes.add_sensor("eye", "Camera 60 deg", location=(2.1, 0.0, 1.0))
    own = eye.perception_entropy
    own.own_curve = True
    own.curve_a = 0.15
    own.curve_b = 0.05
    own.free = (True,) * 6
    own.bounded[2] = True
    own.bounds_low[2] = 0.5
    own.bounds_high[2] = 1.5
    own.bounded[5] = True
    own.bounds_low[5] = -10.0
    own.bounds_high[5] = 10.0
    eye.lock_rotation[0] = True
    own.bounded[0] = True
    own.bounds_low[0] = 1.5
    own.bounds_high[0] = 2.2
    for model, price in (("Camera 60 deg", 100.0), ("Camera 90 deg", 120.0)):
        option = own.options.add()
        option.model = model
        option.price = price
        option.mass = 0.5
        option.power = 4.0
        option.data_rate = 300.0
    own.mass = 0.4
    own.power = 3.0
    own.data_rate = 250.0
    own.price = 90.0
    settings.limit_mass = 90.0
    settings.limit_power = 900.0
    settings.limit_data_rate = 9000.0
    own.may_be_left_out = True
    own.stays = True
    settings.front_objectives = {"entropy", "height"}
    start = {"name": "other", "poses": {"eye": {"position": [2.1, 0.0, 1.1]}}}
    document.put(settings, ("optimize", "start"), [start])
    bpy.ops.pe.add_row(rows="states")
    bpy.ops.pe.add_row(rows="weathers", kind="FOG")
    settings.search_conditions = "worst"
    settings.keep_requirements = True
    settings.objective = "expected_ap"
    assert bpy.ops.pe.add_row(rows="requirements", kind="r158_camera") == {"FINISHED"}
    set_what_is_by_default(settings)
    scenes.add_sensor("hidden", CAN, location=(0.0, 0.0, 3.0)).hide_set(True)
    bpy.context.view_layer.update()
    return car


def test_the_study_of_a_fresh_variant_is_the_scene_s_field_by_field(rich):
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    variant = rich.perception_entropy.variants[0]
    assert differences(variant_study(rich, variant), scenes.study()) == []


def values_by_field(study):
    """Return all values of each field, by the field's path without numbers and names in it."""
    found = {}
    for path, value in flat(study):
        found.setdefault(re.sub(r"\[.*?\]|\.len|\.keys", "", path), []).append(value)
    return found


def test_the_rich_scene_sets_every_field_that_a_scene_has(rich):
    """A field that is added to the study, and to no scene here, is found by this test."""
    study = scenes.study()
    default = pe.Study(pe.Rig([pe.Sensor("any", study.rig["roof"].model)]), mesh=study.mesh)
    set_here = values_by_field(study)
    default = values_by_field(default)
    assert default.pop("study.mesh") == set_here.pop("study.mesh")
    left = {path for path, values in default.items() if set_here.get(path) == values}
    left -= {path.rpartition(".")[0] for path in default}  # those that have fields of their own
    assert left == NOT_OF_A_SCENE, "set these in `rich`, or say why no scene can"


def test_a_variant_of_the_four_corners_keeps_mounts_pairs_and_constraints(addon):
    bpy.ops.wm.open_mainfile(filepath=str(CORNERS))
    scene = bpy.context.scene
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    study = variant_study(scene, scene.perception_entropy.variants[-1])
    assert (len(study.search.mounting.mounts), len(study.search.mounting.pairs)) == (2, 3)
    assert study.limits.height == pe.Limit(2.7)
    assert differences(study, scenes.study()) == []


def test_a_variant_s_study_is_that_of_the_scene_once_it_is_applied(rich):
    bpy.ops.pe.save_variant()
    eye, arm = (bpy.data.objects[name] for name in ("eye", "arm"))
    eye.location.z = 1.2
    eye.perception_entropy.model = "Camera 90 deg"
    arm.perception_entropy.rack = ""
    eye.perception_entropy.bounds_low[2] = 0.6
    bpy.data.objects.remove(bpy.data.objects["bar"])
    bpy.data.objects["hidden"].hide_set(False)
    scenes.add_sensor("third", CAN, location=(0.0, 0.0, 2.5)).perception_entropy.mount = "cabin"
    bpy.ops.pe.save_variant()
    for row in rich.perception_entropy.variants:
        before = variant_study(rich, row)
        bpy.ops.pe.switch_variant(key=row.key)
        assert differences(before, scenes.study()) == []
        others = [each for each in rich.perception_entropy.variants if each.key != row.key]
        studies = [variant_study(rich, each) for each in others]
        bpy.ops.pe.switch_variant(key=others[0].key)
        assert differences(studies[0], scenes.study()) == []


def test_an_imported_study_is_that_of_the_scene_that_holds_it(rich, tmp_path):
    settings = rich.perception_entropy  # of a camera's housing nothing is known
    settings.limit_protrusion = settings.limit_frontal_area = document.NONE
    exported = scenes.study()
    pt.export_study(exported, tmp_path / "study.toml")
    study = pe.load_study(tmp_path / "study.toml")
    assert differences(exported, study) == []
    study = study.with_rig(pe.Rig([*study.rig][::-1]))  # what is not sorted keeps its order
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert document.load_into(bpy.context.scene, study) == []
    assert [each.name for each in scenes.study().rig] == [each.name for each in study.rig]
    of_files = [  # names of files, and of an area's parts in them
        "study.mesh",
        "study.mesh.len",
        *(f"study.search.mounting.mounts['painted'].area.{key}" for key in ("file", "parts")),
    ]
    different = [
        path for path in differences(study, scenes.study()) if not path.startswith(tuple(of_files))
    ]
    assert different == []


def test_a_fresh_scene_is_scored_on_as_many_voxels_as_any_new_study(addon):
    fresh = bpy.data.scenes.new("fresh")
    assert fresh.perception_entropy.score_samples == FIRST_SAMPLES
