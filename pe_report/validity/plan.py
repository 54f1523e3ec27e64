"""Which scores ``pe validate`` computes, by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from ..plan import Task
from .choices import BASE, ScoreChoice, variants
from .effort import ValidityEffort
from .published import papers
from .tasks import (
    ALONE,
    TRAFFIC,
    object_name,
    objects,
    voxel_name,
    voxels,
    voxels_in_traffic,
)


def plan(effort: ValidityEffort, known: Mapping[str, Any]) -> list[Task]:
    """Return the tasks that are not known yet."""
    return [task for name, task in _tasks(effort).items() if name not in known]


def names(effort: ValidityEffort) -> list[str]:
    """Names of all tasks."""
    return list(_tasks(effort))


def _tasks(effort: ValidityEffort) -> dict[str, Task]:
    """Return all tasks by name: what several variants share is computed once."""
    found = (task for way in variants(effort.all_variants) for task in _of_variant(effort, way))
    return {task.name: task for task in found}


def _of_variant(effort: ValidityEffort, way: ScoreChoice) -> Iterator[Task]:
    for paper in papers():
        for placement in paper.placements:
            for reading in paper.readings(placement):
                yield from _of_placement(effort, way, (paper.id, placement, reading))


def _of_placement(
    effort: ValidityEffort, way: ScoreChoice, placed: tuple[str, str, str]
) -> Iterator[Task]:
    which = dict(zip(("paper", "placement", "reading"), placed, strict=True))
    where: dict[str, Any] = {**which, "body": way.body}
    samples = effort.samples if way == BASE else effort.variant_samples
    yield Task(voxel_name(*placed, ALONE, way), voxels, {**where, "samples": samples})
    where["density"] = way.density
    count = {"samples": effort.traffic_samples, "scenes": effort.traffic_scenes}
    yield Task(voxel_name(*placed, TRAFFIC, way), voxels_in_traffic, {**where, **count})
    where |= {"curves": way.curves, "scenes": effort.scenes}
    for traffic in (ALONE, TRAFFIC):
        how = {**where, "traffic": traffic == TRAFFIC}
        yield Task(object_name(*placed, traffic, way), objects, how)
