"""OpenUSD: stages of other programs are read where they are, by hand and against usd-core; NVIDIA's
validator passes what is written, and fails it with a wrong number of emitters."""

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_core.base.errors import InputError
from pe_tools.exchange import SceneFacts, rig_files

from .processes import pe as pe_command
from .shapes import box_car, camera, lidar_on_roof, small_lidar
from .test_docs_examples import STUDY

WITHIN = 1e-6
HEAD = '#usda 1.0\n(\n    defaultPrim = "World"\n    metersPerUnit = {}\n    upAxis = "{}"\n)\n'
LIDAR = """
    def OmniLidar "{name}" (
        prepend apiSchemas = ["OmniSensorGenericLidarCoreAPI"]
    )
    {{
        token omni:sensor:Core:scanType = "ROTARY"
        uint omni:sensor:Core:scanRateBaseHz = 20
        uint omni:sensor:Core:patternFiringRateHz = 7200
        float omni:sensor:Core:nearRangeM = 0.5
        float omni:sensor:Core:farRangeM = 120.3
        uint omni:sensor:Core:numberOfEmitters = 3
        float[] omni:sensor:Core:emitterState:s001:azimuthDeg = [0, 1.5, -1.5]
        float[] omni:sensor:Core:emitterState:s001:elevationDeg = [
            2.5, 0,  # the horizon
            -10
        ]
        {more}
    }}
"""
X, Y, Z = np.eye(3)
VALIDATOR = Path(sys.executable).with_name("simready-validate")


def layer(folder, name, inside, unit=1.0, up="Z"):
    path = folder / name
    path.write_text(HEAD.format(unit, up) + f'def Xform "World"\n{{\n{inside}\n}}\n')
    return path


def rig_of(path):
    """The sensors of a file by name, and its messages."""
    found = pt.import_rig(path)
    return {sensor.name: sensor for sensor in found.rig}, "\n".join(found.lines)


def is_at(sensor, position, axes):
    """Whether a sensor is at a place [m], with its forward and up axis as given."""
    rotation = sensor.pose.ground_from_sensor
    expected = np.stack(axes, axis=1)
    return (
        np.abs(np.subtract(sensor.pose.position, position)).max() < WITHIN
        and np.abs(rotation[:, [0, 2]] - expected).max() < WITHIN
    )


def test_emitters_fire_as_often_as_the_rates_say(tmp_path):
    more = 'string omni:sensor:marketName = "Unheard-of 3"'
    sensors, _ = rig_of(layer(tmp_path, "one.usda", LIDAR.format(name="roof", more=more)))
    model = sensors["roof"].model
    assert model.azimuth_count == 360  # 7200 / 20
    assert np.degrees(model.elevations) == pytest.approx([2.5, 0.0, -10.0])
    assert np.degrees(model.azimuth_offsets) == pytest.approx([0.0, 1.5, -1.5])
    assert (model.min_range, model.max_range) == (0.5, 120.3)


@pytest.mark.parametrize(
    ("more", "beams"),
    [
        ('token omni:sensor:Core:scanType = "SOLID_STATE"', 3),
        ("float omni:sensor:Core:validEndAzimuthDeg = 90", 91 + 90 + 90),
        ("float omni:sensor:Core:rotPatternFiringResDeg = 0.5", 3 * 720),
        ("float[] omni:sensor:Core:emitterState:s002:elevationDeg = [1, 2, 3]", 3 * 360),
    ],
)
def test_other_scans_have_as_many_beams(tmp_path, more, beams):
    text = LIDAR.format(name="roof", more=more)
    if "SOLID" in more:
        text = text.replace('token omni:sensor:Core:scanType = "ROTARY"', "")
    sensors, _ = rig_of(layer(tmp_path, "one.usda", text))
    assert sensors["roof"].model.beam_count == beams


def test_a_wrong_number_of_emitters_is_one_line(tmp_path):
    text = LIDAR.format(name="roof", more="").replace("Emitters = 3", "Emitters = 4")
    with pytest.raises(InputError, match=r"one.usda: .*roof.*: expected 4 .*found 3"):
        pt.import_rig(layer(tmp_path, "one.usda", text))


