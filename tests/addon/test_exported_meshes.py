"""The example vehicles for the engine are those in the .blend files."""

import numpy as np
import pytest

import pe_core as pe
from tests.addon import scenes


@pytest.mark.parametrize("name", ["sedan", "bus"])
def test_the_mesh_file_holds_the_blend_file_s_triangles(addon, name):
    vehicle = scenes.shipped_study(name).vehicle
    mesh = pe.read_mesh(scenes.ASSETS / f"{name}.npz")
    assert mesh.triangles.tobytes() == vehicle.triangles.tobytes()
    assert np.array_equal(mesh.parts, vehicle.parts)
    assert mesh.part_names == vehicle.part_names


@pytest.mark.parametrize("name", ["sedan", "bus"])
def test_the_readme_lists_the_glass(addon, name):
    glass = scenes.shipped_study(name).vehicle.glass
    listed = ", ".join(f'"{part}"' for part in glass)
    assert f"`glass = [{listed}]`" in (scenes.ASSETS / "README.md").read_text()
