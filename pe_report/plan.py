"""Which tasks there are, by name, and which can run with what is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from .effort import Effort, pitch_differences
from .paper import PRIORS, ROW, ROWS
from .settings import EXPECTED, SETTINGS

FITS = ("kitti_car", "kitti_pedestrian", "kitti_cyclist", "paper_lidar")
CAMERAS_DEG = (30, 60, 120)
CAMERA_ROWS = ("2_60deg", "2_120deg")
LIDAR_ROWS = ("1_pandar64", "1_hdl64e")
QUICK_SETTINGS = ("as shipped", "voxels of 0.4 m (space 4.8 m high)")


Function = Callable[..., dict[str, Any]]


@dataclass(frozen=True)
class Task:
    """A function (of `tasks` by its name), its arguments, and the name its result goes by."""

    name: str
    function: Function | str
    arguments: dict[str, Any] = field(default_factory=dict)


def plan(effort: Effort, known: Mapping[str, Any]) -> list[Task]:
    """Return the tasks that can run now and are not known yet, the long ones first.

    Where a row has several starts, short pilots tell the best one, which is then searched.
    """
    every = [*_searches(effort, known), *scores_and_figures(effort)]
    return [task for task in every if task.name not in known]


def names(effort: Effort, known: Mapping[str, Any]) -> list[str]:
    """Names of all tasks, once the pilots are known."""
    return [task.name for task in (*_searches(effort, known), *scores_and_figures(effort))]


def scores_and_figures(effort: Effort) -> list[Task]:
    """Return the tasks that need no search."""
    return [*_scores(effort), *_pitch(effort), *_vary(effort), *_bounds(), *_plots()]


def best_start(row: str, prior: str, known: Mapping[str, Any], effort: Effort) -> str | None:
    """Return the only start, or the one whose pilot ends lowest; None until all are known."""
    starts = starts_of(row, effort)
    if len(starts) == 1:
        return starts[0]
    names = {start: pilot_name(row, prior, start) for start in starts}
    if not all(name in known for name in names.values()):
        return None
    return min(names, key=lambda start: known[names[start]]["entropy"])


def starts_of(row: str, effort: Effort) -> list[str]:
    """Return the starts a row is searched from."""
    return [start for start in ROW[row].starts if start in effort.starts]


def pilot_name(row: str, prior: str, start: str) -> str:
    """Name of a pilot's result: a shorter search that tells which start is best."""
    return f"pilot/{row}/{prior}/{start}"


def search_name(row: str, prior: str, start: str, seed: int) -> str:
    """Name of a search's result."""
    return f"search/{row}/{prior}/{start}/{seed}"


def _searches(effort: Effort, known: Mapping[str, Any]) -> Iterator[Task]:
    for row, prior in effort.rows:
        starts, best = starts_of(row, effort), best_start(row, prior, known, effort)
        for start in starts if len(starts) > 1 else ():
            arguments = _search(effort, row, prior, start, effort.seeds[0])
            arguments["candidates"] = effort.pilot_candidates
            yield Task(pilot_name(row, prior, start), "search", arguments)
        for seed in effort.seeds if best else ():
            arguments = _search(effort, row, prior, str(best), seed)
            yield Task(search_name(row, prior, str(best), seed), "search", arguments)


def _search(effort: Effort, row: str, prior: str, start: str, seed: int) -> dict[str, Any]:
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
            yield Task(f"printed/{row.name}/{prior}", "score", {"row": row.name, **common})
        for name, other in (("3_default", "3_front"), ("3_front", "3_default")):
            arguments = {"row": name, "rig_of": other, **common}
            yield Task(f"swapped/{name}/{prior}", "score", arguments)
        arguments = {"row": "4_cameras", "lidars_only": True, **common}
        yield Task(f"lidars/4_cameras/{prior}", "score", arguments)


def _pitch(effort: Effort) -> Iterator[Task]:
    for difference in pitch_differences(effort):
        arguments = {"difference_deg": difference, "samples": effort.samples}
        yield Task(f"pitch/{difference:g}", "pitch", arguments)


def _vary(effort: Effort) -> Iterator[Task]:
    for setting in (*SETTINGS, EXPECTED):
        if effort.all_settings or setting in QUICK_SETTINGS:
            for row in LIDAR_ROWS:
                arguments = {"row": row, "setting": setting, "samples": effort.samples}
                yield Task(f"vary/{setting}/{row}", "vary", arguments)


def _bounds() -> Iterator[Task]:
    for prior in PRIORS:
        for row in CAMERA_ROWS:
            yield Task(f"bound/{row}/{prior}", "bound", {"row": row, "prior": prior})
    for hfov in CAMERAS_DEG:
        yield Task(f"bound_curve/{hfov}", "bound_curve", {"hfov_deg": hfov})


def _plots() -> Iterator[Task]:
    for prior in PRIORS:
        yield Task(f"prior/{prior}", "prior_map", {"prior": prior})
    for table in FITS:
        yield Task(f"fit/{table}", "fit", {"table": table})