def test_another_program_has_posed_the_rig(tmp_path):
    """Centimetres, y up, nested and scaled frames, a kit that is placed twice by a reference into
    another layer, a pivot, and a variant: by hand. Ground x is the stage's x, y is -z, z is y."""
    kit = f"""
    def Xform "Mast"
    {{
        double3 xformOp:translate = (0, 50, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        def Camera "eye" {{ float focalLength = 18
            float horizontalAperture = 36 }}
    }}
    {
        LIDAR.format(
            name="ring",
            more='''
        float3 xformOp:rotateXYZ = (-90, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:rotateXYZ"]''',
        )
    }
    """
    layer(tmp_path, "kit.usda", kit)
    stage = """
    def Xform "Car" (
        variants = { string kit = "high" }
        prepend variantSets = "kit"
    )
    {
        float3 xformOp:scale = (2, 2, 2)
        uniform token[] xformOpOrder = ["xformOp:scale"]
        variantSet "kit" = {
            "high" {
                over "left" { double3 xformOp:translate = (0, 100, -40) }
            }
            "low" {
                over "left" { double3 xformOp:translate = (0, 10, -40) }
            }
        }
        def "left" (
            instanceable = true
            prepend references = @./kit.usda@
        )
        {
            uniform token[] xformOpOrder = ["xformOp:translate"]
        }
        def "right" (
            references = @./kit.usda@</World>
        )
        {
            double3 xformOp:translate = (0, 100, 40)
            double3 xformOp:translate:pivot = (10, 0, 0)
            quatf xformOp:orient = (0, 0, 1, 0)
            uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:translate:pivot",
                "xformOp:orient", "!invert!xformOp:translate:pivot"]
        }
        def Camera "off" (
            active = false
        )
        {
        }
        class Camera "_none" {}
    }
    """
    sensors, _ = rig_of(layer(tmp_path, "car.usda", stage, 0.01, "Y"))
    assert set(sensors) == {"left_eye", "left_ring", "right_eye", "right_ring"}
    # A camera looks along -z of the stage, which is y of the ground.
    assert is_at(sensors["left_eye"], (0.0, 0.8, 3.0), (Y, Z))
    assert is_at(sensors["left_ring"], (0.0, 0.8, 2.0), (X, Z))
    # Half a turn about the vertical through x = 10 cm, doubled: from 0 to 40 cm.
    assert is_at(sensors["right_eye"], (0.4, -0.8, 3.0), (-Y, Z))
    assert is_at(sensors["right_ring"], (0.4, -0.8, 2.0), (-X, Z))
    assert sensors["left_eye"].model.hfov == pytest.approx(math.pi / 2.0)


def test_axes_of_ovrtx_are_told_apart(tmp_path):
    """The prim of ovrtx's example looks along -z, with y up; Isaac Sim's along x, with z up."""
    turned = """
        double3 xformOp:translate = (0, 0, 1)
        float3 xformOp:rotateXYZ = (90, 0, -90)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]"""
    inside = LIDAR.format(name="a", more=turned) + LIDAR.format(name="b", more="")
    sensors, lines = rig_of(layer(tmp_path, "two.usda", inside))
    assert is_at(sensors["a"], (0.0, 0.0, 1.0), (X, Z))
    assert is_at(sensors["b"], (0.0, 0.0, 0.0), (X, Z))
    assert "a: its y axis is vertical" in lines


def random_stage(folder, rng):
    """A stage by usd-core with cameras and LiDARs below frames of every operation; its path."""
    pxr = pytest.importorskip("pxr", reason="of the extra meshes")
    from pxr import Gf, Usd, UsdGeom

    assert pxr
    path = folder / "stage.usda"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    kit = UsdGeom.Xform.Define(stage, "/Kit")
    orders = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")
    above = kit.GetPath()
    for k, order in enumerate(orders):
        frame = UsdGeom.Xform.Define(stage, above.AppendChild(f"f{k}"))
        frame.AddTranslateOp().Set(Gf.Vec3d(*rng.uniform(-50, 50, 3)))
        getattr(frame, f"AddRotate{order}Op")().Set(Gf.Vec3f(*rng.uniform(-180, 180, 3)))
        frame.AddRotateZOp(opSuffix="more").Set(float(rng.uniform(-90, 90)))
        quaternion = Gf.Rotation(Gf.Vec3d(*rng.normal(size=3)), float(rng.uniform(0, 180)))
        frame.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(quaternion.GetQuat()))
        frame.AddScaleOp().Set(Gf.Vec3f(*[float(rng.uniform(0.5, 2.0))] * 3))
        UsdGeom.Camera.Define(stage, frame.GetPath().AppendChild(f"eye{k}"))
        above = frame.GetPath()
    for side in ("a", "b"):
        prim = stage.DefinePrim(f"/Car/{side}", "Xform")
        prim.GetReferences().AddInternalReference("/Kit")
        prim.SetInstanceable(True)
        matrix = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(1, 2, 3), 50.0))
        UsdGeom.Xformable(prim).AddTransformOp().Set(matrix.SetTranslateOnly((100.0, 5.0, 7.0)))
    stage.GetRootLayer().Save()
    return stage, path


