"""What tests ask of kernels: m of any sensor on a grid, a sample or objects, and by definition."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

import pe_core as pe
from pe_core.sensors import ObjectView, Voxels, kind_of
from pe_core.sensors.lidar.grid_sweep import MAX_COUNT

ALL = 1 << 16
"""Beams from which on a kernel need not count: more than any LiDAR of the tests has."""
FLAT = 0.004
"""How far the closed form of a pinhole's area may be off, relative."""


def every_voxel(space):
    """All voxels of a space, z fastest."""
    index = np.stack(np.unravel_index(np.arange(space.size), space.shape), axis=1)
    return Voxels(space, index, space.center_of(index))


def on_grid(sensor, space, vehicle=None, run=64):
    """m (nx, ny, nz) as the grid's kernel has it, asked for so many planes at a time."""
    kernel = kind_of(sensor).on_grid(space, vehicle, ALL)
    m = np.zeros(space.shape)
    with ThreadPoolExecutor(1) as pool:
        (planes,) = kernel.planes([[kernel.prepare(sensor)]], pool)
        for start in range(0, space.shape[0], run):
            some = slice(start, min(start + run, space.shape[0]))
            found = planes(some)
            if isinstance(found, np.ndarray):
                m[some] = found
            else:
                m[some, found.rows] = found.m
    return m


def on_sample(sensor, space, index, vehicle=None):
    """m (V,) as the kernel of samples has it; what hides nothing hides nothing there, too."""
    voxels = Voxels(space, index, space.center_of(index))
    kernel = kind_of(sensor).on_sample(voxels, vehicle, ALL)
    m = np.asarray(kernel.measure(sensor).m, dtype=float)
    return m


def on_objects(sensor, objects, vehicle=None, traffic=False):
    """m (N,) by the kernel, after it has seen the sensor elsewhere."""
    kernel = kind_of(sensor).on_objects(ObjectView(objects, vehicle, traffic))
    kernel.measure(sensor.moved(pe.Pose((0.0, 0.0, 2.0))))
    return kernel.measure(sensor)


def assert_alike(found, expected, model):
    """Counts are the same; of areas the same are above 0, and they are as good as closed forms."""
    if model.kind != "camera":
        np.testing.assert_allclose(found, expected, rtol=0.0 if model.kind == "lidar" else 1e-12)
    elif model.projection.is_straight:
        assert ((found > 0.0) == (expected > 0.0)).all()
        np.testing.assert_allclose(found, expected, rtol=FLAT)
    else:  # voxels with less than a pixel are told to one
        np.testing.assert_allclose(found, expected, rtol=0.01, atol=0.5)
        np.testing.assert_allclose(found.sum(), expected.sum(), rtol=0.002)


def assert_defined(sensor, space, index, vehicle=None, grid=None):
    """Hold grid and sample to the definition in some voxels (V, 3), and return m (V,)."""
    grid = on_grid(sensor, space, vehicle) if grid is None else grid
    expected = pe.measure(sensor, space.center_of(index), space.interval, vehicle)
    held = np.minimum(expected, MAX_COUNT) if sensor.kind == "lidar" else expected
    assert_alike(grid[tuple(index.T)], held, sensor.model)
    assert_alike(on_sample(sensor, space, index, vehicle), expected, sensor.model)
    return expected


def assert_objects_defined(sensor, objects, vehicle=None, traffic=False):
    """Hold the kernel of objects to the definition, to the bit, and return m (N,)."""
    found = on_objects(sensor, objects, vehicle, traffic)
    assert found.tolist() == pe.measure_objects(sensor, objects, vehicle, traffic).tolist()
    return found
