"""Compile and run the literal C++ yardstick on a problem of ours."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import pe_core as pe

SOURCE = Path(__file__).with_name("literal.cpp")
THREADS = 2
NO_SPEED = 1e-30
"""Stands for a direction component of exactly 0, which the loop divides by."""


def compiled(folder: Path) -> Path | None:
    """Return the yardstick's binary, or None where there is no compiler."""
    compiler = shutil.which("g++") or shutil.which("clang++")
    if compiler is None:
        return None
    binary = folder / "literal"
    flags = ["-O3", "-march=native", "-std=c++17", "-pthread"]
    subprocess.run([compiler, *flags, str(SOURCE), "-o", str(binary)], check=True)
    return binary


def run(study: pe.Study) -> tuple[float, float] | None:
    """Entropy and seconds of the literal loop on a study with one LiDAR; None without compiler.

    The beams' ends (self-occlusion) are given to it: casting them is not in its time.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        binary = compiled(folder)
        if binary is None:
            return None
        _problem(study).tofile(folder / "problem")
        done = subprocess.run(
            [binary, folder / "problem"], check=True, capture_output=True, text=True
        )
    entropy, seconds = done.stdout.split()
    return float(entropy), float(seconds)


def _problem(study: pe.Study) -> np.ndarray:
    (sensor,) = study.rig
    lidar = sensor.model
    space = study.space
    curve = study.model.lidar
    order = np.argsort(lidar.elevations)
    field = pe.beam_field(sensor, study.vehicle)
    by_channel = (len(order), lidar.azimuth_count)
    moving = np.where(field.directions == 0.0, NO_SPEED, field.directions)
    directions = moving.reshape(*by_channel, 3)[order]
    densities = study.prior.densities(space)
    blank = np.full(space.shape[:2], -np.inf)
    top = blank if study.vehicle is None else study.vehicle.top(space)
    head = [*space.shape, *by_channel, len(densities), space.interval, curve.a, curve.b, THREADS]
    return np.concatenate(
        [
            head,
            space.origin,
            sensor.pose.position,
            sensor.pose.ground_from_sensor.ravel(),
            lidar.elevations[order],
            directions.ravel(),
            field.ends.reshape(by_channel)[order].ravel(),
            np.stack([d.ground for d in densities], axis=-1).ravel(),
            np.stack([d.profile for d in densities], axis=-1).ravel(),
            top.ravel(),
        ]
    )
