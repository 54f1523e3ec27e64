"""All settings of a study, listed by table of its file: for the panel and the docs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from ..base.setting import Setting, settings_of
from ..base.setting_file import key_of
from ..geometry.grids import PerceptionSpace
from ..scene.vehicle import Vehicle
from ..scene.vehicle_description import Reference
from ..scoring.requirements import Criterion, Under, Zone
from ..scoring.targets import TargetRule
from ..search import Constraints, Front, Goals, Schedule, Selection, Stop, Tolerance
from ..search.tolerance import CASES, ERRORS
from ..sensors import PerceptionModel
from .study import Search, Study


@dataclass(frozen=True, slots=True)
class StudyTable:
    """A table of the study file, and the dataclass whose settings stand in it.

    `names` are those of the settings, where the table has not all of the dataclass's.
    """

    table: str
    cls: type
    names: tuple[str, ...] = ()

    @property
    def settings(self) -> list[Setting]:
        """The settings of the table, in their order."""
        settings = settings_of(self.cls)
        return [settings[name] for name in self.names or settings]


SECTIONS = (
    StudyTable("", Study),
    StudyTable("space", PerceptionSpace),
    StudyTable("vehicle", Vehicle),
    StudyTable("metric", TargetRule),
    StudyTable("ap", PerceptionModel),
    StudyTable("reference", Reference),
    StudyTable("optimize", Search),
    StudyTable("optimize", Schedule),
    StudyTable("optimize", Constraints),
    StudyTable("optimize", Tolerance, CASES),
    StudyTable("optimize", Goals),
    StudyTable("optimize.tolerance", Tolerance, ERRORS),
    StudyTable("optimize.stop", Stop),
    StudyTable("optimize.front", Front),
    StudyTable("selection", Selection),
    StudyTable("requirement.zone", Zone),
    StudyTable("requirement.criterion", Criterion),
    StudyTable("requirement.under", Under),
)


class Key(NamedTuple):
    """A key of the study file, and its setting."""

    name: str
    setting: Setting


def setting_keys() -> Iterator[Key]:
    """Yield all settings by their key in the file: ``optimize.seed``."""
    for section in SECTIONS:
        for setting in section.settings:
            yield Key(".".join(filter(None, (section.table, key_of(setting.name)))), setting)


def panel_default(setting: Setting) -> Any:
    """Return the value that a setting has in a new scene, as the panel shows it."""
    assert setting.panel is not None
    default = setting.default if setting.panel.default is None else setting.panel.default
    return default if default is not None else 0
