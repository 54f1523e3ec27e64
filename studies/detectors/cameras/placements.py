"""The camera placements of the study: drawn by the plan's rule, the same ones in every session."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from pe_core.sensors.camera import Camera

from ..placements import (
    Placement,
    PoseValues,
    drawn_poses,
    first_of_each,
    numbered,
    sees_all_round,
    vehicle,
)
from ..plan import CAMERAS
from .plan import CameraPlan

Floats = NDArray[np.float64]

YAW_DIGITS = 1

_drawn: dict[str, list[Placement]] = {}
"""Placements that were drawn, by the digest of their plan: drawing takes seconds."""


def camera_placements(plan: CameraPlan) -> list[Placement]:
    """Return all placements of the plan: those that see all round first."""
    if plan.study.digest not in _drawn:
        _drawn[plan.study.digest] = numbered(first_of_each(_draws(plan), plan.count))
    return list(_drawn[plan.study.digest])


def _draws(plan: CameraPlan) -> Iterator[Placement]:
    """Yield placements, without end but for the limit of the shared rule."""
    rng = np.random.default_rng([plan.seed, plan.cameras])
    body, rule = vehicle(plan.vehicle), plan.placements

    def in_view(directions: Floats) -> NDArray[np.bool_]:
        return in_picture(plan.model, directions)[2]

    for poses in drawn_poses(body, rule, rng, plan.cameras):
        yaws = rng.uniform(0.0, 90.0) + np.arange(plan.cameras) * 360.0 / plan.cameras
        yaws += rng.uniform(-plan.yaw_deg, plan.yaw_deg, plan.cameras)
        turned = tuple(_looking_outwards(body.bounds, poses, yaws))
        seen = sees_all_round(body, rule, in_view, turned)
        yield Placement(f"{CAMERAS}-{plan.vehicle}", plan.vehicle, turned, seen, CAMERAS, "")
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
    """Return where directions (..., 3), sensor frame, are: column, row [px], and whether inside.

    Columns and rows are counted from the upper left corner.
    """
    depth, left, up = np.moveaxis(directions, -1, 0)
    columns, rows = model.projection.project(depth, left, up)
    inside = (depth > 0.0) & (columns >= 0.0) & (columns < model.width)
    return columns, rows, inside & (rows >= 0.0) & (rows < model.height)