@pytest.mark.parametrize("binary", [False, True])
def test_places_are_those_of_usd_core(tmp_path, binary):
    stage, path = random_stage(tmp_path, np.random.default_rng(5))
    from pxr import Usd, UsdGeom

    if binary:
        path = tmp_path / "stage.usdc"
        stage.GetRootLayer().Export(str(path))
    found, _ = rig_of(path)
    cache = UsdGeom.XformCache()
    own = [p for p in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies())
           if p.IsA(UsdGeom.Camera)]  # fmt: skip
    assert len(found) == len(own) == 18
    places = []
    for prim in own:
        matrix = np.array(cache.GetLocalToWorldTransform(prim)).T
        x, y, z = matrix[:3, 3] * 0.01
        look = -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
        places.append((x, -z, y, look[0], -look[2], look[1]))
    ours = [(*s.pose.position, *s.pose.ground_from_sensor[:, 0]) for s in found.values()]
    assert np.abs(np.array(sorted(ours)) - np.array(sorted(places))).max() < WITHIN


def scene(cameras=True):
    sensors = [lidar_on_roof(small_lidar(), rotation=(4.0, -7.0, 100.0))]
    part = pe.Lidar("part", np.radians([-5.0, 5.0]), 90, 60.0, horizontal_fov=(-1.0, 1.0))
    sensors.append(pe.Sensor("front", part, pe.Pose((2.0, 0.0, 0.6))))
    sensors.append(pe.Sensor("ahead", catalog.load("Bosch LRR3"), pe.Pose((2.1, 0.0, 0.5))))
    if cameras:
        sensors.append(camera(70.0, (1.0, 0.5, 1.2), (5.0, 20.0, -130.0), name="eye"))
    return pe.Rig(sensors)


def stage_of(files, folder):
    for name, data in files.items():
        (folder / name).write_bytes(data)
    usd = pytest.importorskip("pxr.Usd", reason="of the extra meshes")
    return usd.Stage.Open(str(folder / "rig.usda"))


def test_usd_core_reads_what_is_written(tmp_path):
    """The vehicle's mesh, a camera's ray to a point, figures and verdicts."""
    facts = {
        "figures": [{"figure": "entropy", "value": 3.25, "wanted": None}],
        "verdicts": [{"name": "in front", "met": True}],
    }
    rig = scene()
    files, _ = rig_files(rig, "usd", facts=SceneFacts(box_car(), facts))
    stage = stage_of(files, tmp_path)
    from pxr import Gf, UsdGeom

    root = stage.GetDefaultPrim()
    told = root.GetCustomDataByKey("perceptionEntropy")
    assert told["figures"]["entropy"]["value"] == 3.25
    assert told["verdicts"]["in front"]["met"] is True
    box = UsdGeom.BBoxCache(0, ["default"]).ComputeWorldBound(stage.GetPrimAtPath("/Vehicle/Body"))
    extent = box.ComputeAlignedRange()
    bounds = np.array(box_car().bounds)
    assert np.abs(np.array([extent.GetMin(), extent.GetMax()]) - bounds).max() < 1e-5
    eye = rig["eye"]
    seen = eye.pose.ground_from_sensor @ np.array([10.0, 2.0, -1.0]) + eye.pose.position
    view = UsdGeom.Camera(stage.GetPrimAtPath("/Vehicle/Sensors/eye/camera")).GetCamera(0)
    x, y, _ = view.frustum.ComputeViewMatrix().Transform(Gf.Vec3d(*seen)) / 10.0
    focal = view.focalLength / view.horizontalAperture * 1920.0
    assert (x * focal, y * focal) == pytest.approx(
        (-0.2 * eye.model.focal_px, -0.1 * eye.model.focal_px), rel=1e-5
    )


def validated(folder, profile):
    """Whether NVIDIA's validator passes the rig of a folder for a profile."""
    done = subprocess.run(
        [VALIDATOR, "--profile", profile, "--version", "1.0.0", folder / "rig.usda"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "HOME": str(folder)},
    )
    assert "PASSED" in done.stdout or "FAILED" in done.stdout, done.stdout + done.stderr
    return "PASSED" in done.stdout


