"""Rows of many sensors: a full score against its entropy alone, and how time grows with sensors."""

from __future__ import annotations

import numpy as np

import pe_core as pe

from .problems import car
from .timing import Timing, Work, best_of_processor, peak_mb


def full_score_of_four_lidars() -> Timing:
    """All that a grid score tells of four LiDARs, against their entropy alone."""
    return _full(4, 0)


def full_score_of_many() -> Timing:
    """The same of 16 LiDARs and 16 cameras."""
    return _full(16, 16)


def time_against_sensors() -> Timing:
    """A full score of eight sensors, against as many times the share that one of two takes."""
    ours = ring_on_roof(4, 4)
    few = ring_on_roof(1, 1)
    eight = best_of_processor(_scoring(ours), 2)
    peak = peak_mb()
    two = best_of_processor(_scoring(few), 2)
    work = "full grid score of 4 LiDARs and 4 cameras, processor time"
    return Timing(work, eight, peak, "four times that of 1 and 1", yardstick_s=4.0 * two)


def _full(lidars: int, cameras: int) -> Timing:
    study = ring_on_roof(lidars, cameras)
    evaluator = study.evaluator(0)
    ours = best_of_processor(lambda: evaluator.score(study.rig), 2)
    peak = peak_mb()
    theirs = best_of_processor(lambda: evaluator.entropy(study.rig), 2)
    work = f"full grid score, {lidars} LiDARs, {cameras} cameras, vehicle, processor time"
    return Timing(work, ours, peak, "their entropy alone", yardstick_s=theirs)


def _scoring(study: pe.Study) -> Work:
    evaluator = study.evaluator(0)
    return lambda: evaluator.score(study.rig)


def ring_on_roof(lidars: int, cameras: int) -> pe.Study:
    """LiDARs and cameras in two rings on a car's roof."""
    models = [pe.catalog.load(name) for name in ("Pandar40", "Pandar64", "Camera 60 deg")]
    sensors = []
    for k in range(lidars):
        x = np.cos(2 * np.pi * k / lidars)
        y = np.sin(2 * np.pi * k / lidars)
        pose = pe.Pose((1.2 * x - 0.3, 0.6 * y, 1.75))
        sensors.append(pe.Sensor(f"lidar {k}", models[k % 2], pose))
    for k in range(cameras):
        yaw = 2 * np.pi * k / cameras
        pose = pe.Pose((np.cos(yaw) - 0.3, 0.5 * np.sin(yaw), 1.6), (0.0, 0.0, yaw))
        sensors.append(pe.Sensor(f"camera {k}", models[2], pose))
    return pe.Study(pe.Rig(sensors), car())
