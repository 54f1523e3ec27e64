"""Searches with mounts: what breaks a rule is nowhere, and a LiDAR stands on its roof."""

from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.search import Parametrization, pose_values
from pe_tools.cli.verbs import main
from tests.engine import mounting, shapes
from tests.engine.mounting import ON_ROOF, can, roof
from tests.engine.recording import Recorder, flat
from tests.few_errors import draw_few

ROOT = Path(__file__).parents[2]
BASE_M = 0.04
SEDAN = """
[vehicle]
mesh = "sedan.npz"
glass = ["rear_window", "windows_left", "windows_right", "windshield"]
[[sensor]]
name = "roof"
model = "Pandar64"
position = [-0.429, 0.0, 1.534]
mount = "roof"
[optimize]
method = "random"
candidates = 12
samples = 4096
[[optimize.mount]]
name = "roof"
parts = ["roof"]
standoff = 0.04
"""


def forward(rig):
    """A landscape: the farther ahead, the better."""
    return -sum(pose_values(sensor.pose)["x"] for sensor in rig)


def searched(landscape, *sensors, candidates=30, seed=0, **options):
    """Parametrization, recorder and steps of a search on the box car."""
    rig, space = mounting.space(*sensors, **options)
    recorder = Recorder(landscape)
    schedule = pe.Schedule(candidates=candidates)
    steps = list(pe.optimize(recorder, rig, space, seed, schedule=schedule, method="random"))
    return Parametrization(rig, space), recorder, steps


def test_what_breaks_a_rule_is_never_scored_and_never_the_best():
    """Ahead is better, and there a no-go box begins."""
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(-0.2, 3.0))])
    options = {"mount": {"roof": roof()}, "constraints": limits}
    coding, recorder, steps = searched(forward, can(), **options)
    assert len(steps) == 211
    assert not any(coding.broken(rig) for rig in recorder.rigs)
    best = steps[-1].best["roof"].pose.position[0]
    assert best == pytest.approx(-0.2 - mounting.RADIUS, abs=0.02)
    _, without, steps = searched(forward, can(), mount={"roof": roof()})
    assert steps[-1].best["roof"].pose.position[0] > 0.5
    assert any(coding.broken(rig) for rig in without.rigs)


def test_candidates_that_cannot_be_are_counted_in_the_search_s_length_not_as_scored():
    """Where hardly anything is allowed, some candidates are not found; the search still ends."""
    limits = pe.Constraints(no_go=[pe.NoGo("a", x=(-9, -0.484)), pe.NoGo("b", x=(-0.376, 9))])
    tiny = {"mount": {"roof": roof()}, "constraints": limits, "free": ()}
    coding, recorder, steps = searched(flat, can((-0.43, 0.0, ON_ROOF[2])), candidates=4, **tiny)
    assert len(steps) == 29 and steps[-1].fraction == 1.0
    assert steps[-1].evaluations == len(recorder.rigs) < 29
    assert not any(coding.broken(rig) for rig in recorder.rigs)


def test_slots_are_all_tried_and_the_best_is_found():
    slots = [pe.Slot(str(x), pe.Pose((float(x), 0.0, 2.5))) for x in range(6)]
    rack = {"roof": pe.SlotMount(slots)}
    _, recorder, steps = searched(forward, can((2.0, 0.0, 2.5)), candidates=60, mount=rack)
    assert {rig["roof"].pose.position[0] for rig in recorder.rigs} == set(map(float, range(6)))
    assert steps[-1].best["roof"].pose.position[0] == 5.0


def study(**limits):
    """A small LiDAR in the air over the box car; up is free."""
    rig = shapes.roof_rig(16, 180)
    search = pe.Search(
        {"roof": ("z",)}, samples=1024, schedule=pe.Schedule(candidates=3), method="random"
    )
    given = {"search": search, "samples": 1024, "limits": pe.Limits(**limits)}
    return pe.Study(rig, mounting.car(), shapes.small_space(), **given)


def outcome_of(study):
    job = pt.OptimizeJob(study, 1)
    assert list(job)
    return job.outcome


@pytest.mark.usefixtures("few_errors", "no_key_figures")
def test_a_start_that_breaks_a_rule_is_not_returned_though_it_is_the_best():
    """Under a low ceiling the roof hides much: all that is allowed is worse than the start."""
    free = outcome_of(study())
    under = outcome_of(study(height=1.5))
    assert free.after.entropy <= free.before.entropy < under.after.entropy
    assert under.study.rig["roof"].pose.position[2] <= 1.5
    assert all(row.rig["roof"].pose.position[2] <= 1.5 for row in under.history)


