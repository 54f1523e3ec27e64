"""What sensors see of test bodies: verdicts held to the definition, and to an oracle of rays."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.scoring.requirements import (
    BODIES,
    Body,
    Criterion,
    Requirement,
    RobustTo,
    Zone,
    body_met,
    sees,
)
from pe_core.scoring.requirements.definition import parts_of, visible_share
from pe_core.sensors import ObjectMeasurementCache, kind_of
from pe_tools.verify import oracle
from tests.engine import shapes
from tests.engine.requirement_scene import AHEAD, check, rig, van
from tests.thorough import tries

RING = BODIES["pole_ring"]
RING_SHIFTS = np.arange(-40, 41) * 2e-3
"""How far a ring is moved across what cuts it [m]."""
LOW_LIDARS = {
    "upright": shapes.lidar_on_roof(
        shapes.small_lidar(20, 367), (2.6, 0.107, 0.433), (0, 0, 0), "l"
    ),
    "tilted": shapes.lidar_on_roof(shapes.small_lidar(17, 367), (2.6, 0.107, 1.9), (4, 38, 3), "l"),
}


def test_verdicts_are_those_of_the_definition():
    """Samples, bodies and headings, by `sees` and `body_met`; every lost sensor, too.

    By default every third sample, else each one.
    """
    bodies = (BODIES["child"], BODIES["cyclist"], BODIES["pole_ring"])
    requirements = [
        Requirement(
            "k", AHEAD, bodies[:2], Criterion(sensors=2), robust_to=RobustTo(one_lost=True)
        ),
        Requirement("kinds", AHEAD, bodies[:1], Criterion(kinds=2, points=4, pixels=4000.0)),
        Requirement("share", AHEAD, (BODIES["cylinder"],), Criterion(share=0.6)),
        Requirement("ring", AHEAD, bodies[2:], Criterion(share=1.0, of=("camera",))),
    ]
    vehicle = van()
    whole = rig()
    every = tries(3, 1)
    some = 0
    for requirement, verdict in zip(requirements, check(*requirements), strict=True):
        passed = []
        for x, y in verdict.samples.points[::every]:
            seen = [
                {
                    s.name: sees(
                        s, b, (x, y, 0.0), h, vehicle=vehicle, criterion=requirement.criterion
                    )
                    for s in whole
                }
                for b in requirement.bodies
                for h in b.headings
            ]
            lost = [s.name for s in whole] if requirement.robust_to.one_lost else []
            cases = [seen, *([{**row, name: False} for row in seen] for name in lost)]
            passed.append(
                all(body_met(row, whole, requirement.criterion) for case in cases for row in case)
            )
        assert passed == verdict.passed[::every].tolist(), requirement.name
        assert verdict.met == verdict.passed[verdict.samples.inside].all()
        some += 0 < sum(passed) < len(passed)
    assert some >= 2


def cylinder_hits(start, way, foot, radius, low, high):
    """Distance (B,) at which lines meet an upright cylinder, mantle or top; inf: they do not."""
    flat = way[:, :2]
    offset = start[:2] - foot
    a = (flat**2).sum(axis=1)
    b = (flat * offset).sum(axis=1)
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
    own = offset @ oracle.rotation(sensor.pose.rpy)
    focal = sensor.model.width / 2.0 / math.tan(sensor.model.hfov / 2.0)
    with np.errstate(divide="ignore"):
        inside = (own[:, 0] > 0) & (abs(own[:, 1] / own[:, 0]) * focal < sensor.model.width / 2.0)
        inside &= abs(own[:, 2] / own[:, 0]) * focal < sensor.model.height / 2.0
    blocked = oracle.first_hits(start, offset / length[:, None], vehicle.triangles)[0]
    return float((inside & (blocked > length - 1e-6)).mean())


def test_a_cylinder_that_is_seen_is_seen_by_rays_too():
    """The oracle knows real cylinders, lines and triangles. Verdicts err to the safe side only."""
    vehicle = van()
    whole = rig()
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
    way = lidar.model.directions @ oracle.rotation(lidar.pose.rpy).T
    ends = oracle.first_hits(start, way, vehicle.triangles)[0]
    wrong = []
    missed = []
    for k, foot in enumerate(points):
        for name in names:
            if name == "top":
                truth = (
                    cylinder_hits(start, way, foot, radius=0.15, low=0.0, high=0.8) < ends
                ).any()
                surely = (
                    cylinder_hits(start, way, foot, radius=0.1, low=0.01, high=0.79) < ends
                ).any()
            else:
                share = camera_points(whole[name], foot, radius=0.15, high=0.8, vehicle=vehicle)
                truth = share > 0.0
                surely = (
                    camera_points(whole[name], foot, radius=0.1, high=0.8, vehicle=vehicle) > 0.1
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
    vehicle = van()
    touched = verdicts[0].passed
    truth = np.array(
        [
            camera_points(camera, p, radius=0.15, high=0.7, vehicle=vehicle, low=0.1)
            for p in verdicts[0].samples.points
        ]
    )
    for share, verdict in zip(shares, verdicts[1:], strict=True):
        assert not (verdict.passed & (truth < share)).any()
        assert (verdict.passed & verdict.samples.inside).sum() > 20
    assert (touched & (truth < 0.8)).sum() > 5  # cut at the side, which a point would not tell
    assert (verdicts[1].passed & ~verdicts[2].passed).any()


def ring_is_whole(shown):
    """Whether points on the rim of the ring, each 1 mm apart and at both edges, are all shown."""
    turns = np.linspace(0.0, 2.0 * math.pi, 158)
    rim = 0.025 * np.column_stack([np.cos(turns), np.sin(turns)])
    return all(shown(np.column_stack([rim, np.full(158, z)])).all() for z in (0.9, 0.91))


@pytest.mark.parametrize("rotation", [(0, 0, 0), (25, 12, 8)], ids=["level", "rolled"])
def test_a_ring_that_a_side_of_the_picture_cuts_is_not_whole(rotation):
    """Points of the rim through a pinhole, for rings that are moved over each side of the picture:
    what is met has all points in it. The posts are at the corners of a box, up to 0.41 radii
    outside of the rim: what is 12 mm inside is met."""
    camera = shapes.camera(60.0, (0.0, 0.0, 0.905), rotation, "front")
    turn = oracle.rotation(camera.pose.rpy)
    focal = 960.0 / math.tan(math.radians(30.0))
    whole = cut = 0
    for side, most in ((1, 960.0), (-1, -960.0), (2, 540.0), (-2, -540.0)):
        ends = {abs(side): most / focal, 3 - abs(side): 0.1}
        middle = turn @ np.array([2.0, 2.0 * ends[1], 2.0 * ends[2]])
        foot = middle  # the ring's middle is 0.905 m above its foot, as high as the camera
        across = turn[:, abs(side)] * np.sign(most)
        for shift in RING_SHIFTS:
            place = foot + across * shift

            def shown(points, place=place):
                own = (points + place - (0.0, 0.0, 0.905)) @ turn
                inside = abs(own[:, 1] / own[:, 0]) * focal <= 960.0
                return inside & (abs(own[:, 2] / own[:, 0]) * focal <= 540.0)

            met = sees(
                camera,
                RING,
                tuple(place),
                heading=0.0,
                vehicle=None,
                criterion=Criterion(share=1.0),
            )
            truth = ring_is_whole(shown)
            assert truth or not met, (side, shift)
            whole = whole + met
            cut = cut + (not truth)
            further = place + 0.012 * across
            assert met or not ring_is_whole(lambda p, at=further: shown(p, at)), (side, shift)
    assert whole > 40 and cut > 40


@pytest.mark.parametrize("wide_m", [0.005, 0.012, 0.2])
def test_a_ring_that_a_part_of_the_vehicle_cuts_is_not_whole(wide_m):
    """An upright bar before the ring, moved across it: whole only where it hides no point."""
    camera = shapes.camera(60.0, (0.0, 0.0, 0.905), (0, 0, 0), "front")
    whole = cut = 0
    for shift in np.arange(-70, 71) * 2e-3:
        low = (1.5, shift - wide_m / 2.0, 0.5)
        high = (1.51, shift + wide_m / 2.0, 1.4)
        bar = pe.Vehicle(shapes.box(low, high))
        met = sees(
            camera, RING, (3.0, 0.0, 0.0), heading=0.0, vehicle=bar, criterion=Criterion(share=1.0)
        )

        def shown(points, low=low, high=high):
            ways = points[:, 1] / (points[:, 0] + 3.0)
            across = np.array([1.5, 1.51])[:, None] * ways
            return (across.max(axis=0) < low[1]) | (across.min(axis=0) > high[1])

        truth = ring_is_whole(shown)
        assert truth or not met, shift
        whole = whole + met
        cut = cut + (not truth)
    assert whole > 20 and cut > 10


def box_entries(start, way, foot, heading, low, high):
    """Distance (B,) at which lines enter a box turned by a heading; inf: they do not."""
    turn = oracle.rotation((0.0, 0.0, heading))
    own = way @ turn
    offset = (start - [*foot, 0.0]) @ turn
    with np.errstate(divide="ignore"):
        t = np.sort([(np.array(s) - offset) / own for s in (low, high)], axis=0)
    enter = np.maximum(t[0].max(axis=1), 0.0)
    leave = t[1].min(axis=1)
    return np.where(enter < leave, enter, np.inf)


@pytest.mark.parametrize("lidar", LOW_LIDARS.values(), ids=LOW_LIDARS)
def test_beams_are_shared_out_among_bands_by_where_they_end(lidar):
    """Brute force: each beam's end on a box, its band, and the columns that it meets there.

    A beam that ends in one band and would enter the next is not in that; so the bands' beams are
    together those of the box, where it has one column.
    """
    vehicle = van()
    start = np.array(lidar.pose.position)
    way = lidar.model.directions @ oracle.rotation(lidar.pose.rpy).T
    ends = np.minimum(oracle.first_hits(start, way, vehicle.triangles)[0], lidar.model.max_range)
    feet = [(3.312, 0.413, 0.0), (4.127, -0.731, 0.0), (5.618, 2.239, 0.0)]
    passed_on = 0
    for body in (Body("bin", (0.45, 0.3, 0.9)), BODIES["car"]):
        away = (0.0, 0.0, 0.0) if body.size[0] < 1.0 else (2.5, 0.0, 0.0)
        places = [tuple(np.add(foot, away)) for foot in feet]
        parts = parts_of(body, places, (0.0, 0.6))
        headings = (0.0, 0.6)
        found = kind_of(lidar).measure_parts(lidar, parts, vehicle)
        kernel = ObjectMeasurementCache(parts, vehicle).measure([lidar])["l"]
        assert kernel.tolist() == found.tolist()
        bands, posts = body.cell_bands()
        centers, sizes = body.boxes(True)
        found = found.reshape(len(places), 2, -1)
        half = np.array(body.size) / 2.0
        tall = body.size[2] / body.bands
        for place, heading in np.ndindex(len(places), 2):
            at = places[place][:2], headings[heading]
            enter = box_entries(start, way, *at, [*-half[:2], 0.0], [*half[:2], body.size[2]])
            hit = enter <= ends
            z = start[2] + enter[hit] * way[hit, 2]
            end = np.clip(np.floor(z / tall).astype(int), 0, body.bands - 1)
            for cell in np.flatnonzero(~posts):
                low = centers[cell] - sizes[cell] / 2.0
                high = centers[cell] + sizes[cell] / 2.0
                meets = np.isfinite(box_entries(start, way[hit], *at, low, high))
                assert found[place, heading, cell] == (meets & (end == bands[cell])).sum()
                passed_on += int((meets & (end != bands[cell])).sum())
            if body.columns == (1, 1):
                assert found[place, heading, ~posts].sum() == hit.sum()
    assert passed_on > 50


@pytest.mark.parametrize("lidar", LOW_LIDARS.values(), ids=LOW_LIDARS)
def test_a_share_by_a_lidar_is_never_too_high(lidar):
    """Bands of real cylinders on which a beam ends, by lines: no verdict counts another."""
    zone = Zone(x=("front + 0.4", "front + 3"), y=(-1.0, 1.2), step=0.2)
    body = Body("cylinder", (0.3, 0.3, 0.8), is_round=True)
    shares = (0.2, 0.5, 1.0)
    vehicle = van()
    start = np.array(lidar.pose.position)
    verdicts = check(
        *(Requirement(f"{s}", zone, (body,), Criterion(share=s)) for s in shares),
        of=pe.Rig([lidar]),
    )
    way = lidar.model.directions @ oracle.rotation(lidar.pose.rpy).T
    ends = oracle.first_hits(start, way, vehicle.triangles)[0]
    truth = []
    for foot in verdicts[0].samples.points:
        t = cylinder_hits(start, way, foot, radius=0.15, low=0.0, high=0.8)
        z = start[2] + t[t < ends] * way[t < ends, 2]
        truth.append(len(np.unique(np.clip(np.floor(z / 0.1), 0, 7))) / 8.0)
    for share, verdict in zip(shares, verdicts, strict=True):
        assert not (verdict.passed & (np.array(truth) < share - 1e-9)).any(), share
    assert verdicts[0].passed.any()


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
