"""What is asked of a search besides its method: when to stop, what stays, from where, for what.

By default nothing: a search then ends when its method or its budget does, moves all sensors, starts
from the given placement alone, and minimises one value.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any

from ..base.arrays import ReadOnlyDict
from ..base.errors import InputError, require_kind, require_name, shown
from ..base.setting import NAMES, Named, Panel, Part, Several, check_settings, setting
from ..base.values import A_NAME, Number, Whole, listed
from ..geometry.poses import Pose
from ..scene.rig import Rig
from .figures import FIGURES, ON_FRONT
from .mounts import Mounting

GAIN_OVER = 200
"""Placements over which the gain of a search is taken: fewer often gain nothing by chance, more
save little of a search of thousands."""


@dataclass(frozen=True, slots=True)
class Stop:
    """When a search ends before its budget does; each field that is set may end it. A limit that is
    kept on what the search improves ends it as well. The time is that of the search, without the
    scores before and after it; `evaluations` of the result repeats a search that it ended."""

    seconds: float | None = setting(
        None,
        Number(0.0, above=True, cap=1e9, unit="s"),
        "Time limit of the search; the result then depends on the machine",
        Panel(
            "stop_seconds",
            "Seconds",
            soft_max=3600.0,
            zero="no limit",
            beside="Off",
            precision=0,
            step=1000,
        ),
    )
    gain: float | None = setting(
        None,
        Number(0.0, above=True, cap=1e6),
        f"The search ends when the last {GAIN_OVER} placements gained less than this",
        Panel(
            "stop_gain",
            "Gain Below",
            soft_max=0.1,
            zero="none",
            beside="Off",
            precision=4,
            step=0.1,
        ),
    )

    def __post_init__(self) -> None:
        check_settings(self, "optimize", "stop.")


@dataclass(frozen=True, slots=True)
class Front:
    """Objectives, names of `FIGURES`, and the number of points of their Pareto front."""

    objectives: Sequence[str] = setting(
        (),
        Several(ON_FRONT),
        "Two or more: the search looks for their Pareto front",
        Panel(
            "front_objectives",
            "Objectives",
            menu=tuple((FIGURES[name].label, FIGURES[name].about) for name in ON_FRONT),
        ),
    )
    points: int = setting(
        6,
        Whole(2, 64),
        "Searches that share the budget of a front, one for each point",
        Panel("front_points", "Points", soft_max=12),
    )

    def __post_init__(self) -> None:
        check_settings(self, "optimize", "front.")
        if len(self.objectives) == 1:
            expected = f"two or more of {', '.join(ON_FRONT)}"
            raise InputError("optimize", "front.objectives", expected, shown(self.objectives[0]))


@dataclass(frozen=True, slots=True)
class Start:
    """Another placement that a search starts from: poses of all sensors that it moves, by name."""

    name: Named
    poses: Mapping[str, Pose]

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "name", A_NAME.checked("optimize", "start.name", self.name))
        if not isinstance(self.poses, Mapping):
            raise InputError("optimize", "start.poses", "poses by sensor", shown(self.poses))
        for pose in self.poses.values():
            require_kind("optimize", "start.poses", pose, Pose)
        put(self, "poses", ReadOnlyDict(self.poses))

    def placed(self, rig: Rig) -> Rig:
        """Return a rig at the poses of this start; sensors without a pose stay. `InputError` when
        the rig lacks one of the sensors."""
        names = [sensor.name for sensor in rig]
        for name in self.poses:
            require_name("optimize", f"start {self.name!r}", name, names)
        return rig.with_poses([self.poses.get(s.name, s.pose) for s in rig])


@dataclass(frozen=True, slots=True)
class Goals:
    """What is asked of a search besides its method, as its fields say. It also starts from
    `starts`; all starts share its budget. What is fixed stays, whatever axes and mounts it has."""

    stop: Stop = field(default_factory=Stop)
    fixed: Sequence[str] = setting(
        (), NAMES, "Sensors that stay where they are, with those that follow them"
    )
    starts: Annotated[Sequence[Start], Part(key="start")] = ()
    front: Front = field(default_factory=Front)

    def __post_init__(self) -> None:
        for key, kind in (("stop", Stop), ("front", Front)):
            require_kind("optimize", key, getattr(self, key), kind)
        starts: Any = listed(self.starts)
        if starts is None or not all(isinstance(each, Start) for each in starts):
            raise InputError("optimize", "start", "a list of starts", shown(self.starts))
        object.__setattr__(self, "starts", tuple(starts))
        check_settings(self, "optimize")

    def of_rig(self, rig: Rig, mounting: Mounting) -> "Goals":
        """Return itself; raise `InputError` where a sensor that is fixed or placed is none."""
        followers = {pair[1] for pair in mounting.pairs}
        followers |= {name for group in mounting.groups for name in group[1:]}
        leaders = [sensor.name for sensor in rig if sensor.name not in followers]
        for name in self.fixed:
            if name not in leaders:
                expected = f"sensors that follow no other: {', '.join(leaders)}"
                raise InputError("optimize", "fixed", expected, shown(name))
        for start in self.starts:
            start.placed(rig)
        return self
