"""Ma, Liu and Li (ICRA 2021): the rows of Table II, their studies, and variations of these."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import pe_core as pe
from pe_core.prior import ROAD_CLASSES

STUDIES = Path(__file__).resolve().parents[2] / "blend_assets" / "experiments"
"""The study files of a checkout, one for each row."""

PRIORS = ("road", "uniform", "highway")
"""The priors that replace the paper's own, which is private; the first is the default."""

Position = tuple[float, float, float]
"""A sensor's position x, y, z [m], in the ground frame."""
ROOF_M = 1.45
"""Height of the sedan's roof."""
HALF_LENGTH_M = 3.03
HALF_WIDTH_M = 1.01
MIDDLE_M = 1.3
"""Positions of the bus's corners, and half its height."""
CAMERAS = {
    "camera_front": (HALF_LENGTH_M, 0.0, MIDDLE_M),
    "camera_rear": (-HALF_LENGTH_M, 0.0, MIDDLE_M),
}
PITCH_HEIGHT_M = 1.05
"""Height of the two LiDARs of the pitch figure: the printed one of experiment 3's front pair."""
Variation = Callable[[pe.Study], pe.Study]
KITTI = {
    "car": (29.5, 13.93, 5.73, 0.73),
    "pedestrian": (8.1, 6.55, 13.26, 0.817),
    "cyclist": (12.2, 11.77, 9.5, 0.009),
    "truck": (59.5, 2.07, 14.22, 0.318),
}
"""decay_x, laplace_y, gauss_y [m], laplace_share: the form of the road prior, fitted by maximum
likelihood to the labels of KITTI tracking (21 sequences, ahead of the car only), without cones."""
KITTI_POSITIONS = "positions as in KITTI"
EXPECTED_COUNTS = "expected beam counts, no vehicle"
"""A setting that is no variation of the study: it is computed by `analytic.expected_entropy`."""


@dataclass(frozen=True)
class Row:
    """A row of Table II: its study file, its name for people, and the entropy as printed [nats].

    `starts` has neutral placements that a search starts from, by name: each sensor's position [m];
    the pitch is 0.
    """

    name: str
    label: str
    entropy: float
    starts: dict[str, dict[str, Position]]

    @property
    def experiment(self) -> int:
        """Number of the experiment."""
        return int(self.name[0])


def _lidars_at_corners(first: tuple[int, int], second: tuple[int, int]) -> dict[str, Position]:
    """Positions of the bus's two LiDARs at corners, which are given by the signs of x and y."""
    return {
        name: (sx * HALF_LENGTH_M, sy * HALF_WIDTH_M, MIDDLE_M)
        for name, (sx, sy) in (("lidar_a", first), ("lidar_b", second))
    }


CORNERS = {
    "diagonal": _lidars_at_corners((1, -1), (-1, 1)),
    "front": _lidars_at_corners((1, 1), (1, -1)),
    "rear": _lidars_at_corners((-1, 1), (-1, -1)),
    "left": _lidars_at_corners((1, 1), (-1, 1)),
}
"""All pairs of different corners, mirror images left out."""

ROWS = (
    Row("1_pandar64", "Pandar64", 1.6429, {"roof": {"roof": (0.0, 0.0, ROOF_M)}}),
    Row("1_hdl64e", "HDL-64E", 2.1212, {"roof": {"roof": (0.0, 0.0, ROOF_M)}}),
    Row("2_60deg", "60 deg camera", 2.0055, {"roof": {"camera": (0.0, 0.0, ROOF_M)}}),
    Row("2_120deg", "120 deg camera", 2.0237, {"roof": {"camera": (0.0, 0.0, ROOF_M)}}),
    Row("3_default", "two Pandar40, default weights", 1.7119, CORNERS),
    Row("3_front", "two Pandar40, front doubled", 1.6864, CORNERS),
    Row("4_cameras", "two Pandar40, two cameras", 0.8965, {"front": CORNERS["front"] | CAMERAS}),
)
ROW = {row.name: row for row in ROWS}


@cache
def study_of(name: str, folder: Path = STUDIES) -> pe.Study:
    """Return a row's study, with its sensors at the placement that the paper prints."""
    return pe.load_study(folder / f"{name}.toml")


def with_prior(study: pe.Study, name: str) -> pe.Study:
    """Return the study with another built-in prior and the same focus."""
    constructors = {"road": pe.Prior.road, "uniform": pe.Prior.uniform, "highway": pe.Prior.highway}
    return replace(study, prior=constructors[name](study.prior.focus))


def with_positions(study: pe.Study, positions: Mapping[str, Position]) -> pe.Study:
    """Return the study with its sensors at other positions [m]: same yaw, no roll, no pitch."""
    poses = [pe.Pose(positions[s.name], (0.0, 0.0, s.pose.rpy[2])) for s in study.rig]
    return study.with_rig(study.rig.with_poses(poses))


def without_cameras(study: pe.Study) -> pe.Study:
    """Return the study with its LiDARs only."""
    return study.with_rig(pe.Rig([s for s in study.rig if s.kind == "lidar"]))


def with_pitch_difference(study: pe.Study, height: float, difference_deg: float) -> pe.Study:
    """Return a study of two LiDARs at one height [m]: the first level, the second pitched [deg]."""
    pitches = (0.0, math.radians(difference_deg))
    poses = [
        pe.Pose((*s.pose.position[:2], height), (0.0, pitch, 0.0))
        for s, pitch in zip(study.rig, pitches, strict=True)
    ]
    return study.with_rig(study.rig.with_poses(poses))


# Variations: experiment 1 with one setting changed at a time.


def _vary_classes(vary: Callable[[pe.ObjectClass], pe.ObjectClass]) -> Variation:
    def varied(study: pe.Study) -> pe.Study:
        classes = tuple(vary(c) for c in ROAD_CLASSES)
        return replace(study, prior=pe.Prior("road", classes, study.prior.focus))

    return varied


def _scale_x(factor: float) -> Variation:
    return _vary_classes(lambda c: replace(c, decay_x=factor * c.decay_x))


def _scale_y(factor: float) -> Variation:
    return _vary_classes(
        lambda c: replace(c, laplace_y=factor * c.laplace_y, gauss_y=factor * c.gauss_y)
    )


def _with_kitti_positions(cls: pe.ObjectClass) -> pe.ObjectClass:
    if cls.name not in KITTI:
        return cls
    decay_x, laplace_y, gauss_y, share = KITTI[cls.name]
    return replace(cls, decay_x=decay_x, laplace_y=laplace_y, gauss_y=gauss_y, laplace_share=share)


def _voxel_side(side: float) -> Variation:
    """Voxels of another side [m]; the space ends at the largest whole number of them below 5 m."""

    def varied(study: pe.Study) -> pe.Study:
        top = math.floor(study.space.z[1] / side + 1e-6) * side
        return replace(study, space=pe.PerceptionSpace(z=(0.0, top), interval=side))

    return varied


SETTINGS: dict[str, Variation] = {
    "as shipped": lambda study: study,
    "objects half as far ahead and behind": _scale_x(0.5),
    "twice as far ahead and behind": _scale_x(2.0),
    "half as far to the sides": _scale_y(0.5),
    "twice as far to the sides": _scale_y(2.0),
    KITTI_POSITIONS: _vary_classes(_with_kitti_positions),
    "voxels of 0.2 m": _voxel_side(0.2),
    "voxels of 0.4 m (space 4.8 m high)": _voxel_side(0.4),
    "no vehicle": lambda study: replace(study, vehicle=None),
}
"""The variation of the study, by the name of the setting."""
