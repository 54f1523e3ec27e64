"""Goals of a search in the study file: the keys stop, fixed, start, front and sensitivity."""

from __future__ import annotations

from typing import Any

from ..base.errors import InputError
from ..base.setting_file import read_settings, settings_table
from ..base.table_reader import Table
from ..base.values import A_NAME
from ..geometry.poses import Pose
from ..search.goals import Front, Goals, Start, Stop

AXES_OF_A_POSE = 6
"""x, y, z [m], roll, pitch, yaw [deg]."""


def read_goals(table: Table) -> Goals:
    """Return the goals in the table `[optimize]`; an `InputError` names the key in the file."""
    stop, front = table.table("stop"), table.table("front")
    stops, points = read_settings(stop, Stop), read_settings(front, Front)
    stop.finish()
    front.finish()
    starts = [_read_start(each) for each in table.tables("start")]
    with table.naming():
        goals = read_settings(table, Goals)
        return Goals(Stop(**stops), starts=starts, front=Front(**points), **goals)


def _read_start(table: Table) -> Start:
    name, placements = table.text("name", rule=A_NAME), table.table("placements")
    poses = {}
    for sensor in placements.names:
        values = placements.numbers(sensor, AXES_OF_A_POSE)
        try:
            poses[sensor] = Pose.from_degrees(values[:3], values[3:])
        except InputError as error:
            raise placements.error(sensor, error.expected, error.found) from None
    placements.finish()
    table.finish()
    return Start(name, poses)


def goals_tables(goals: Goals) -> dict[str, Any]:
    """Return the keys that `read_goals` reads; None for those at their default."""
    default = Goals()
    own = settings_table(goals)
    return {
        "stop": None if goals.stop == default.stop else settings_table(goals.stop),
        "fixed": own.pop("fixed") or None,
        "start": [{"name": each.name, "placements": each.numbers} for each in goals.starts] or None,
        "front": None if goals.front == default.front else settings_table(goals.front),
        **own,
    }
