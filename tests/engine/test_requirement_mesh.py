"""Test bodies from meshes: boxes wholly inside them, shares of their surface, bad files."""

import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.table_reader import Table
from pe_core.scoring.requirements import (
    Body,
    Criterion,
    MeshShape,
    Requirement,
    RequirementChecker,
    Zone,
    sees,
)
from pe_core.scoring.requirements.definition import visible_share
from pe_core.scoring.requirements.mesh_shape import largest_rectangle, surface_shares
from pe_core.study.requirement_file import read_requirement, requirement_table
from pe_tools.jobs.study_export import fingerprint
from tests.engine import shapes

AHEAD = Zone(x=("front + 0.4", "front + 1.6"), y=(-1.0, 1.0), step=0.4)


def ball(radius, count=16):
    """A closed ball that lies on z = 1 m, round (3, 1)."""
    turns, tilts = np.linspace(0, 2 * np.pi, count + 1), np.linspace(0, np.pi, count + 1)
    u, w = np.meshgrid(turns, tilts, indexing="ij")
    points = np.stack([np.sin(w) * np.cos(u), np.sin(w) * np.sin(u), np.cos(w)], axis=-1)
    points = radius * points + [3.0, 1.0, 1.0 + radius]
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    faces = [np.stack(t, axis=-2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))]
    return np.concatenate(faces)


def test_boxes_lie_wholly_inside_a_ball_and_fill_it_well():
    """No corner is outside; the largest box has most of the volume that the best one has."""
    shape = MeshShape.of("ball", ball(0.5))
    assert np.allclose(shape.size, [1.0, 1.0, 1.0], atol=0.01)
    for x, y, z in np.ndindex(2, 2, 2):
        corners = shape.centers + shape.sizes * (np.array([x, y, z]) - 0.5)
        assert (np.linalg.norm(corners - [0.0, 0.0, 0.5], axis=1) < 0.5).all()
    assert np.prod(shape.sizes, axis=1).max() > 0.75 * (2.0 * 0.5 / math.sqrt(3.0)) ** 3
    assert np.ptp(shape.centers[:, 2]) > 0.7  # from the foot to the top


def test_largest_rectangles_are_those_of_all_rectangles():
    rng = np.random.default_rng(5)
    for _ in range(30):
        flags = rng.random((6, 7)) < 0.7
        best = max(
            (i1 - i0) * (j1 - j0)
            for i0 in range(6)
            for i1 in range(i0 + 1, 7)
            for j0 in range(7)
            for j1 in range(j0 + 1, 8)
            if flags[i0:i1, j0:j1].all()
        )
        i0, j0, i1, j1 = largest_rectangle(flags)
        assert flags[i0:i1, j0:j1].all() and (i1 - i0) * (j1 - j0) == best
    assert largest_rectangle(np.zeros((3, 3), bool)) is None


def test_a_share_of_a_mesh_is_one_of_its_surface():
    """Of a post on a wide plate: the plate's band has most of the surface."""
    plate = shapes.box((0, 0, 0), (1.0, 1.0, 0.08))
    post = shapes.box((0.4, 0.4, 0.05), (0.6, 0.6, 1.0))
    shape = MeshShape.of("lamp", np.concatenate([plate, post]))
    body = Body("lamp", shape.size, shape=shape)
    shares = surface_shares(shape, body.bands, *body.columns)
    assert shares.sum() == pytest.approx(1.0)
    area = 2.0 + 4 * 0.08 + 2 * 0.04 + 4 * 0.2 * 0.95
    assert shares[0].sum() == pytest.approx((2.0 + 0.32 + 0.04 + 4 * 0.2 * 0.05) / area, abs=0.02)
    centers, _ = body.boxes(True)
    above = visible_share(body, (centers[:, 2] > 0.3)[None])[0]
    assert 0.0 < above < 1.0 - shares[0].sum()


