"""A rig in a weather: its sensors' models as their kinds give them, and m by what is known.

Where weather only shortens a kind's range, m of a sensor in a weather is its m in clear air for all
voxels within the shorter range, 0 beyond it, and counted again on the few voxels that the range
cuts: a sensor is measured once for all weathers, and the numbers are those of measuring it anew.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ..scene.rig import Rig, Sensor, SensorModel
from .kernels import Measured, Voxels
from .kind import kind_of
from .weather import Weather

_CLEAR: WeakKeyDictionary[SensorModel, SensorModel] = WeakKeyDictionary()
"""Models in clear air, by their models in a weather."""
MARGIN = 1e-6
"""Of half a voxel's diagonal, for rounding."""


def rig_in_weather(rig: Rig, weather: Weather | None) -> Rig:
    """Return a rig with its sensors as they are under a weather."""
    if weather is None or weather.is_clear:
        return rig
    return Rig([sensor_in_weather(sensor, weather) for sensor in rig])


def sensor_in_weather(sensor: Sensor, weather: Weather) -> Sensor:
    """Return a sensor as it is under a weather; the same one where nothing changes."""
    model = _model_in_weather(sensor.model, weather)
    return sensor if model is sensor.model else replace(sensor, model=model)


@lru_cache(maxsize=1024)
def _model_in_weather(model: SensorModel, weather: Weather) -> SensorModel:
    """Return one and the same object for a model and a weather: caches compare by identity."""
    changed: SensorModel = kind_of(model).in_weather(model, weather)
    if changed is not model and kind_of(model).weather_limits_range:
        _CLEAR[changed] = model
    return changed


def clear_air(sensor: Sensor) -> Sensor | None:
    """Return the sensor in clear air that `sensor` was made of, by range alone; None without."""
    model = _CLEAR.get(sensor.model)
    return None if model is None else replace(sensor, model=model)


def within_range(
    sensor: Sensor,
    clear: Measured,
    voxels: Voxels,
    measure: Callable[[Sensor, Voxels], NDArray],
) -> Measured:
    """Return the measurement of a sensor in a weather from its measurement in clear air.

    Parameters
    ----------
    sensor : Sensor
        With the shorter range, `model.max_range`.
    clear : Measured
    voxels : Voxels
    measure : callable
        Returns m of the sensor on other voxels.
    """
    limit: float = sensor.model.max_range  # type: ignore[attr-defined]  # of kinds with a range
    offset = voxels.centers - np.asarray(sensor.pose.position)
    square = offset[:, 0] ** 2 + offset[:, 1] ** 2 + offset[:, 2] ** 2
    half = voxels.space.interval * math.sqrt(3.0) / 2.0 * (1.0 + MARGIN) + MARGIN
    m = np.where(square <= (limit + half) ** 2, clear.m, clear.m.dtype.type(0))
    low = max(limit - half, 0.0)
    cut = np.flatnonzero((square >= low * low) & (m > 0))
    if len(cut):
        some = Voxels(voxels.space, voxels.index[cut], voxels.centers[cut])
        m[cut] = measure(sensor, some)[: len(cut)]
        m[cut] = np.where(square[cut] <= (limit + half) ** 2, m[cut], 0)
    return Measured(sensor, m, clear.approximate, clear.kernel_data)
