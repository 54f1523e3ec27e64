"""Presets, requirements in files, and bad input."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scoring.requirements import BODIES, Criterion, Requirement, RobustTo, checkable
from pe_core.study import Node, read, write
from pe_core.study.requirement_file import presets
from pe_core.study.study_file import study_from_dict, study_to_dict
from tests.engine.requirement_scene import AHEAD, check, rig, van

EXAMPLES = Path(__file__).parents[2] / "examples"
ARS = "Continental ARS408-21"
TABLE = {"name": "a", "body": ["child"], "zone": {"x": ["front", "front + 1"], "y": [-1, 1]}}
BAD = {
    "no zone": ({"zone": {}}, "zone"),
    "two shapes": ({"zone": {"x": [0, 1], "y": [0, 1], "ring": [0, 1]}}, "one of x and y"),
    "no extent": ({"zone": {"x": [4, 4], "y": [0, 1]}}, "some extent"),
    "inside": ({"zone": {"x": [-1, 1], "y": [-0.5, 0.5]}}, "inside the vehicle"),
    "outside": ({"zone": {"x": [500, 501], "y": [0, 1]}}, "in the space"),
    "step": ({"zone": {"x": [0, 90], "y": [2, 40], "step": 0.02}}, "at most 20,000 samples"),
    "class": ({"body": [{"size": [0.3, 0.3, 1], "class": "pedestrain"}]}, "one of "),
    "5000 digits": ({"zone": {"x": ["front", f"front + {'1' * 5000}"], "y": [-1, 1]}}, "an offset"),
    "anchor": ({"zone": {"x": ["bow", 1], "y": [0, 1]}}, "planes front"),
    "door": ({"zone": {"x": ["door", 9], "y": [2, 3]}}, "word door"),
    "axle": ({"zone": {"x": ["front_axle", 9], "y": [2, 3]}}, "named wheel"),
    "narrow": ({"body": ["car"]}, "not larger than the zone"),
    "body": ({"body": ["dragon"]}, "one of cylinder"),
    "kinds": ({"criterion": {"kinds": 3}}, "the number of kinds"),
    "of": ({"criterion": {"of": ["lidar", "sonar"]}}, "sonar"),
    "lacking": ({"criterion": {"of": ["camera"]}}, "that the rig has (lidar)"),
    "share": ({"criterion": {"of": ["radar"], "share": 1.0}}, "that the rig has (lidar)"),
    "of ground": ({"criterion": {"blind_m2": 1.0, "share": 0.5}}, "of ground"),
    "beyond": (
        {"criterion": {"blind_m2": 1.0}, "zone": {"ring": [0.0, 99.0]}},
        "no other is searched",
    ),
    "no share": ({"criterion": {"share": 0}}, "above 0"),
    "key": ({"zone": {"x": [3, 4], "y": [0, 1], "stepp": 1}}, "unknown key"),
    "preset": ({"preset": "r000"}, "26 names, such as r15"),
    "ap": ({"body": ["pole_ring"], "criterion": {"ap": 0.5}}, "a class"),
    "twice": ({}, "each name once"),
    "mounting": ({"robust_to": {"mounting": True}}, "tolerance"),
    "heading": ({"body": [{"name": "car", "headings": "north"}]}, "72 angles"),
}


def test_presets_have_sources_and_come_back_from_a_file_the_same():
    found = []
    for key, each in presets().items():
        if each.confidence not in ("A", "B") or len(each.source) < 10 or not each.check:
            found.append(f"{key}: confidence or source")
        requirement = each.requirement()
        for name in (key, "another name"):
            changed = replace(requirement, name=name, robust_to=RobustTo(one_lost=name != key))
            again = read(Requirement, Node(write(changed), "file"))
            if again != changed:
                found.append(f"{key}: {write(changed)}")
    assert not found and len(presets()) > 20


SIGHT = {"r159_annex3", "r158_camera", "fmvss111_rear", "r46_class_I", "r46_class_III"}
SIGHT |= {"iso5006_ring", "perceptor_ground"}


def test_what_asks_for_sight_is_met_by_no_radar_and_no_ultrasonic_sensor():
    """Each preset says which kinds may meet it; the sedan with a radar behind has no verdict."""
    vehicle = pe.load_study(EXAMPLES / "robotaxi_sedan" / "decided.toml").vehicle
    behind = pe.Pose.from_degrees((-2.3, 0.0, 0.5), (0.0, 0.0, 180.0))
    sonar = pe.catalog.names("ultrasonic")[0]
    wanted = [
        replace(e.requirement(), zone=e.requirement(eyes=0.4).zone) for e in presets().values()
    ]
    assert all(each.criterion.of for each in wanted)
    for model in (ARS, sonar):
        alone = pe.Rig([pe.Sensor("behind", pe.catalog.load(model), behind)])
        fitting, reasons = checkable(wanted, alone, vehicle)
        assert not SIGHT & {each.name for each in fitting}
        assert all("camera" in reasons[name] for name in SIGHT)
        if model == sonar:
            assert {e.name for e in fitting} == {
                "r158_detection",
                "park_aid_front",
                "park_aid_rear",
            }


def test_a_share_is_refused_to_kinds_whose_rays_end_on_no_body():
    """Alone in one line; beside a camera the radar sees no body of which a share is asked for."""
    ahead = pe.Sensor("radar", pe.catalog.load(ARS), pe.Pose((2.55, 0.0, 0.6)))
    for criterion in (Criterion(share=0.5), Criterion(share=0.9)):
        own = Requirement("own", AHEAD, (BODIES["cylinder"],), criterion)
        with pytest.raises(pe.InputError, match="rays end on bodies") as caught:
            check(own, of=pe.Rig([ahead]))
        assert "\n" not in str(caught.value)
        (both,) = check(own, of=pe.Rig([ahead, rig()["front"]]))
        (camera,) = check(own, of=pe.Rig([rig()["front"]]))
        assert both.passed.tolist() == camera.passed.tolist() and both.sensors == camera.sensors
        assert "radar" not in both.unseen_by or both.unseen_by["radar"].code == "not counted"
        two = replace(own, criterion=replace(criterion, kinds=2))
        with pytest.raises(pe.InputError, match="the number of kinds"):
            check(two, of=pe.Rig([ahead, rig()["front"]]))


def test_derived_distances_are_on_the_side_of_the_larger_zone():
    """Speeds and times of the sources: no zone ends nearer than their product."""

    def km_h(speed, seconds):
        return speed / 3.6 * seconds

    rows = {
        "ncap26_reverse_static": ("x", [-2.5 - km_h(4, 2), -2.5 - km_h(8, 2)], 0.01),
        "ncap26_start_crossing": ("y", [-km_h(60, 3.5), km_h(60, 3.5)], 0.01),
        "ncap26_frontal_pedestrian": ("x", [2.5 + km_h(10, 4), 2.5 + km_h(60, 4)], 0.1),
        "ncap26_frontal_cyclist": ("y", [-1.0 - km_h(15, 4), 1.0 + km_h(20, 4)], 0.1),
        "stop_highway": ("x", [12.5, 2.5 + (120 / 3.6) ** 2 / (2 * 5)], 0.1),
    }
    for name, (axis, (first, last), most) in rows.items():
        corners = presets()[name].requirement().zone.placed(van(), None, name).corners
        values = corners[:, "xy".index(axis)]
        low, high = (min, max) if first < last else (max, min)
        sign = 1.0 if first < last else -1.0
        beyond = [sign * (first - low(values)), sign * (high(values) - last)]
        if name == "ncap26_reverse_static":  # spots: both are farther away
            beyond[0] = -beyond[0]
        assert all(0.0 <= v < most for v in beyond), (name, beyond)
    sides = presets()["ncap26_frontal_pedestrian"].requirement().zone.placed(van(), None, "y")
    assert sides.corners[:, 1].min() <= -1.0 - km_h(5, 4)
    assert sides.corners[:, 1].max() >= 1.0 + km_h(8, 4)
    x = presets()["ncap26_frontal_cyclist"].requirement().zone.placed(van(), None, "x").corners
    assert x[:, 0].min() <= 2.5 + km_h(10, 4) and x[:, 0].max() >= 2.5 + km_h(60, 4)


def test_bad_input_is_one_line_that_names_it(tmp_path):
    """Through the study file: the line has the file or the requirement, and what was expected."""
    lidar = study_to_dict(pe.Study(pe.Rig([rig()["top"]]), van()))
    mesh = tmp_path / "van.npz"
    pt.write_mesh(mesh, pe.Mesh(van().triangles, van().parts, van().part_names))
    lidar["vehicle"] = {"mesh": mesh.name}
    offenders = []
    for name, (change, expected) in BAD.items():
        tables = [{**TABLE, **change}] * (2 if name == "twice" else 1)
        try:
            study = study_from_dict({**lidar, "requirement": tables}, "file.toml", tmp_path)
            study.verdicts()
            offenders.append(f"{name}: accepted")
        except pe.InputError as error:
            line = str(error)
            if expected not in line or "\n" in line or not re.search("requirement", line):
                offenders.append(f"{name}: {line}")
    assert not offenders
