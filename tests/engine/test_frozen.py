"""What was given and checked cannot be changed afterwards, by whoever holds it."""

import dataclasses
import functools
import importlib
import inspect
import pickle
import pkgutil

import numpy as np
import pytest

import pe_core
import pe_core as pe
import pe_tools
from tests.engine import shapes

BUILT_UP = {
    "pe_tools.formats.boxes.labels.Labels",
    "pe_tools.cli.interrupts.Received",
    "pe_tools.exchange.usd_stage.UsdStage",
    "pe_tools.exchange.usd_text.Prim",
    "pe_tools.page.pictures.svg.Canvas",
}
"""Filled while a file is read, signals come or a picture is drawn; so are some that are private."""


def refuses_writing(array):
    with pytest.raises(ValueError, match="read-only"):
        array[...] = 0


def test_a_lidar_keeps_its_own_angles():
    elevations = np.array([0.1, -0.1])
    offsets = np.array([0.0, 0.2])
    lidar = pe.Lidar("mine", elevations, azimuth_count=4, max_range=100.0, azimuth_offsets=offsets)
    before = lidar.directions.copy()
    elevations[:] = offsets[:] = 1.0
    assert lidar.elevations.tolist() == [0.1, -0.1]
    assert lidar.azimuth_offsets.tolist() == [0.0, 0.2]
    assert (lidar.directions == before).all()
    arrays = lidar.elevations, lidar.azimuth_offsets, lidar.directions, lidar.azimuth_steps
    for array in arrays:
        refuses_writing(array)


def test_a_vehicle_keeps_its_own_triangles():
    triangles = shapes.box((-1, -1, 0), (1, 1, 1))
    parts = np.zeros(12, np.int32)
    vehicle = pe.Vehicle(triangles, parts, ("a", "b"))
    triangles[:] = 7.0
    parts[:] = 1
    assert vehicle.triangles.max() == 1.0 and not vehicle.parts.any()
    assert vehicle.bounds[1].tolist() == [1.0, 1.0, 1.0]
    refuses_writing(vehicle.triangles)
    refuses_writing(vehicle.parts)
    refuses_writing(pe.Vehicle(shapes.box((-1, -1, 0), (1, 1, 1))).parts)


def test_boxes_keep_their_own_columns():
    x = np.array([1.0, 2.0])
    one = np.ones(2)
    boxes = pe.Boxes(
        names=np.array(["car", "car"]),
        x=x,
        y=one,
        z=one,
        length=one,
        width=one,
        height=one,
        yaw=one,
    )
    x[:] = 9.0
    assert boxes.x.tolist() == [1.0, 2.0]
    refuses_writing(boxes.x)
    refuses_writing(boxes.names)


def test_the_catalogue_is_everybody_s():
    table = pe.catalog.entries()["Pandar64"].table
    with pytest.raises(TypeError):
        table["max_range_m"] = 1.0
    with pytest.raises(TypeError):
        table["elevations_deg"][0] = 1.0
    with pytest.raises(TypeError):
        pe.catalog.entries()["mine"] = None
    refuses_writing(pe.catalog.load("Pandar64").elevations)


def test_a_preset_of_ones_own_is_copied():
    table = {"kind": "camera", "width": 640, "height": 480, "hfov_deg": 60.0}
    pe.catalog.add("frozen test", table)
    try:
        table["width"] = 1
        assert pe.catalog.entries()["frozen test"].table["width"] == 640
    finally:
        pe.catalog.remove("frozen test")


def test_a_search_is_copied_and_fixed_and_can_be_sent_to_another_process():
    free = {"roof": ["x"]}
    limits = {"roof": {"x": [0.0, 1.0]}}
    search = pe.Search(free=free, limits=limits)
    space = pe.SearchSpace(limits)
    free["roof"].append("y")
    limits["roof"]["x"][1] = 5.0
    assert search.free == {"roof": ("x",)}
    assert search.limits == space.bounds == {"roof": {"x": (0.0, 1.0)}}
    for mapping in (search.free, search.limits["roof"], space.bounds["roof"]):
        for change in (
            lambda m: m.update(y=1),
            lambda m: m.pop("x", None),
            lambda m: m.setdefault("y", 1),
            lambda m: m.clear(),
            lambda m: m.__setitem__("x", 1),
            lambda m: m.__delitem__("x"),
        ):
            with pytest.raises(TypeError, match="read-only"):
                change(mapping)
    again = pickle.loads(pickle.dumps(search))
    assert again == search and type(again.limits["roof"]) is type(search.limits["roof"])


@functools.cache
def classes():
    """Public dataclasses by module and name."""
    modules = [
        importlib.import_module(found.name)
        for package in (pe_core, pe_tools)
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
        if not found.name.endswith("__main__")
    ]
    return {
        f"{module.__name__}.{name}": cls
        for module in modules
        for name, cls in inspect.getmembers(module, inspect.isclass)
        if dataclasses.is_dataclass(cls) and cls.__module__ == module.__name__ and name[0] != "_"
    }


def test_dataclasses_are_frozen():
    thawed = {name for name, cls in classes().items() if not cls.__dataclass_params__.frozen}
    assert thawed == BUILT_UP