def test_verdicts_on_a_mesh_are_those_of_the_definition_and_never_easier_than_its_extent():
    """A ball is seen where one of its boxes is; a box of its extent is seen at least there."""
    vehicle = pe.Vehicle(shapes.box((-2.5, -1.0, 0.25), (2.5, 1.0, 2.4)), clearance=0.0)
    rig = pe.Rig(
        [
            shapes.lidar_on_roof(shapes.small_lidar(24, 720), (2.37, 0.2, 2.63), (0, 9, 0), "top"),
            shapes.camera(60.0, (2.53, 0.0, 0.93), (0.0, 18.0, 20.0), "front"),
        ]
    )
    shape = MeshShape.of("ball", ball(0.2))
    mesh, extent = Body("ball", shape.size, shape=shape), Body("box", shape.size)
    for criterion in (Criterion(), Criterion(points=12, pixels=9000.0), Criterion(share=0.7)):
        asked = [Requirement(b.name, AHEAD, (b,), criterion) for b in (mesh, extent)]
        own, outer = RequirementChecker(asked, vehicle).check(rig)
        truth = [
            any(sees(s, mesh, (x, y, 0.0), 0.0, vehicle, criterion) for s in rig)
            for x, y in own.samples.points
        ]
        assert own.passed.tolist() == truth
        if criterion.share is None:
            assert not (own.passed & ~outer.passed).any()
    assert 0 < sum(truth) < len(truth)


def test_a_mesh_comes_from_a_file_and_back(tmp_path):
    pt.write_mesh(tmp_path / "ball.obj", pe.Mesh(ball(0.2), np.zeros(512, np.int32), ("ball",)))
    body = {"mesh": "ball.obj", "scale": 2.0, "name": "ball", "low": 0.5, "class": "pedestrian"}
    table = {"name": "a", "body": [body], "zone": {"x": ["front", "front + 2"], "y": [-1, 1]}}
    read = read_requirement(Table(table, "study"), tmp_path)
    assert np.allclose(read.bodies[0].size, 0.8, atol=0.02) and read.bodies[0].low == 0.5
    again = requirement_table(read)
    assert again["body"] == [body]
    assert read_requirement(Table(again, "study"), tmp_path) == read
    vehicle = pe.Vehicle(shapes.box((-2.5, -1.0, 0.25), (2.5, 1.0, 2.4)))
    rig = pe.Rig([shapes.camera(60.0, (2.53, 0.0, 0.93), (0.0, 18.0, 0.0), "front")])
    study = pe.Study(rig, vehicle, requirements=[read])
    (tmp_path / "elsewhere").mkdir()
    pt.export_study(study, tmp_path / "elsewhere" / "study.toml")
    there = pe.load_study(tmp_path / "elsewhere" / "study.toml")
    assert there.requirements == study.requirements
    assert fingerprint(there) == fingerprint(study)
    (tmp_path / "vehicle.npz").write_bytes((tmp_path / "elsewhere" / "vehicle.npz").read_bytes())
    with pytest.raises(pe.InputError, match=r"body\.mesh"):
        pe.save_study(there, tmp_path / "study.toml")
    turned = replace(read.bodies[0], headings=(1.0,))
    assert turned.boxes(False)[0].min(axis=0)[2] > 0.5


BAD = {
    "missing": ({"mesh": "none.obj"}, "none.obj"),
    "no mesh": ({"mesh": "words.stl"}, "words.stl"),
    "suffix": ({"mesh": "ball.txt"}, "ball.txt"),
    "open": ({"mesh": "open.obj"}, "no space inside it"),
    "millimetres": ({"mesh": "ball.obj", "scale": 1000.0}, "sides of"),
    "axis": ({"mesh": "ball.obj", "up": "north"}, "+x"),
    "key": ({"mesh": "ball.obj", "size": [1, 1, 1]}, "unknown key"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_mesh_is_one_line_that_names_it(tmp_path, name):
    faces = ball(0.2)
    for file, some in (("ball", faces), ("open", faces[::2])):
        parts = np.zeros(len(some), np.int32)
        pt.write_mesh(tmp_path / f"{file}.obj", pe.Mesh(some, parts, ("ball",)))
    (tmp_path / "words.stl").write_text("no mesh at all")
    (tmp_path / "ball.txt").write_text("1 2 3")
    change, expected = BAD[name]
    table = {"name": "a", "body": change, "zone": {"x": ["front", "front + 2"], "y": [-1, 1]}}
    with pytest.raises(pe.InputError) as caught:
        read_requirement(Table(table, "file.toml"), tmp_path)
    line = str(caught.value)
    assert expected in line and "\n" not in line and "file.toml" in line
