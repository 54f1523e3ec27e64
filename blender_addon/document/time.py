"""Time in a scene: frames, how tracks are confirmed, and scenarios, a row each."""

import json
import math
from collections.abc import Mapping, Sequence

from bpy.types import Object, PropertyGroup, Scene
from mathutils import Vector

from ..engine import motion, studies
from .study_table import read_row, store_row, value_at


def scenarios_of(settings: PropertyGroup) -> tuple[motion.Scenario, ...]:
    """Return the scenarios of a scene that are switched on. `InputError` when a value is wrong."""
    return tuple(scenario_of(row) for row in settings.scenarios if row.enabled)


def scenario_of(row: PropertyGroup) -> motion.Scenario:
    """Return the scenario of a row; `InputError` when a value is wrong."""
    return read_row(motion.Scenario, row, f"scenario {row.name!r}", name=row.name)


def write_scenarios(settings: PropertyGroup, scenarios: Sequence[motion.Scenario]) -> None:
    """Write scenarios to a scene, in place of its own."""
    settings.scenarios.clear()
    for scenario in scenarios:
        write_scenario(settings.scenarios.add(), scenario)


def write_scenario(row: PropertyGroup, scenario: motion.Scenario) -> None:
    """Write a scenario to a row; what its preset has, too, as it is changed there."""
    row.result = ""
    declared = studies.settings_of(motion.Scenario)
    store_row(
        row, scenario, name=scenario.name, **{name: getattr(scenario, name) for name in declared}
    )


def frame_rate(scene: Scene) -> float:
    """Return how many frames of a scene a second has [Hz]."""
    return scene.render.fps / scene.render.fps_base


def body_place(obj: Object) -> tuple[float, float, float]:
    """Return x and y of the middle of a test body [m], and its heading [deg]."""
    matrix = obj.matrix_world
    x, y, _ = matrix @ (sum(map(Vector, obj.bound_box), Vector()) / 8.0)
    return x, y, math.degrees(matrix.to_euler().z)


def scenario_signatures(settings: PropertyGroup, scene: str) -> dict[str, str]:
    """Return by name what the result of each row depends on; `scene` is the scene's fingerprint."""
    rule = value_at(settings.table, ("time",))
    return {row.name: f"{scene} {rule} {row.table}" for row in settings.scenarios}


def store_driven(
    settings: PropertyGroup, driven: Sequence[motion.DriveBy], signatures: Mapping[str, str]
) -> None:
    """Store in the rows of scenarios when their tracks are confirmed; other rows have nothing.
    `signatures` are those of the scene that was driven."""
    found = {each.scenario.name: each.summary() for each in driven}
    for row in settings.scenarios:
        data = found.get(row.name)
        row.result = (
            json.dumps(data | {"signature": signatures[row.name]})
            if data and row.name in signatures
            else ""
        )


def clear_stale_scenarios(settings: PropertyGroup, scene: str) -> bool:
    """Clear the results of scenarios that left the scene; return whether there was one."""
    now = scenario_signatures(settings, scene)
    stale = [
        row
        for row in settings.scenarios
        if row.result and json.loads(row.result)["signature"] != now[row.name]
    ]
    for row in stale:
        row.result = ""
    return bool(stale)
