"""How much is computed: all of it, or enough to check every ordering in a minute."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class Effort:
    """How much is computed.

    Attributes
    ----------
    samples : int
        Voxels a score looks at; 0: all.
    candidates, search_samples : int
        Placements a round, and voxels each is judged on.
    pilot_candidates : int
        Placements a round where a row has several starts and the best has to be found first.
    seeds : tuple of int
        Of the searches from the best start.
    rows : tuple of (str, str)
        Rows that are searched, and under which prior.
    starts : tuple of str
        Starts that are searched, where a row has them.
    pitch_step_deg : float
        Step of the pitch figure.
    all_settings : bool
        Whether the sensitivity of experiment 1 is computed in full.
    """

    samples: int
    candidates: int
    search_samples: int
    pilot_candidates: int
    seeds: tuple[int, ...]
    rows: tuple[tuple[str, str], ...]
    starts: tuple[str, ...]
    pitch_step_deg: float
    all_settings: bool


ON_THE_ROAD = tuple(
    (row, "road")
    for row in ("3_default", "3_front", "1_pandar64", "1_hdl64e", "2_60deg", "2_120deg")
)
CAMERAS_ON_THE_HIGHWAY = (("2_60deg", "highway"), ("2_120deg", "highway"))
"""The one ordering that depends on the prior is searched under two."""

FULL = Effort(
    samples=0,
    candidates=1000,
    search_samples=32_768,
    pilot_candidates=200,
    seeds=(0, 1, 2, 3, 4),
    rows=(("4_cameras", "road"), *ON_THE_ROAD, *CAMERAS_ON_THE_HIGHWAY),
    starts=("roof", "diagonal", "front", "rear", "left"),
    pitch_step_deg=0.05,
    all_settings=True,
)
"""The paper's schedule, on whole grids."""

QUICK = Effort(
    samples=32_768,
    candidates=16,
    search_samples=8_192,
    pilot_candidates=16,
    seeds=(0,),
    rows=ON_THE_ROAD,
    starts=("roof", "diagonal", "front"),
    pitch_step_deg=0.5,
    all_settings=False,
)
"""Every ordering at lower cost: sampled scores, short searches."""

PITCH_REACH_DEG = 2.0


def pitch_differences(effort: Effort) -> list[float]:
    """Return the pitch differences of the figure [deg]."""
    count = round(PITCH_REACH_DEG / effort.pitch_step_deg)
    return [round(k * effort.pitch_step_deg, 4) + 0.0 for k in range(-count, count + 1)]


def to_dict(effort: Effort) -> dict[str, Any]:
    """Return an effort as results.json has it."""
    data = asdict(effort)
    data["rows"] = [list(pair) for pair in effort.rows]
    return {key: list(v) if isinstance(v, tuple) else v for key, v in data.items()}


def from_dict(data: dict[str, Any]) -> Effort:
    """Return the effort that results.json names."""
    values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in data.items()}
    values["rows"] = tuple((row, prior) for row, prior in data["rows"])
    return Effort(**values)
