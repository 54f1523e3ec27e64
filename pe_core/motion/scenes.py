"""The scenes of a drive-by: each body that has to be seen, and what may hide it.

What has to be seen has the small box that surely counts, what hides the extent of the body
(`Body.hiding`): so a verdict errs to the safe side. Each watched body has a scene of its own for
each frame, with the bodies that stand before it as any sensor sees them from above.
"""

from dataclasses import dataclass

import numpy as np

from ..base.arrays import Flags, Floats, Ints
from ..base.errors import InputError
from ..scene.objects import Objects
from ..scene.rig import Rig
from .scenario import Scenario

OTHER = "other"  # Class of bodies that only occlude
MAX_BOXES = 200_000
"""Boxes in the scenes of a scenario: they take a camera about a minute, a LiDAR some seconds."""
MARGIN_RAD = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class ScenarioScenes:
    """Boxes of a scenario, in scenes; `rows` (W, K): those of the watched bodies at each frame."""

    objects: Objects
    rows: Ints

    @property
    def watched(self) -> Objects:
        """The boxes (W * K) of the watched bodies, body by body."""
        return self.objects.some(self.rows.ravel())


def scenario_scenes(
    scenario: Scenario, where: Floats, headings: Floats, rig: Rig
) -> ScenarioScenes:
    """Return the scenes of a scenario as a rig may see them.

    `where, headings`: `Scenario.positions`. `InputError` when there are more than `MAX_BOXES`
    boxes.
    """
    groups = _members(scenario)
    rows = np.zeros(where.shape[:2], np.int64)
    parts: list[Ints] = []
    total = 0
    for number, members in enumerate(groups):
        part = _scenes_of(members, number, scenario, where, rig=rig)
        parts.append(part)
        watched = np.arange(len(members) * len(scenario.times)).reshape(len(members), -1)
        rows[members] = total + watched
        total += len(part)
        if total > MAX_BOXES:
            expected = f"bodies and frames of at most {MAX_BOXES} boxes: each may hide others"
            found = f"more: {len(scenario.actors)} bodies, {len(scenario.times)} frames"
            raise InputError(f"scenario {scenario.name!r}", "body", expected, found)
    rows = rows[sorted(k for members in groups for k in members)]
    seen = np.zeros(total, bool)
    seen[rows] = True
    return ScenarioScenes(
        _objects(scenario, where, headings, np.concatenate(parts), seen=seen), rows
    )


def _scenes_of(
    members: list[int], number: int, scenario: Scenario, where: Floats, rig: Rig
) -> Ints:
    """Return body, frame and scene (N, 3) of the boxes of some watched bodies, body by body, and
    then of what may hide them."""
    frames = np.arange(len(scenario.times))
    before = np.logical_or.reduce([_may_hide(k, scenario, where, rig) for k in members])
    before[members] = False
    others, at = np.nonzero(before)
    body = np.concatenate([np.repeat(members, len(frames)), others])
    frame = np.concatenate([np.tile(frames, len(members)), at])
    return np.column_stack([body, frame, number * len(frames) + frame])


def _members(scenario: Scenario) -> list[list[int]]:
    """Return the watched bodies that share their scenes: those that hide as they are seen."""
    watched = [k for k, actor in enumerate(scenario.actors) if actor.watched]
    bodies = [actor.body for actor in scenario.actors]
    alike = [k for k in watched if bodies[k].hiding == bodies[k].box]
    alone = [[k] for k in watched if k not in alike]
    return [alike, *alone] if alike else alone


def _may_hide(k: int, scenario: Scenario, where: Floats, rig: Rig) -> Flags:
    """Return which bodies (A, K) overlap body k from above, as a sensor sees them, and are not
    behind it."""
    flags = np.zeros(where.shape[:2], bool)
    sides = np.array([actor.body.hiding[:2] for actor in scenario.actors])
    radii = np.hypot(sides[:, :1], sides[:, 1:]) / 2.0  # (A, 1), of circles round the bodies
    for sensor in rig:
        away = where - np.array(sensor.pose.position[:2])
        distance = np.hypot(away[..., 0], away[..., 1])
        bearing = np.arctan2(away[..., 1], away[..., 0])
        half = np.arcsin(np.minimum(radii / np.maximum(distance, radii), 1.0))
        half = np.where(distance <= radii, np.pi, half)
        apart = np.abs((bearing - bearing[k] + np.pi) % (2.0 * np.pi) - np.pi)
        nearer = distance - radii < distance[k] + radii[k]
        flags |= nearer & (apart <= half + half[k] + MARGIN_RAD)
    return flags


def _objects(
    scenario: Scenario, where: Floats, headings: Floats, boxes: Ints, seen: Flags
) -> Objects:
    """Return boxes (body, frame, scene) as objects; `seen` (N,): whether one has to be seen."""
    actor = boxes[:, 0]
    frame = boxes[:, 1]
    scenes = boxes[:, 2]
    bodies = [each.body for each in scenario.actors]
    small = np.array([body.box for body in bodies])
    large = np.array([body.hiding for body in bodies])
    sizes = np.where(seen[:, None], small[actor], large[actor])
    low = np.array([body.low for body in bodies])[actor]
    classes = [body.class_name or OTHER for body in bodies]
    names = sorted(set(classes))
    labels = np.array([names.index(name) for name in classes])[actor]
    centers = np.column_stack([where[actor, frame], low + sizes[:, 2] / 2.0])
    return Objects(centers, sizes, headings[actor, frame], labels, class_names=names, scenes=scenes)