@pytest.mark.skipif(not VALIDATOR.exists(), reason="simready-validate, of the extra test")
def test_nvidias_validator_passes_it(tmp_path):
    """Its rule LI.001 (2026.8.0) fails every stage that has a Camera: such a rig passes the profile
    of cameras, and the profile of LiDARs without its cameras."""
    files, _ = rig_files(scene(), "usd")
    stage_of(files, tmp_path)
    assert validated(tmp_path, "Sensor-Camera")
    files, _ = rig_files(scene(cameras=False), "usd")
    stage_of(files, tmp_path)
    assert validated(tmp_path, "Sensor-LiDAR")
    text = files["rig.usda"].decode()
    assert text.count("numRaysPerLine = [58]") == 1
    (tmp_path / "rig.usda").write_text(
        text.replace("numRaysPerLine = [58]", "numRaysPerLine = [57]")
    )
    assert not validated(tmp_path, "Sensor-LiDAR")


@pytest.mark.parametrize(
    ("inside", "expected"),
    [
        ('def Camera "a" { float focalLength = }', "line "),
        ('def Camera "a" { float focalLength = "x" }', "focalLength"),
        ('def Camera "a" { float focalLength = -1 }', "focalLength"),
        ('def Camera "a" {', "line "),
        ('def Xform "a" { double3 xformOp:scale = (1, -1, 1)\nuniform token[] xformOpOrder = '
         '["xformOp:scale"]\ndef Camera "b" {} }', "right-handed"),
        ('def Camera "a" { double3 xformOp:translate = (1, 2)\nuniform token[] xformOpOrder = '
         '["xformOp:translate"] }', "3 numbers"),
        ('def Xform "a" (references = </World>) {}', "in a row"),
        ('def "x" ' + "{ def " * 300, "line "),
    ],
)  # fmt: skip
def test_a_damaged_stage_is_one_line(tmp_path, inside, expected):
    with pytest.raises(InputError) as caught:
        pt.import_rig(layer(tmp_path, "bad.usda", inside))
    assert "\n" not in str(caught.value) and "bad.usda" in str(caught.value)
    assert expected in str(caught.value)


def test_what_is_missing_is_told(tmp_path):
    inside = (
        'def "gone" (references = @nowhere.usda@) {}\ndef Camera "eye" {}\n'
        'def Camera "map" { token projection = "orthographic" }\ndef IsaacImuSensor "imu" {}\n'
        'def PointInstancer "many" { def Camera "b" {} }'
    )
    sensors, lines = rig_of(layer(tmp_path, "one.usda", inside))
    assert list(sensors) == ["eye"]
    for part in ("nowhere.usda", "imu", "map", "PointInstancer", "eye: no picture size"):
        assert part in lines


def test_a_changed_emitter_is_not_hidden_by_the_catalogue(tmp_path):
    """The file names a model of the catalogue, but somebody has changed its emitters."""
    model = catalog.load("Velodyne VLP-16 Puck")
    rig = pe.Rig([pe.Sensor("roof", model, pe.Pose((0.0, 0.0, 2.0)))])
    files, _ = rig_files(rig, "usd")
    text = files["rig.usda"].decode()
    path = tmp_path / "rig.usda"
    path.write_text(text)
    found, lines = rig_of(path)
    assert catalog.to_table(found["roof"].model) == catalog.to_table(model) and not lines
    path.write_text(text.replace(", -15]", ", -25]"))
    found, lines = rig_of(path)
    lowest = math.degrees(found["roof"].model.elevations.min())
    assert lowest == pytest.approx(-25.0) and "roof: its emitters" in lines


def test_figures_are_of_the_result_beside_the_study_while_it_is_of_it(tmp_path):
    """The stored result is marked by another coverage, to know it again."""
    body = box_car()
    pt.write_mesh(tmp_path / "box.npz", pe.Mesh(body.triangles, body.parts, body.part_names))
    (tmp_path / "study.toml").write_text(STUDY, "utf-8")
    out = tmp_path / "out"
    assert pe_command(["score", tmp_path / "study.toml", "-o", out]).returncode == 0
    result = out / "result.json"
    scored = json.loads(result.read_text("utf-8"))
    result.write_text(json.dumps(scored | {"after": scored["after"] | {"coverage": 0.125}}))

    def stated(*changes):
        rig = tmp_path / "rig.usda"
        call = (out / "study.toml", "--to", "usd", "-o", rig, "--replace", *changes)
        assert pe_command(["export", *call]).returncode == 0
        return float(re.search(r'"coverage" = (\S+)', rig.read_text("utf-8"))[1])

    assert stated() == 0.125
    assert stated("--set", "samples=2048") != 0.125
    result.write_text("{}")
    assert stated() == scored["after"]["coverage"]
