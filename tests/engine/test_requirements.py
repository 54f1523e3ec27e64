"""Requirements: planes, zones, margins and verdicts, held to definitions and to figures by hand."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core.base.degrees import as_in_file
from pe_core.base.serialization import dumps
from pe_core.base.table_reader import Table
from pe_core.scoring.requirements import (
    BODIES,
    Body,
    Criterion,
    Requirement,
    RequirementChecker,
    Under,
    VehiclePlanes,
    Zone,
    body_met,
    margin_of,
    sees,
    signed_distance,
)
from pe_core.scoring.requirements.criteria import largest_solid_angle, visible_share
from pe_core.scoring.sight import Sight
from pe_core.sensors import ObjectMeasurementCache
from pe_core.study.requirement_file import presets, read_requirement, requirement_table
from pe_core.study.study_file import study_from_dict, study_to_dict
from tests.engine import oracle, shapes

MIDDLE = Zone(x=("front + 0.6", "front + 1.6"), y=(-0.6, 0.6), step=0.3)
AHEAD = Zone(x=("front + 0.4", "front + 1.6"), y=("right", "left"), step=0.3)


def van(mirrors=False):
    """A box 5 m long and 2 m wide; with mirrors, two more that stick out by 0.25 m."""
    triangles = [shapes.box((-2.5, -1.0, 0.25), (2.5, 1.0, 2.4))]
    names = ["body"]
    if mirrors:
        triangles += [
            shapes.box((1.5, s * 1.25 - 0.25 * (s > 0), 1.0), (1.6, s * 1.0 + 0.25 * (s > 0), 1.3))
            for s in (-1, 1)
        ]
        names += ["mirror_right", "mirror_left"]
    parts = np.repeat(np.arange(len(names)), [len(t) for t in triangles]).astype(np.int32)
    return pe.Vehicle(np.concatenate(triangles), parts, names, clearance=0.0)


def rig():
    """A LiDAR high at the front, a camera that looks ahead, another behind."""
    return pe.Rig(
        [
            shapes.lidar_on_roof(
                shapes.small_lidar(24, 720), (2.37, 0.21, 2.63), (0.0, 9.0, 0.0), "top"
            ),
            shapes.camera(100.0, (2.53, 0.0, 0.93), (0.0, 18.0, 0.0), "front"),
            shapes.camera(120.0, (-2.53, 0.0, 1.5), (0.0, 30.0, 180.0), "rear"),
        ]
    )


def check(*requirements, vehicle=None, of=None, **options):
    checker = RequirementChecker(requirements, vehicle or van())
    return checker.check(of or rig(), **options)


# --- planes and zones ---------------------------------------------------------------------------


def test_planes_leave_out_mirrors_and_what_is_above():
    """The widths are those of the body; a plane says how it was found."""
    planes = VehiclePlanes.of(van(mirrors=True), near_side="left")
    assert (planes.across["left"], planes.across["right"]) == (1.0, -1.0)
    assert (planes.across["near"], planes.across["off"]) == (1.0, -1.0)
    assert (planes.along["front"], planes.along["rear"]) == (2.5, -2.5)
    assert "mirror_left" in planes.found["left"]
    assert signed_distance(np.array([[0.0, 0.0], [3.5, 2.0]]), planes.outline) == pytest.approx(
        [-1.0, math.hypot(1.0, 1.0)]
    )
    wedge = pe.Vehicle(
        np.array([[[0, 0, 0], [4, 0, 4], [0, 1, 0]], [[-2, 0, 0], [0, 1, 1], [0, 0, 0]]], float)
    )
    assert VehiclePlanes.of(wedge, below=1.0).along["front"] == 1.0


def test_places_are_measured_outwards_from_outer_planes():
    planes = VehiclePlanes.of(van(), eyes=1.2)
    at = [
        planes.coordinate(axis, place, "right", "test", "x")
        for axis, place in (
            *(
                (0, "front + 0.8"),
                (0, "rear + 0.3"),
                (0, "front - 6"),
                (0, "25 %"),
                (0, "eyes - 4"),
            ),
            *((1, "left + 0.5"), (1, "near + 0.9"), (1, "off + 1"), (1, "75 % + 0.1"), (1, -1.5)),
        )
    ]
    assert at == [3.3, -2.8, -3.5, -1.25, -2.8, 1.5, -1.9, 2.0, 0.6, -1.5]


def test_samples_cover_a_zone_at_its_step_and_none_is_in_the_vehicle():
    placed = Zone(x=("front - 1", "front + 1"), y=("right", "left"), step=0.15).placed(
        van(), None, "zone"
    )
    points, distance = placed.samples()
    inside = points[distance <= 1e-6]
    assert 2.5 < inside[:, 0].min() < 2.65 and inside[:, 0].max() == 3.5
    assert np.diff(np.unique(inside[:, 0])).max() <= 0.15 + 1e-6
    assert np.diff(np.unique(inside[:, 1])).max() <= 0.15 + 1e-6
    assert len(inside) == 7 * 15
    assert distance.max() <= placed.grow + 1e-6 and (distance > 0).sum() > 0
    ring = Zone(ring=(0.3, 1.0), step=0.2).placed(van(), None, "ring")
    points, distance = ring.samples(grown=False)
    away = signed_distance(points, np.array([(-2.5, -1), (2.5, -1), (2.5, 1), (-2.5, 1)], float))
    assert away.min() >= 0.3 - 1e-6 and away.max() <= 1.0 + 1e-6 and away.max() > 0.99


def test_margins_by_hand():
    """Rows of samples at 0.1 m: the zone has those at 0 and below."""
    distance = np.array([-0.2, -0.1, 0.0, 0.1, 0.2, 0.3])
    rows = {
        (1, 1, 1, 1, 1, 1): (0.6, True),  # as far as was looked
        (1, 1, 1, 1, 1, 0): (0.2, False),  # the row before is the last that is sure
        (1, 1, 1, 0, 1, 1): (0.0, False),
        (1, 1, 0, 1, 1, 1): (-0.1, False),
        (1, 0, 1, 1, 1, 1): (-0.2, False),
        (0, 1, 1, 1, 1, 1): (-0.3, False),  # nothing is left of it
    }
    found = {row: margin_of(distance, np.array(row, bool), 1.0, 0.1, 0.6) for row in rows}
    assert found == rows
    # half of the samples is enough: up to 0.2 m there are 3 of 5, all six are 3 of 6
    assert margin_of(distance, np.array([1, 1, 1, 0, 0, 0], bool), 0.5, 0.1, 0.6) == (0.6, True)
    assert margin_of(distance, np.array([1, 1, 1, 0, 0, 0], bool), 0.6, 0.1, 0.6) == (0.2, False)


# --- verdicts against the definition, and against an oracle -------------------------------------


def test_verdicts_are_those_of_the_definition():
    """Every sample, body and heading, by `sees` and `body_met`; every lost sensor, too."""
    bodies = (BODIES["child"], BODIES["cyclist"], BODIES["pole_ring"])
    requirements = [
        Requirement("k", AHEAD, bodies[:2], Criterion(sensors=2), Under(one_lost=True)),
        Requirement("kinds", AHEAD, bodies[:1], Criterion(kinds=2, points=4, pixels=4000.0)),
        Requirement("share", AHEAD, (BODIES["cylinder"],), Criterion(share=0.6)),
        Requirement("ring", AHEAD, bodies[2:], Criterion(share=1.0, of=("camera",))),
        Requirement("fine", AHEAD, bodies[:1], Criterion(per_degree=16.5)),
        Requirement("high", AHEAD, bodies[:1], Criterion(pixels_high=500.0, of=("camera",))),
    ]
    vehicle, whole = van(), rig()
    some = 0
    for requirement, verdict in zip(requirements, check(*requirements), strict=True):
        passed = []
        for x, y in verdict.samples.points:
            seen = [
                {s.name: sees(s, b, (x, y, 0.0), h, vehicle, requirement.criterion) for s in whole}
                for b in requirement.bodies
                for h in b.headings
            ]
            lost = [s.name for s in whole] if requirement.under.one_lost else []
            cases = [seen, *([{**row, name: False} for row in seen] for name in lost)]
            passed.append(
                all(body_met(row, whole, requirement.criterion) for case in cases for row in case)
            )
        assert passed == verdict.passed.tolist(), requirement.name
        assert verdict.met == all(np.array(passed)[verdict.samples.inside])
        some += 0 < sum(passed) < len(passed)
    assert some >= 2


def test_the_solid_angle_of_a_box_is_never_too_small():
    """Against rays over the sphere; far away, where the bound is tight, it is exact to 3 %."""
    rng = np.random.default_rng(5)
    way = rng.normal(size=(400_000, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    ratios = []
    for _ in range(12):
        size, yaw = rng.uniform(0.2, 1.5, 3), float(rng.uniform(-3.0, 3.0))
        start = rng.uniform(1.2, 3.0) * way[len(ratios)]
        one = pe.Objects(np.zeros((1, 3)), size[None], [yaw], [0], ["box"])
        own = (way @ oracle.rotation(0.0, 0.0, yaw)), (start @ oracle.rotation(0.0, 0.0, yaw))
        with np.errstate(divide="ignore"):
            t = np.sort([(s * size / 2.0 - own[1]) / own[0] for s in (-1.0, 1.0)], axis=0)
        met = np.maximum(t[0].max(axis=1), 0.0) < t[1].min(axis=1)
        truth = met.mean() * 4.0 * math.pi * (180.0 / math.pi) ** 2
        ratios.append(largest_solid_angle(one, start)[0] / truth)
    assert min(ratios) > 0.97 and max(ratios) < 6.0  # 3 %: the scatter of the rays
    small = pe.Objects(np.zeros((1, 3)), [[0.3, 0.3, 0.3]], [0.0], [0], ["box"])
    far = largest_solid_angle(small, (20.0, 0.0, 0.0))[0]
    assert far == pytest.approx((0.3 / 20.0) ** 2 * (180.0 / math.pi) ** 2, rel=0.03)


def cylinder_hits(start, way, foot, radius, low, high):
    """Distance (B,) at which lines meet an upright cylinder, mantle or top; inf: they do not."""
    flat, offset = way[:, :2], start[:2] - foot
    a, b = (flat**2).sum(axis=1), (flat * offset).sum(axis=1)
    root = b * b - a * ((offset**2).sum() - radius**2)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (-b - np.sqrt(np.maximum(root, 0.0))) / a
        z = start[2] + t * way[:, 2]
        mantle = np.where((root > 0) & (t > 0) & (z >= low) & (z <= high), t, np.inf)
        lid = (high - start[2]) / way[:, 2]
        away = np.hypot(*(offset[:, None] + lid * flat.T))
        top = np.where((lid > 0) & (away <= radius), lid, np.inf)
    return np.minimum(mantle, top)


def camera_points(sensor, foot, radius, high, vehicle, low=0.0):
    """Share of points on a cylinder towards a camera that it shows, by its pinhole and rays."""
    start = np.array(sensor.pose.position)
    towards = math.atan2(*(start[1::-1] - foot[::-1]))
    turn = towards + np.linspace(-1.2, 1.2, 13)
    u, z = np.meshgrid(turn, np.linspace(low + 0.01, high - 0.01, 17))
    points = np.stack([foot[0] + radius * np.cos(u), foot[1] + radius * np.sin(u), z], -1).reshape(
        -1, 3
    )
    offset = points - start
    length = np.linalg.norm(offset, axis=1)
    own = offset @ oracle.rotation(*sensor.pose.rpy)
    focal = sensor.model.width / 2.0 / math.tan(sensor.model.hfov / 2.0)
    with np.errstate(divide="ignore"):
        inside = (own[:, 0] > 0) & (abs(own[:, 1] / own[:, 0]) * focal < sensor.model.width / 2.0)
        inside &= abs(own[:, 2] / own[:, 0]) * focal < sensor.model.height / 2.0
    blocked = oracle.first_hits(start, offset / length[:, None], vehicle.triangles)[0]
    return float((inside & (blocked > length - 1e-6)).mean())


def test_a_cylinder_that_is_seen_is_seen_by_rays_too():
    """The oracle knows real cylinders, lines and triangles. Verdicts err to the safe side only."""
    vehicle, whole = van(), rig()
    zone = Zone(polygon=((-4.3, 0.3), ("front + 1.9", 0.3), (4.4, 2.7), (-4.3, 2.7)), step=0.45)
    body = Body("cylinder", (0.3, 0.3, 0.8), is_round=True)
    names = [s.name for s in whole]
    seen = {}
    for k, name in enumerate(names):  # what one sensor sees: a rig of it alone
        alone = pe.Rig([whole[name]])
        seen[name] = check(Requirement(f"r{k}", zone, (body,)), of=alone)[0]
    points = seen["top"].samples.points
    lidar = whole["top"]
    start = np.array(lidar.pose.position)
    way = lidar.model.directions @ oracle.rotation(*lidar.pose.rpy).T
    ends = oracle.first_hits(start, way, vehicle.triangles)[0]
    wrong, missed = [], []
    for k, foot in enumerate(points):
        for name in names:
            if name == "top":
                truth = (cylinder_hits(start, way, foot, 0.15, 0.0, 0.8) < ends).any()
                surely = (cylinder_hits(start, way, foot, 0.1, 0.01, 0.79) < ends).any()
            else:
                share = camera_points(whole[name], foot, 0.15, 0.8, vehicle)
                truth, surely = (
                    share > 0.0,
                    camera_points(whole[name], foot, 0.1, 0.8, vehicle) > 0.1,
                )
            if seen[name].passed[k] and not truth:
                wrong.append((name, *foot))
            if surely and not seen[name].passed[k]:
                missed.append((name, *foot))
    assert not wrong and not missed
    counts = [int(seen[name].passed.sum()) for name in names]
    assert all(0 < n < len(points) for n in counts), counts


def test_a_share_of_a_cylinder_is_never_too_high():
    """Points on real cylinders by a pinhole and rays: what a picture's side cuts is missing.

    The camera is rolled, so that no side of its picture is upright. The lowest and the highest band
    are left out of the oracle: they count as whole if they are seen in part.
    """
    camera = shapes.camera(70.0, (2.53, 0.1, 0.93), (8.0, 22.0, 14.0), "front")
    zone = Zone(polygon=(("front + 0.6", -1.4), (4.6, -1.4), (4.6, 2.2), (3.0, 2.2)), step=0.2)
    body = Body("cylinder", (0.3, 0.3, 0.8), is_round=True)
    shares = (0.4, 1.0)
    verdicts = check(
        Requirement("touched", zone, (body,)),
        *(Requirement(f"{s}", zone, (body,), Criterion(share=s)) for s in shares),
        of=pe.Rig([camera]),
    )
    vehicle, touched = van(), verdicts[0].passed
    truth = np.array(
        [camera_points(camera, p, 0.15, 0.7, vehicle, 0.1) for p in verdicts[0].samples.points]
    )
    for share, verdict in zip(shares, verdicts[1:], strict=True):
        assert not (verdict.passed & (truth < share)).any()
        assert (verdict.passed & verdict.samples.inside).sum() > 20
    assert (touched & (truth < 0.8)).sum() > 5  # cut at the side, which a point would not tell
    assert (verdicts[1].passed & ~verdicts[2].passed).any()


def test_a_body_of_several_columns_is_visible_in_part():
    """Of a car that is cut across, the columns of a quarter of its length that are whole."""
    car = BODIES["car"]
    centers, sizes = car.boxes(True)
    for cut in np.linspace(-2.04, 2.04, 40):
        seen = centers[:, 0] + sizes[:, 0] / 2.0 > cut
        whole = math.floor(4.0 * (2.05 - cut) / 4.1) / 4.0
        assert visible_share(car, seen[None])[0] == whole, cut
    low = visible_share(car, (centers[:, 2] > 0.2)[None])[0]
    # of 13 bands the 2 lowest are hidden, and 1 counts as cut; outer columns lose up to the posts
    assert low == pytest.approx((12 * (13 - 5) + 4 * (13 - 3)) / (16 * 13))


def test_pixels_in_height_are_never_too_many():
    """The rows of a pinhole between the highest and the lowest corner, and the height by hand."""
    body, places = BODIES["adult"], [(6.0, 1.0), (9.0, -3.0), (20.0, 0.5), (4.0, 3.2), (45.0, 6.0)]
    for rotation in ((0.0, 0.0, 0.0), (20.0, 12.0, 5.0), (0.0, 0.0, -33.0)):
        camera = shapes.camera(100.0, (2.53, 0.0, 1.4), rotation, "front")
        focal = 960.0 / math.tan(math.radians(50.0))
        for x, y in places:
            corners = [
                (x + a, y + b, z) for a in (-0.15, 0.15) for b in (-0.15, 0.15) for z in (0.0, 1.7)
            ]
            own = (np.array(corners) - camera.pose.position) @ oracle.rotation(*camera.pose.rpy)
            with np.errstate(divide="ignore"):
                rows = np.clip(540.0 - own[:, 2] / own[:, 0] * focal, 0.0, 1080.0)
            true = float(np.ptp(rows))
            seen = [
                sees(camera, body, (x, y, 0.0), 0.0, None, Criterion(pixels_high=high))
                for high in (0.8 * true, true + 1e-6)
            ]
            assert not seen[1], (rotation, x, y)
            columns = 960.0 - own[:, 1] / own[:, 0] * focal
            whole = columns.min() > 0.0 and columns.max() < 1920.0 and true < 1080.0
            if not rotation[0] and (own[:, 0] > 0.0).all() and whole:
                assert seen[0], (rotation, x, y)  # upright in the picture: within a fifth


def test_blind_ground_of_a_zone_is_that_of_sight():
    """The squares in the zone, of `Sight.blind` on the same grid; a lost sensor blinds more."""
    zone = Zone(x=("front", "front + 2"), y=(-1, 1))
    own = Requirement("ground", zone, (), Criterion(blind_m2=1.0, blind_height=0.4), Under(True))
    space = pe.PerceptionSpace((-10, 10), (-8, 8), (0, 3), 0.1)
    (verdict,) = RequirementChecker([own], van(), space=space).check(rig())
    whole = Sight(space, pe.Prior.uniform(), van()).blind(rig(), 0.4, within=4.0)
    assert 0.0 < verdict.blind_m2 <= whole.area + 0.01
    assert verdict.met is (verdict.blind_m2 <= 1.0 and all(verdict.without.values()))
    (tight,) = RequirementChecker(
        [replace(own, criterion=Criterion(blind_out=0.0, blind_height=0.4))], van(), space=space
    ).check(rig())
    assert not tight.met


def test_losses_hidden_parts_and_the_worst_place_are_named():
    behind = Requirement(
        "behind", Zone(x=("rear + 0.4", "rear + 1.6"), y=(-0.6, 0.6)), (BODIES["adult"],)
    )
    (found,) = check(behind)
    assert found.met and found.breaks_without == ("rear",)
    assert found.without == {"top": True, "front": True, "rear": False}
    alone = pe.Rig([rig()["top"], rig()["front"]])
    (lost,) = check(behind, of=alone)
    assert not lost.met and lost.margin < 0.0 and lost.worst is not None
    assert set(lost.hidden) == {"top", "front"} and "body" in lost.hidden.values()
    assert "not met, fails" in lost.text
    assert lost.to_dict()["worst"] == list(lost.worst)


def test_a_stricter_requirement_is_never_easier():
    """More sensors, more pixels, a larger zone, a lost sensor: no sample is won by any of them."""
    body = (BODIES["child"],)
    base = Criterion()
    strict = [
        replace(base, sensors=2),
        replace(base, pixels=5e4, points=30),
        replace(base, share=0.9),
    ]
    loose, *others = check(
        Requirement("base", AHEAD, body, base),
        *(Requirement(f"s{k}", AHEAD, body, c) for k, c in enumerate(strict)),
        Requirement("lost", AHEAD, body, base, Under(one_lost=True)),
    )
    assert all(not (v.passed & ~loose.passed).any() for v in others)
    assert any((loose.passed & ~v.passed).any() for v in others)


def test_a_preview_asks_of_the_zone_alone_and_says_so():
    requirement = Requirement("ahead", MIDDLE, (BODIES["child"],))
    (whole,), (preview,) = check(requirement), check(requirement, preview=True)
    assert preview.preview and preview.text.endswith("(preview)") and preview.margin is None
    assert len(preview.passed) == whole.samples.inside.sum()
    assert preview.passed.tolist() == whole.passed[whole.samples.inside].tolist()


def test_a_sensor_that_has_not_moved_is_not_measured_again(monkeypatch):
    measured = []
    one = ObjectMeasurementCache._one

    def noted(self, sensor):
        before = self._measured.get(sensor.name)
        m = one(self, sensor)
        if before is None or before[1] is not m:
            measured.append(sensor.name)
        return m

    monkeypatch.setattr(ObjectMeasurementCache, "_one", noted)
    checker = RequirementChecker([Requirement("ahead", AHEAD, (BODIES["child"],))], van())
    whole = rig()
    checker.check(whole)
    moved = [s.pose for s in whole]
    moved[1] = pe.Pose((2.53, 0.3, 0.93), moved[1].rpy)
    checker.check(whole.with_poses(moved))
    assert measured == ["top", "front", "rear", "front"]


def test_mounting_errors_count_where_they_are_asked_for():
    """A case that sees nothing breaks the requirement under mounting errors, and that one alone."""
    two = [
        Requirement(name, MIDDLE, (BODIES["child"],), under=Under(mounting=name == "off"))
        for name in ("as built", "off")
    ]
    blind = pe.Rig([replace(s, pose=pe.Pose((0.0, 0.0, 1.0))) for s in rig()])  # inside the body
    as_built, off = check(*two, cases=[blind])
    assert as_built.met and not off.met and off.met_whole


# --- presets, files, bad input ------------------------------------------------------------------


def test_presets_have_sources_and_come_back_from_a_file_the_same():
    found = []
    for key, each in presets().items():
        if each.confidence not in ("A", "B") or len(each.source) < 10 or not each.check:
            found.append(f"{key}: confidence or source")
        requirement = each.requirement()
        for name in (key, "another name"):
            changed = replace(requirement, name=name, under=Under(one_lost=name != key))
            again = read_requirement(Table(requirement_table(changed), "file"))
            if again != changed:
                found.append(f"{key}: {requirement_table(changed)}")
    assert not found and len(presets()) > 20


def test_a_requirement_of_ones_own_comes_back_from_a_file_the_same():
    own = Requirement(
        "own",
        Zone(
            polygon=(("front", 0.0), ("front + 2", "left + 1"), (5.0, -1.0)), z=(0.0, 1.0), step=0.5
        ),
        (
            BODIES["car"],
            Body("bin", (0.4, 0.4, 1.1), is_round=True, low=0.1, headings=BODIES["car"].headings),
        ),
        Criterion(kinds=2, points=5, share=0.5, ap=None, zone_share=0.9),
        Under(one_lost=True),
    )
    study = pe.Study(rig(), van(), requirements=(own, replace(own, name="two", zone=AHEAD)))
    odd = replace(BODIES["child"], headings=(as_in_file(math.radians(33.3)), as_in_file(-1.234567)))
    table = requirement_table(Requirement("odd", AHEAD, (odd,)))
    assert read_requirement(Table(table, "file")).bodies == (odd,)
    data = study_to_dict(study)
    assert [read_requirement(Table(each, "f")) for each in data["requirement"]] == list(
        study.requirements
    )
    assert dumps(data).count("[[requirement]]") == 2


TABLE = {"name": "a", "body": "child", "zone": {"x": ["front", "front + 1"], "y": [-1, 1]}}
BAD = {
    "no zone": ({"zone": {}}, "zone"),
    "two shapes": ({"zone": {"x": [0, 1], "y": [0, 1], "ring": [0, 1]}}, "one of x and y"),
    "no extent": ({"zone": {"x": [4, 4], "y": [0, 1]}}, "some extent"),
    "inside": ({"zone": {"x": [-1, 1], "y": [-0.5, 0.5]}}, "inside the vehicle"),
    "outside": ({"zone": {"x": [500, 501], "y": [0, 1]}}, "in the space"),
    "step": ({"zone": {"x": [0, 90], "y": [2, 40], "step": 0.02}}, "at most 20,000 samples"),
    "anchor": ({"zone": {"x": ["bow", 1], "y": [0, 1]}}, "planes front"),
    "door": ({"zone": {"x": ["door", 9], "y": [2, 3]}}, "word door"),
    "axle": ({"zone": {"x": ["front_axle", 9], "y": [2, 3]}}, "named wheel"),
    "narrow": ({"body": "car"}, "not larger than the zone"),
    "body": ({"body": "dragon"}, "one of cylinder"),
    "kinds": ({"criterion": {"kinds": 3}}, "the number of kinds"),
    "of": ({"criterion": {"of": ["lidar", "sonar"]}}, "sonar"),
    "lacking": ({"criterion": {"of": ["camera"]}}, "no sensor"),
    "rows": ({"criterion": {"pixels_high": 9}}, "a kind that counts pixels"),
    "no row": ({"criterion": {"pixels_high": 0}}, "above 0"),
    "key": ({"zone": {"x": [3, 4], "y": [0, 1], "stepp": 1}}, "unknown key"),
    "preset": ({"preset": "r000"}, "pe requirements"),
    "ap": ({"body": "pole_ring", "criterion": {"ap": 0.5}}, "a class"),
    "twice": ({}, "each name once"),
    "mounting": ({"under": {"mounting": True}}, "tolerance"),
    "heading": ({"headings": "north"}, "angles"),
}


def test_bad_input_is_one_line_that_names_it(tmp_path):
    """Through the study file: the line has the file or the requirement, and what was expected."""
    lidar = study_to_dict(pe.Study(pe.Rig([rig()["top"]]), van()))
    mesh = tmp_path / "van.npz"
    pe.write_mesh(mesh, pe.Mesh(van().triangles, van().parts, van().part_names))
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
