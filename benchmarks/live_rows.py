"""What a score costs while one of four sensors is moved by hand, on the sedan.

The yardstick is sorting two million numbers in the same run. Both are in processor time.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import pe_core as pe

from .problems import four_on_car
from .timing import Timing, best_of_processor, peak_mb

SEDAN = Path(__file__).parents[1] / "blend_assets" / "experiments" / "1_pandar64.toml"
SAMPLES = 262_144
SORTED = 2_000_000
STEP_M = 0.003
MOVES = 9


def live_upright() -> Timing:
    """A LiDAR on the roof is moved, which stays upright."""
    return _moved("roof", tilt_deg=0.0)


def live_tilted() -> Timing:
    """The same LiDAR, three degrees nose down."""
    return _moved("roof", tilt_deg=3.0)


def live_camera() -> Timing:
    """A camera of 30 degrees is moved."""
    return _moved("ahead", tilt_deg=2.0)


def live_candidate() -> Timing:
    """All four sensors are moved at once, as by a candidate of a search."""
    return _moved("roof", tilt_deg=3.0, together=True)


def _moved(name: str, tilt_deg: float, together: bool = False) -> Timing:
    study = replace(four_on_car(), vehicle=pe.load_study(SEDAN).vehicle)
    evaluator = study.evaluator(SAMPLES)
    tilted = [_turned(s, tilt_deg) if s.name == name else s for s in study.rig]
    offsets = iter(STEP_M * np.arange(1.0, 1000.0))
    evaluator.summary(pe.Rig(tilted))

    def work() -> None:
        offset = float(next(offsets))
        rig = [_shifted(s, offset) if together or s.name == name else s for s in tilted]
        evaluator.summary(pe.Rig(rig))

    values = np.random.default_rng(0).random(SORTED)
    ours = best_of_processor(work, MOVES)
    peak = peak_mb()
    theirs = best_of_processor(lambda: np.sort(values))
    what = "all four sensors" if together else f"{name!r} of four sensors, {tilt_deg:g} deg down,"
    text = f"live score of {SAMPLES:,} samples, {what} moved, sedan, processor time"
    return Timing(text, ours, peak, "sort two million numbers", yardstick_s=theirs)


def _turned(sensor: pe.Sensor, tilt_deg: float) -> pe.Sensor:
    _, _, yaw = sensor.pose.rpy
    return sensor.moved(pe.Pose(sensor.pose.position, (0.0, float(np.radians(tilt_deg)), yaw)))


def _shifted(sensor: pe.Sensor, along: float) -> pe.Sensor:
    x, y, z = sensor.pose.position
    return sensor.moved(pe.Pose((x + along, y, z), sensor.pose.rpy))
