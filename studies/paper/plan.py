"""The tasks of the reproduction: how much is computed, and which tasks can run already."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ..task_runner import Task, Values
from . import tasks
from .paper import EXPECTED_COUNTS, PRIORS, ROW, ROWS, SETTINGS

FITS = ("kitti_car", "kitti_pedestrian", "kitti_cyclist", "paper_lidar")
CAMERAS_DEG = (30, 60, 120)
CAMERA_ROWS = ("2_60deg", "2_120deg")
LIDAR_ROWS = ("1_pandar64", "1_hdl64e")
QUICK_SETTINGS = ("as shipped", "voxels of 0.4 m (space 4.8 m high)")
MAX_PITCH_DEG = 2.0
"""The pitch figure goes from minus this difference to plus this difference."""


@dataclass(frozen=True)
class Effort:
    """How much is computed.

    Attributes
    ----------
    samples : int
        Voxels that a score evaluates; 0: all.
    candidates, search_samples : int
        Placements in a round of a search, and voxels that each of them is evaluated on.
    pilot_candidates : int
        Placements in a round of a pilot: the short searches of a row that has several starts.
    seeds : tuple of int
        Seeds of the searches from the best start.
    rows : tuple of (str, str)
        The rows that are searched, each with its prior.
    starts : tuple of str
        The starts that are searched, of those that a row has.
    pitch_step_deg : float
        Step of the pitch figure.
    all_settings : bool
        Whether experiment 1 is computed for all settings, or for `QUICK_SETTINGS` only.
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


ROWS_WITH_ROAD_PRIOR = tuple(
    (row, "road")
    for row in ("3_default", "3_front", "1_pandar64", "1_hdl64e", "2_60deg", "2_120deg")
)
CAMERA_ROWS_WITH_HIGHWAY_PRIOR = (("2_60deg", "highway"), ("2_120deg", "highway"))
"""The one ordering that depends on the prior is searched under two."""

FULL = Effort(
    samples=0,
    candidates=1000,
    search_samples=32_768,
    pilot_candidates=200,
    seeds=(0, 1, 2, 3, 4),
    rows=(("4_cameras", "road"), *ROWS_WITH_ROAD_PRIOR, *CAMERA_ROWS_WITH_HIGHWAY_PRIOR),
    starts=("roof", "diagonal", "front", "rear", "left"),
    pitch_step_deg=0.05,
    all_settings=True,
)
"""The paper's schedule, scored on the whole grid."""

QUICK = Effort(
    samples=32_768,
    candidates=16,
    search_samples=8_192,
    pilot_candidates=16,
    seeds=(0,),
    rows=ROWS_WITH_ROAD_PRIOR,
    starts=("roof", "diagonal", "front"),
    pitch_step_deg=0.5,
    all_settings=False,
)
"""Every ordering at a lower cost: sampled scores and short searches."""


def pitch_differences(effort: Effort) -> list[float]:
    """Return the pitch differences of the pitch figure [deg]."""
    count = round(MAX_PITCH_DEG / effort.pitch_step_deg)
    return [round(k * effort.pitch_step_deg, 4) + 0.0 for k in range(-count, count + 1)]


def effort_from_dict(data: dict[str, Any]) -> Effort:
    """Return the effort that results.json names."""
    values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in data.items()}
    values["rows"] = tuple((row, prior) for row, prior in data["rows"])
    return Effort(**values)


def plan(effort: Effort, values: Values) -> list[Task]:
    """Return the tasks that can run now and have no value yet, the long ones first.

    A row with several starts is searched from each of them by a short pilot. The long searches of
    the row start where the best pilot did, so they can run when all its pilots have values.
    """
    can_run = [*_searches(effort, values), *scores_and_figures(effort)]
    return [task for task in can_run if task.name not in values]


def scores_and_figures(effort: Effort) -> list[Task]:
    """Return the tasks that need no search."""
    return [*_scores(effort), *_pitch(effort), *_vary(effort), *_bounds(), *_plots()]