@pytest.fixture(scope="module")
def sedan(tmp_path_factory):
    """The command's result for the sedan, and its vehicle."""
    folder = tmp_path_factory.mktemp("sedan")
    (folder / "sedan.npz").write_bytes((ROOT / "blend_assets" / "sedan.npz").read_bytes())
    (folder / "study.toml").write_text(SEDAN, "utf-8")
    out = folder / "out"
    options = ["--no-review", "-o", str(out), "--samples", "4096", "--workers", "1"]
    with pytest.MonkeyPatch.context() as patch:
        draw_few(patch)
        assert main(["optimize", str(folder / "study.toml"), *options]) == 0
    return out, pe.load_study(out / "study.toml")


def test_the_sedan_s_roof_lidar_stands_on_the_roof_on_a_base_of_40_mm(sedan):
    """From its base, 40 mm along the roof's normal is the roof, and the housing cuts nothing."""
    _, found = sedan
    pose = found.rig["roof"].pose
    housing = pe.catalog.housing("Pandar64")
    assert pe.cuts_body(pose, housing, found.vehicle) == ()
    assert pose.position != (-0.429, 0.0, 1.534)
    base = np.array(pose.position) - pose.ground_from_sensor @ housing.optical_center
    rays = np.random.default_rng(0).normal(size=(4000, 3))
    rays[:, 2] = -np.abs(rays[:, 2]) - 1.0
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    hits = found.vehicle.first_hit_from(base, rays)
    nearest = int(np.argmin(hits.distance))
    assert found.vehicle.part_names[found.vehicle.parts[hits.face[nearest]]] == "roof"
    assert hits.distance[nearest] == pytest.approx(BASE_M, abs=2e-4)


def floating(*, slot=False):
    """A study whose left LiDAR floats 0.5 m over the roof, its mirror image and its camera too."""
    left = can((-0.4, 0.3, 1.9), "left")
    right = can((-0.4, -0.3, 1.9), "right")
    eye = pe.Sensor("eye", pe.catalog.load("Camera 60 deg"), pe.Pose((-0.1, 0.3, 1.9)))
    mount = roof()
    if slot:
        slots = {"a": pe.Pose((-0.4, 0.3, 1.6)), "b": pe.Pose((9.0, 0.0, 1.0))}
        mount = pe.SlotMount([pe.Slot(name, pose) for name, pose in slots.items()])
    own = pe.Mounting({"roof": mount}, {"left": "roof"}, [("left", "right")], [("left", "eye")])
    search = pe.Search(samples=1024, evaluations=4, mounting=own)
    space = pe.PerceptionSpace((-12, 12), (-8, 8), (0, 3), 0.5)
    rig = pe.Rig([left, right, eye])
    return pe.Study(rig, mounting.car(), space, search=search, samples=1024, mesh="car.npz")


@pytest.mark.parametrize("slot", [False, True])
def test_a_start_beside_its_mount_can_be_put_there_with_all_that_follow(slot):
    """By hand: the roof is 1.4 m high, 0.04 m of stand-off, 0.0377 m from base to origin."""
    study = floating(slot=slot)
    with pytest.raises(pe.InputError, match="position"):
        study.coding()
    placed = study.on_mounts()
    placed.coding()
    height = 1.6 if slot else 1.4 + 0.04 + 0.0377
    found = [sensor.pose.position for sensor in placed.rig]
    wanted = [(-0.4, 0.3, height), (-0.4, -0.3, height), (-0.1, 0.3, height)]
    assert np.allclose(found, wanted, atol=1e-5)
    again = placed.on_mounts()
    assert [s.pose for s in again.rig] == [s.pose for s in placed.rig], "what is there stays"


def test_the_command_puts_sensors_on_their_mounts_and_says_so(tmp_path, capsys):
    pt.export_study(floating(), tmp_path / "car.toml")
    line = ["optimize", str(tmp_path / "car.toml"), "--json", "--no-review"]
    assert main(line) == 1
    assert "a start on its mount" in capsys.readouterr().err
    assert main([*line, "--snap"]) == 0
    told = capsys.readouterr().err
    assert all(f"{name}: put on its mount" in told for name in ("left", "right", "eye"))
