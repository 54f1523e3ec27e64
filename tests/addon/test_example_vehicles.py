"""The example vehicles, the sedan and the shuttle bus, as they are shipped."""

import json
import re
import shlex
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from blender_addon.engine import search
from pe_core.geometry.poses import rotation_matrix
from pe_core.sensors import kind_of
from tests.addon import scenes
from tests.addon.command_line import run_here
from tests.engine import surfaces

TOOLS = scenes.ASSETS.parent / "tools"
sys.path.insert(0, str(TOOLS))
import demo_scene  # noqa: E402

OUTSIDE_THE_SHELL = ("wheel", "plate", "roof_pod")


@pytest.fixture(scope="module")
def shipped(registered):
    """The studies of both, evaluated on few voxels: a file is opened once."""
    return {n: replace(scenes.shipped_study(n), samples=16_384) for n in ("sedan", "bus")}


@pytest.fixture
def sedan(shipped):
    return shipped["sedan"]


@pytest.fixture
def bus(shipped):
    return shipped["bus"]


@pytest.mark.parametrize("name", ["sedan", "bus"])
def test_the_mesh_file_holds_the_blend_file_s_triangles_and_the_readme_lists_the_glass(
    shipped, name
):
    vehicle = shipped[name].vehicle
    mesh = pt.read_mesh(scenes.ASSETS / f"{name}.npz")
    assert mesh.triangles.tobytes() == vehicle.triangles.tobytes()
    assert np.array_equal(mesh.parts, vehicle.parts)
    assert mesh.part_names == vehicle.part_names
    listed = ", ".join(f'"{part}"' for part in vehicle.glass)
    assert f"`glass = [{listed}]`" in (scenes.ASSETS / "README.md").read_text()


def in_view(camera, yaw_deg, pitch_deg, count=15):
    """Directions through a camera's whole picture."""
    right, down = np.meshgrid(*[np.linspace(-1.0, 1.0, count)] * 2)
    width = np.tan(camera.hfov / 2.0)
    height = width * camera.height / camera.width
    rays = np.stack([np.ones_like(right), -right * width, -down * height], axis=-1).reshape(-1, 3)
    turn = rotation_matrix(0.0, np.radians(pitch_deg), np.radians(yaw_deg))
    return rays @ turn.T / np.linalg.norm(rays, axis=1, keepdims=True)


def test_body_glass_and_lamps_are_one_closed_shell(bus):
    names = bus.vehicle.part_names
    skin = [i for i, name in enumerate(names) if not name.startswith(OUTSIDE_THE_SHELL)]
    triangles = bus.vehicle.triangles[np.isin(bus.vehicle.parts, skin)]
    assert scenes.open_edges(triangles) == 0
    assert scenes.sharpest_fold(triangles) > -0.8
    assert surfaces.volume(triangles) > 20.0


@pytest.mark.parametrize(
    ("model", "position", "yaw", "pitch", "pane"),
    [
        ("Camera 30 deg", (2.90, 0.0, 1.66), 0.0, 1.4, "windshield"),
        ("Camera 60 deg", (-2.90, 0.0, 1.52), 180.0, 7.2, "rear_window"),
    ],
)
def test_a_camera_behind_the_glass_sees_out_and_a_lidar_does_not(
    bus, model, position, yaw, pitch, pane
):
    rays = in_view(pe.catalog.load(model), yaw, pitch)
    assert np.isinf(bus.vehicle.first_hit(position, rays, through_glass=True).distance).all()
    hits = bus.vehicle.first_hit(position, rays)
    assert set(bus.vehicle.parts[hits.face]) == {bus.vehicle.part_names.index(pane)}


def test_the_demo_searches_by_default_for_a_lidar_and_a_camera(addon, tmp_path):
    """And ends with what was moved, what that is worth and costs, and the page to open."""
    demo_scene.make(start := tmp_path / "start.blend")
    rig = scenes.study().rig
    assert {kind_of(sensor).name for sensor in rig} == {"camera", "lidar"}
    script = (TOOLS / "demo.sh").read_text("utf-8")
    options = shlex.split(re.search(r"OPTIONS=\((.*?)\)", script, re.DOTALL)[1])
    options.remove("optimize.samples=32768")
    options.remove("--set")
    few = ("--evaluations", "5", "--samples", "1024", "--workers", "1")
    few += ("--set", "optimize.samples=1024")
    answer = run_here(start, ["optimize", *options, *few, "--no-review", "--output", tmp_path])
    assert answer.returncode == 0, answer.stderr
    result = json.loads((tmp_path / "result.json").read_text("utf-8"))
    assert result["method"] == search.DEFAULT_METHOD
    (tmp_path / "review.html").touch()
    command = [sys.executable, TOOLS / "show_result.py", tmp_path]
    moved, better, cost, more = subprocess.check_output(command, text=True).splitlines()
    assert all(sensor.name in moved for sensor in rig)
    for values in (result["figures"][which]["values"] for which in ("before", "after")):
        assert f"{values['traffic_ap']:.3f}" in better and f"{values['blind_ground']:.0f}" in better
    assert result["cost"].endswith(cost.split(maxsplit=1)[1])
    assert more.split()[1] == str(tmp_path / "review.html")
