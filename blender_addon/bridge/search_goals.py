"""Goals of a search that depend on a scene's sensors and variants: what stays, further starts."""

from collections.abc import Sequence
from dataclasses import replace

from bpy.types import Scene

from ..engine import pe, search
from .sensor_records import SensorRecord, records_of


def with_starts(settings: pe.Search, scene: Scene) -> pe.Search:
    """Return the settings of a search with the scene's other variants as starts, if they are on."""
    own = scene.perception_entropy
    if not own.start_variants:
        return settings
    starts = [
        search.Start(row.name, {record.name: record.pose for record in records_of(row)})
        for row in own.variants
        if row.key != own.variant_key
    ]
    goals = replace(settings.goals, starts=(*settings.goals.starts, *starts))
    return replace(settings, goals=goals)


def goals_of_sensors(
    goals: search.Goals, records: Sequence[SensorRecord], mounting: pe.Mounting
) -> search.Goals:
    """Return goals for these sensors: which of them stay, and starts without the others."""
    names = {record.name for record in records}
    followers = {pair[1] for pair in mounting.pairs}
    followers |= {name for group in mounting.groups for name in group[1:]}
    fixed = [r.name for r in records if r.stays and r.name not in followers]
    starts = [
        search.Start(start.name, {n: pose for n, pose in start.poses.items() if n in names})
        for start in goals.starts
    ]
    return replace(goals, fixed=fixed, starts=starts)
