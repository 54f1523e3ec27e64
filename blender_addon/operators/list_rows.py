"""What operators on rows of the panel's lists share: the selected row, removing and moving it."""

from __future__ import annotations

from typing import ClassVar

import bpy

from .. import signals
from ..language import shown
from .reports import OperatorMixin, OperatorResult, report


class SelectedRow(OperatorMixin):
    """An operator on the selected row of a list of the scene's settings.

    `ROWS` and `INDEX` are the properties of the rows and of the selected row's index; `NOUN` is
    what a row is.
    """

    ROWS: ClassVar[str]
    INDEX: ClassVar[str]
    NOUN: ClassVar[str]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        settings = context.scene.perception_entropy
        if getattr(settings, cls.INDEX) >= len(getattr(settings, cls.ROWS)):
            cls.poll_message_set(shown(f"No {cls.NOUN} is selected"))
            return False
        return True


class RemoveRow(SelectedRow):
    """An operator that removes the selected row."""

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        name = remove_row(settings, self.ROWS, self.INDEX, getattr(settings, self.INDEX))
        self.after(context.scene, name)
        signals.study_changed.emit()
        report(self, "INFO", f"Removed {name}")
        return {"FINISHED"}

    def after(self, scene: bpy.types.Scene, name: str) -> None:
        """Mend what refers to the row of that name."""


def remove_row(settings: bpy.types.PropertyGroup, rows: str, index: str, number: int) -> str:
    """Remove a row, select one that is left, and return the name of the removed one."""
    found = getattr(settings, rows)
    name = str(found[number].name)
    found.remove(number)
    setattr(settings, index, max(0, min(number, len(found) - 1)))
    return name
