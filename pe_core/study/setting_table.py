"""All settings of a study, listed by table of its file: for the panel and the docs."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from ..base.setting import REQUIRED, OneOf, Setting, Several, key_of, settings_of
from ..geometry.grids import PerceptionSpace
from ..metric.entropy import ApCurve
from ..prior.prior import Focus
from ..scene.vehicle import Vehicle
from ..scene.vehicle_description import Reference
from ..scene.vehicle_state import Motion, State
from ..scoring.requirements import Criterion, Under, Zone
from ..scoring.targets import TargetRule
from ..search import (
    Constraints,
    Front,
    Goals,
    NoGo,
    Option,
    Schedule,
    Selection,
    Stop,
    SurfaceMount,
    Tolerance,
)
from ..search.tolerance import CASES, ERRORS
from ..sensors import PerceptionModel
from ..sensors.weather import Weather
from .conditions import BODY, OF_STATE
from .study import Search, Study


@dataclass(frozen=True, slots=True)
class StudyTable:
    """A table of the study file, and the dataclass whose settings stand in it.

    `names` are those of the settings, where the table has not all of the dataclass's. Of `rows`
    there are several in a study: each is a row, or an object, of a Blender scene, not the scene.
    `part` is the part of Blender's panel with these settings; that of the table if it is empty.
    """

    table: str
    cls: type
    names: tuple[str, ...] = ()
    rows: bool = False
    part: str = ""

    @property
    def settings(self) -> list[Setting]:
        """The settings of the table, in their order."""
        settings = settings_of(self.cls)
        return [settings[name] for name in self.names or settings]


SECTIONS = (
    StudyTable("", Study, part="score"),
    StudyTable("space", PerceptionSpace),
    StudyTable("vehicle", Vehicle),
    StudyTable("metric", TargetRule),
    StudyTable("ap", PerceptionModel),
    StudyTable("reference", Reference),
    StudyTable("optimize", Search, part="search"),
    StudyTable("optimize", Schedule, part="schedule"),
    StudyTable("optimize", Constraints, part="constraints"),
    StudyTable("optimize", Tolerance, CASES, part="cases"),
    StudyTable("optimize", Goals, part="goals"),
    StudyTable("optimize.tolerance", Tolerance, ERRORS),
    StudyTable("optimize.stop", Stop),
    StudyTable("optimize.front", Front),
    StudyTable("selection", Selection),
    StudyTable("optimize.mount", SurfaceMount, rows=True),
    StudyTable("optimize.no_go", NoGo, rows=True),
    StudyTable("choice.option", Option, rows=True),
    StudyTable("prior.focus", Focus, rows=True),
    StudyTable("ap.KIND", ApCurve, rows=True),
    StudyTable("requirement.zone", Zone, rows=True),
    StudyTable("requirement.criterion", Criterion, rows=True),
    StudyTable("requirement.under", Under, rows=True),
    StudyTable("weather", Weather, rows=True),
    StudyTable("state", State, OF_STATE, rows=True),
    StudyTable("state.body", State, BODY, rows=True),
    StudyTable("state.move", Motion, rows=True),
)


class Key(NamedTuple):
    """A key of the study file, and its setting."""

    name: str
    setting: Setting


def setting_keys(*, of_scene: bool = False) -> Iterator[Key]:
    """Yield settings by their key in the file: ``optimize.seed``; all, or those of a scene."""
    for section in SECTIONS:
        for setting in () if of_scene and section.rows else section.settings:
            yield Key(".".join(filter(None, (section.table, key_of(setting.name)))), setting)


@functools.cache
def settings_of_part(part: str) -> tuple[Setting, ...]:
    """Return the settings of a part of Blender's panel, in their order."""
    sections = [each for each in SECTIONS if part == (each.part or each.table)]
    own = (setting for each in sections for setting in each.settings)
    return tuple(setting for setting in own if setting.panel is not None)


def panel_default(setting: Setting) -> Any:
    """Return the value that a setting has in a new scene, as the panel shows it."""
    assert setting.panel is not None
    default = setting.default if setting.panel.default is None else setting.panel.default
    if default is REQUIRED:
        return None
    return default if default is not None else 0


def is_switch(setting: Setting) -> bool:
    """Whether an optional text is shown as a switch: it has one value, or is absent."""
    return setting.is_optional and isinstance(setting.rule, OneOf) and len(setting.rule.among) == 1


def menu_of(setting: Setting) -> tuple[tuple[str, str, str], ...]:
    """Return text, label and meaning of each entry of a setting's menu."""
    panel, rule = setting.panel, setting.rule
    assert panel is not None and isinstance(rule, OneOf | Several)
    rows = zip(rule.among, panel.menu, strict=True)
    absent = () if panel.absent is None else (panel.absent,)
    return (*absent, *((text, label, about) for text, (label, about) in rows))
