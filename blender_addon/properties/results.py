"""Variants of a scene: sets of sensors with their scores."""

from __future__ import annotations

import json

from bpy.types import Context, PropertyGroup

from ..choices import free_name
from .fields import switch, text, whole

MAX_NAME_LENGTH = 60


def _keep_apart(variant: PE_Variant, _context: Context) -> None:
    """Update callback of a variant's name: names are unique and not empty."""
    rows = variant.id_data.perception_entropy.variants
    taken = {row.name for row in rows if row.key != variant.key}
    name = free_name(variant.name.strip() or "Variant", taken)
    if name != variant.name:
        variant.name = name


class PE_Variant(PropertyGroup):
    """A variant: the records of all sensors, and the result of scoring them."""

    name: text(
        "Name",
        "Name of the variant. Double-click to change it",
        maxlen=MAX_NAME_LENGTH,
        update=_keep_apart,
    )
    key: whole("Key", "Identifies the variant, also after a change of its name")
    note: text("Note", "Note about the variant")
    sensors: text("Sensors", "All sensors, as JSON")
    score_json: text("Score", "The full score: zones, classes, sensors")
    figures_json: text("Figures", "Blind ground, reach ahead and expected AP")
    figures_of: text("Figures Of", "Vehicle, prior, settings, height and class of the figures")
    signature: text("Signature", "Vehicle, prior and settings of the score")
    stale: switch("Stale", "Vehicle, prior or settings have changed since the variant was scored")

    @property
    def has_result(self) -> bool:
        """Whether the variant has a score."""
        return bool(self.score_json)

    @property
    def entropy(self) -> float:
        """Perception entropy of the score [nats]."""
        return float(json.loads(self.score_json)["entropy"])
