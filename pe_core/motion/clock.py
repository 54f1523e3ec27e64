"""When sensors have frames, on the frames of a scenario, and which sensors a track's frames are of.

A sensor of a lower rate than the scenario's has a new frame at some of the scenario's frames, and
what it saw is as old as its last one until then. A faster one has one at each.

A track is confirmed by M of N frames of a `Stream`: all sensors of at least a rate, at the frames
of this rate, so that each of its frames has a new one of each of them. There is a stream for each
rate. A track counts as confirmed with the highest probability of any stream: never too high, and a
further sensor lowers it nowhere.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats, Ints
from ..scene.rig import Rig, Sensor

SAME_FRAME = 1e-6
"""A frame that is later by less than this share of a scenario's frame is at that frame."""


@dataclass(frozen=True, slots=True, eq=False)
class FrameClock:
    """The frames of a sensor or a stream on the K frames of a scenario.

    `frames` (F,): The scenario's frames at which there is a new one.
    `last` (K,): Which one is the last at each of the scenario's frames.
    `frame_s`: The time between two of them [s].
    """

    frames: Ints
    last: Ints
    frame_s: float

    @classmethod
    def of(cls, count: int, scenario_hz: float, rate_hz: float) -> "FrameClock":
        """Return the clock of a rate on `count` frames, at most that of the scenario."""
        rate = min(rate_hz, scenario_hz)
        step = scenario_hz / rate
        ticks = np.arange(int((count - 1) / step + SAME_FRAME) + 1)
        frames = np.ceil(ticks * step - SAME_FRAME).astype(np.int64)
        frames = frames[frames < count]
        last = np.searchsorted(frames, np.arange(count), side="right") - 1
        return cls(frames, last, 1.0 / rate)

    def held(self, values: Floats) -> Floats:
        """Return values (..., F) of the frames as (..., K): of the last frame."""
        return values[..., self.last]


def frame_rate(sensor: Sensor, rates: Mapping[str, float], scenario_hz: float) -> float:
    """Return a sensor's frames in a second [Hz], at most the scenario's; `rates` are by kind."""
    return min(rates.get(sensor.kind, scenario_hz), scenario_hz)


def streams(rig: Rig, hz: Mapping[str, float]) -> dict[float, list[str]]:
    """Return the sensors of each stream by its rate [Hz]: those of at least this rate. `hz` are the
    rates of the sensors by name."""
    rates = sorted({hz[sensor.name] for sensor in rig}, reverse=True)
    return {rate: [s.name for s in rig if hz[s.name] >= rate] for rate in rates}
