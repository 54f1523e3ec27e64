"""The definition: what one sensor sees of a test body, and whether what the sensors see is enough.

Plain functions on one body at a time; the kernels of `checker` are held to them by tests.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats
from ...scene.objects import Objects
from ...scene.rig import Rig, Sensor
from ...scene.vehicle import Vehicle
from ...sensors import kind_of
from ...sensors.boxes import CELLS, ROUND, BodyParts
from .bodies import DIAGONALS, Body, cell_plan, post_bands
from .criteria import Criterion


def sees(
    sensor: Sensor,
    body: Body,
    foot: Sequence[float],
    heading: float,
    vehicle: Vehicle | None,
    criterion: Criterion,
) -> bool:
    """Whether a sensor sees a body that stands alone at a place: the definition.

    The sensor is of a kind that counts. m of the body's box, by the definition of its kind, reaches
    the threshold; with a share, so much of the body is visible: `visible_share` of the cells that
    have an m above 0. What is beside an unseen cell does not count: it may be seen in part.
    """
    kind = kind_of(sensor)
    if not criterion.counts(kind.name):
        return False
    (sensor,) = cautious(Rig([sensor]))
    objects = placed(body, [foot], [heading], False)
    m = kind.measure_objects(sensor, objects, vehicle, False)
    if not has_enough(sensor, objects, m, criterion).any():
        return False
    if criterion.share is None:
        return True
    cells = kind.measure_parts(sensor, parts_of(body, [foot], [heading]), vehicle) > 0.0
    return bool(visible_share(body, cells[None])[0] >= criterion.share)


def cautious(rig: Rig) -> Rig:
    """Return a rig as requirements take it: see `Kind.cautious`; the same rig where all stay."""
    models = [kind_of(sensor).cautious(sensor.model) for sensor in rig]
    if all(model is s.model for s, model in zip(rig, models, strict=True)):
        return rig
    return Rig([replace(s, model=model) for s, model in zip(rig, models, strict=True)])


def has_enough(
    sensor: Sensor, objects: Objects, m: Floats, criterion: Criterion
) -> NDArray[np.bool_]:
    """Whether m (N,) of bodies' boxes, points or pixels, is enough."""
    kind = kind_of(sensor)
    counts = kind.counts_points
    enough = m >= (criterion.points * kind.point if counts else criterion.pixels)
    return np.asarray(enough)


def visible_share(body: Body, cells: NDArray[np.bool_]) -> Floats:
    """Return the share (N,) of a body that is visible, erring low, from its cells (N, K).

    The cells of a body are bands of columns, and posts beside them (`cell_plan`); a post between
    two that are measured is seen if both are. A column in a band counts if it and its four diagonal
    neighbours are seen, in the bands above and below as well. Columns count alike. A ring is
    visible as a whole, with all its cells and posts, or not at all.
    """
    if body.is_ring:
        return cells.all(axis=1).astype(float)
    plan = cell_plan(body.bands, *body.columns)
    measured = np.zeros((len(cells), *plan.shape), bool)
    measured[:, plan] = cells
    levels = np.array(post_bands(body.bands))
    every = np.arange(body.bands)
    below = levels[np.searchsorted(levels, every, "right") - 1]
    above = levels[np.searchsorted(levels, every)]
    seen = measured[:, below] & measured[:, above]
    seen[:, :, 1:-1, 1:-1] = measured[:, :, 1:-1, 1:-1]
    whole = seen[:, :, 1:-1, 1:-1].copy()
    for rows, columns in DIAGONALS:
        whole &= seen[:, :, rows, columns]
    sure = whole.copy()
    sure[:, 1:] &= whole[:, :-1]
    sure[:, :-1] &= whole[:, 1:]
    return sure.mean(axis=(1, 2, 3))


def body_met(seen: Mapping[str, bool], rig: Rig, criterion: Criterion) -> bool:
    """Whether sensors that see a body, by name, are enough: the definition."""
    eligible = [s for s in rig if seen.get(s.name) and criterion.counts(s.kind)]
    kinds = {sensor.kind for sensor in eligible}
    return len(eligible) >= criterion.sensors and len(kinds) >= criterion.kinds


def placed(
    body: Body, feet: Sequence[Sequence[float]] | Floats, headings: Sequence[float], cells: bool
) -> Objects:
    """Return a body's boxes at all feet (N, 3) and headings, as objects that each stand alone. Foot
    after foot, heading after heading, cell after cell."""
    return _objects(body, *body.boxes(cells), feet, headings)


def parts_of(
    body: Body, feet: Sequence[Sequence[float]] | Floats, headings: Sequence[float]
) -> BodyParts:
    """Return a body's cells and shells at all feet (N, 3) and headings, as `placed` does."""
    cells = placed(body, feet, headings, True)
    bands, posts = body.cell_bands()
    centers, sizes, shell_bands = body.shells()
    count = len(cells) // len(bands)
    bodies = np.arange(count)[:, None] * (1 + int(posts.sum()))  # a post is a body of its own
    scenes = bodies + np.where(posts, np.cumsum(posts), 0)
    cells = replace(cells, scenes=scenes.reshape(-1))
    shells = None
    if len(shell_bands):
        shells = _objects(body, centers, sizes, feet, headings=headings)
        shells = replace(shells, scenes=np.repeat(bodies[:, 0], len(shell_bands)))
    return BodyParts(
        cells,
        shells,
        np.concatenate([np.tile(own, count) for own in (bands, shell_bands)]),
        np.repeat([CELLS, ROUND], [len(cells), count * len(shell_bands)]),
    )


def _objects(
    body: Body,
    centers: Floats,
    sizes: Floats,
    feet: Sequence[Sequence[float]] | Floats,
    headings: Sequence[float],
) -> Objects:
    """Return boxes (K, 3), from the foot, at all feet and headings."""
    at = np.asarray(feet, dtype=float).reshape(-1, 1, 1, 3)
    turns = [(math.cos(h), math.sin(h)) for h in headings]
    x, y, z = centers.T
    rotated = np.stack([np.stack([c * x - s * y, s * x + c * y, z], axis=1) for c, s in turns])
    everywhere = (at + rotated[None]).reshape(-1, 3)
    count = len(at)
    per = len(centers)
    return Objects(
        np.round(everywhere, 9),
        np.tile(sizes, (count * len(headings), 1)),
        np.tile(np.repeat(np.asarray(headings, dtype=float), per), count),
        np.zeros(len(everywhere), np.int64),
        class_names=(body.class_name or body.name,),
    )
