"""The camera placements of the study: drawn by the plan's rule, the same ones in every session."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.sensors.camera import Camera

from ..placements import drawn_poses, sees_all_round, vehicle
from ..posed_sensors import PosedSensors, PoseValues, first_of_each, numbered, pose_texts
from .plan import CameraPlan

Floats = NDArray[np.float64]

NAME = "cameras"
YAW_DIGITS = 1


def camera_placements(plan: CameraPlan) -> list[PosedSensors]:
    """Return all placements of the plan: those that see all round first."""
    if plan.digest not in _drawn:
        _drawn[plan.digest] = numbered(first_of_each(_draws(plan), plan.count))
    return list(_drawn[plan.digest])


_drawn: dict[str, list[PosedSensors]] = {}
"""Placements that were drawn, by the digest of their plan: drawing takes seconds."""


def _draws(plan: CameraPlan) -> Iterator[PosedSensors]:
    """Yield placements, without end but for the limit of the shared rule."""
    rng = np.random.default_rng([plan.seed, plan.cameras])
    body, rule = vehicle(plan.vehicle), plan.placements

    def in_view(directions: Floats) -> NDArray[np.bool_]:
        return in_picture(plan.model, directions)[2]

    for poses in drawn_poses(body, rule, rng, plan.cameras):
        yaws = rng.uniform(0.0, 90.0) + np.arange(plan.cameras) * 360.0 / plan.cameras
        yaws += rng.uniform(-plan.yaw_deg, plan.yaw_deg, plan.cameras)
        turned = _looking_outwards(body.bounds, poses, yaws)
        seen = sees_all_round(body, rule, in_view, turned)
        yield PosedSensors(f"{NAME}-{plan.vehicle}", plan.vehicle, tuple(turned), seen)
    raise AssertionError(f"no placement of cameras on {plan.vehicle}")


def _looking_outwards(
    bounds: tuple[Floats, Floats], poses: Sequence[PoseValues], yaws: Floats
) -> list[PoseValues]:
    """Return poses with the yaws [deg] given to them so that the cameras look outwards.

    Of all orders of the yaws, that with the highest sum of the positions' components along the
    directions; positions are relative to the body's middle and in halves of its sides.
    """
    low, high = (np.asarray(b)[:2] for b in bounds)
    places = (np.array([p[:2] for p in poses]) - (low + high) / 2.0) / ((high - low) / 2.0)
    along = np.stack([np.cos(np.radians(yaws)), np.sin(np.radians(yaws))])
    gain = places @ along
    cameras = range(len(poses))
    best = max(permutations(cameras), key=lambda order: sum(gain[k, order[k]] for k in cameras))
    wrapped = [round(float((yaws[k] + 180.0) % 360.0 - 180.0), YAW_DIGITS) for k in best]
    return [(*pose[:5], yaw) for pose, yaw in zip(poses, wrapped, strict=True)]


def in_picture(model: Camera, directions: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return where directions (..., 3), sensor frame, are in the picture.

    Returns
    -------
    tuple of (...) float, (...) float, (...) bool
        Column and row from the upper left corner [px], and whether they are in the picture.
    """
    depth, left, up = np.moveaxis(directions, -1, 0)
    columns, rows = model.projection.project(depth, left, up)
    inside = (depth > 0.0) & (columns >= 0.0) & (columns < model.width)
    return columns, rows, inside & (rows >= 0.0) & (rows < model.height)


def listing(plan: CameraPlan) -> dict[str, Any]:
    """Return all placements as JSON data, for people."""
    rows = {p.name: {"all_round": p.all_round, **pose_texts(p)} for p in camera_placements(plan)}
    return {"plan": plan.digest, "placements": rows}