def best_start(row: str, prior: str, values: Values, effort: Effort) -> str | None:
    """Return the start whose pilot ended lowest; None until all pilots of the row have values.

    A row with one start needs no pilot.
    """
    starts = starts_of(row, effort)
    if len(starts) == 1:
        return starts[0]
    pilots = {start: pilot_name(row, prior, start) for start in starts}
    if not all(name in values for name in pilots.values()):
        return None
    return min(pilots, key=lambda start: values[pilots[start]]["entropy"])


def starts_of(row: str, effort: Effort) -> list[str]:
    """Return the starts that a row is searched from."""
    return [start for start in ROW[row].starts if start in effort.starts]


def pilot_name(row: str, prior: str, start: str) -> str:
    """Return the name of a pilot's task."""
    return f"pilot/{row}/{prior}/{start}"


def search_name(row: str, prior: str, start: str, seed: int) -> str:
    """Return the name of a search's task."""
    return f"search/{row}/{prior}/{start}/{seed}"


def best_search(values: Values, effort: Effort, row: str, prior: str) -> str:
    """Return the name of the search that ended lowest, of all seeds from the best start.

    The text is empty where no search of the row has a value.
    """
    start = best_start(row, prior, values, effort)
    names = [search_name(row, prior, str(start), seed) for seed in effort.seeds]
    done = [name for name in names if name in values]
    return min(done, key=lambda name: values[name]["entropy"], default="")


def _searches(effort: Effort, values: Values) -> Iterator[Task]:
    for row, prior in effort.rows:
        starts, best = starts_of(row, effort), best_start(row, prior, values, effort)
        for start in starts if len(starts) > 1 else ():
            arguments = _search_arguments(effort, row, prior, start, effort.seeds[0])
            arguments["candidates"] = effort.pilot_candidates
            yield Task(pilot_name(row, prior, start), tasks.search, arguments)
        for seed in effort.seeds if best else ():
            arguments = _search_arguments(effort, row, prior, str(best), seed)
            yield Task(search_name(row, prior, str(best), seed), tasks.search, arguments)


def _search_arguments(
    effort: Effort, row: str, prior: str, start: str, seed: int
) -> dict[str, Any]:
    return {
        "row": row,
        "prior": prior,
        "start": start,
        "seed": seed,
        "candidates": effort.candidates,
        "search_samples": effort.search_samples,
        "samples": effort.samples,
    }


def _scores(effort: Effort) -> Iterator[Task]:
    for prior in PRIORS:
        common = {"prior": prior, "samples": effort.samples}
        for row in ROWS:
            yield Task(f"printed/{row.name}/{prior}", tasks.score, {"row": row.name, **common})
        for name, other in (("3_default", "3_front"), ("3_front", "3_default")):
            arguments = {"row": name, "rig_of": other, **common}
            yield Task(f"swapped/{name}/{prior}", tasks.score, arguments)
        arguments = {"row": "4_cameras", "lidars_only": True, **common}
        yield Task(f"lidars/4_cameras/{prior}", tasks.score, arguments)


def _pitch(effort: Effort) -> Iterator[Task]:
    for difference in pitch_differences(effort):
        arguments = {"difference_deg": difference, "samples": effort.samples}
        yield Task(f"pitch/{difference:g}", tasks.pitch, arguments)


def _vary(effort: Effort) -> Iterator[Task]:
    for setting in (*SETTINGS, EXPECTED_COUNTS):
        if effort.all_settings or setting in QUICK_SETTINGS:
            for row in LIDAR_ROWS:
                arguments = {"row": row, "setting": setting, "samples": effort.samples}
                yield Task(f"vary/{setting}/{row}", tasks.vary, arguments)


def _bounds() -> Iterator[Task]:
    for prior in PRIORS:
        for row in CAMERA_ROWS:
            yield Task(f"bound/{row}/{prior}", tasks.bound, {"row": row, "prior": prior})
    for hfov in CAMERAS_DEG:
        yield Task(f"bound_curve/{hfov}", tasks.bound_curve, {"hfov_deg": hfov})


def _plots() -> Iterator[Task]:
    for prior in PRIORS:
        yield Task(f"prior/{prior}", tasks.prior_map, {"prior": prior})
    for table in FITS:
        yield Task(f"fit/{table}", tasks.fit, {"table": table})
