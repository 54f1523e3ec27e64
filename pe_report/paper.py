"""What Ma, Liu and Li (ICRA 2021) print: the rows of Table II and what they conclude from them."""

from __future__ import annotations

from dataclasses import dataclass

PRIORS = ("road", "uniform", "highway")
"""The priors that stand in for the paper's own, which is private; the first is the default."""

Place = tuple[float, float, float]


@dataclass(frozen=True)
class Row:
    """A row of Table II.

    Attributes
    ----------
    name : str
        Of the row, and of its study file.
    label : str
    entropy : float
        As printed.
    starts : dict of dict
        Neutral placements a search begins with, by name: each sensor's position [m]; pitch is 0.
    """

    name: str
    label: str
    entropy: float
    starts: dict[str, dict[str, Place]]

    @property
    def experiment(self) -> int:
        """Number of the experiment."""
        return int(self.name[0])


ROOF_M = 1.45
"""Height of the sedan's roof."""
HALF_LENGTH_M, HALF_WIDTH_M, MIDDLE_M = 3.03, 1.01, 1.3
"""Where the bus has its corners, and half its height."""


def _corners(first: tuple[int, int], second: tuple[int, int]) -> dict[str, Place]:
    """Both LiDARs of the bus at corners: signs of x and y."""
    return {
        name: (sx * HALF_LENGTH_M, sy * HALF_WIDTH_M, MIDDLE_M)
        for name, (sx, sy) in (("lidar_a", first), ("lidar_b", second))
    }


CORNERS = {
    "diagonal": _corners((1, -1), (-1, 1)),
    "front": _corners((1, 1), (1, -1)),
    "rear": _corners((-1, 1), (-1, -1)),
    "left": _corners((1, 1), (-1, 1)),
}
"""Two different corners, but for mirror images."""
CAMERAS = {
    "camera_front": (HALF_LENGTH_M, 0.0, MIDDLE_M),
    "camera_rear": (-HALF_LENGTH_M, 0.0, MIDDLE_M),
}

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

HOUR_S = 3600.0
"""What one optimization costs the paper: "around an hour" on an Intel Core i7-8700, in C++."""

PITCH_HEIGHT_M = 1.05
"""Height of the two LiDARs of the pitch figure: the printed one of experiment 3's front pair."""
