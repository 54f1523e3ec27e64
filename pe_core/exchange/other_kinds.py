"""Sensors of kinds that are not known here: radars, ultrasonics, receivers of satellites."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace

from ..kinds import KINDS
from .carried import CarriedSensor
from .passthrough import pose_entry

NO_WORD = re.compile("[^a-z0-9]+")
NAMED_KINDS = ("radar", "ultrasonic", "sonar", "gnss", "gps", "imu", "ins", "collision")
"""Words in names that tell a kind, where a file says none."""
NOUNS = {"radar", "ultrasonic"}
"""Kinds that are nouns; of others one says sensor."""


def parted(
    sensors: Iterable[CarriedSensor], chosen: Mapping[str, str]
) -> tuple[list[CarriedSensor], list[CarriedSensor]]:
    """Return the sensors of known kinds, and the others.

    Where a file says no kind, its name does; unless a model was `chosen` for it.
    """
    known, other = [], []
    for each in sensors:
        kind = each.kind or ("" if each.name in chosen else _kind_in_name(each))
        if not kind or kind in KINDS:
            known.append(each)
        else:
            entry = each.entry or pose_entry(each)
            other.append(replace(each, kind=kind, entry=entry, is_left_out=True))
    return known, other


def _kind_in_name(each: CarriedSensor) -> str:
    if each.model is not None or each.picture is not None or each.scan is not None:
        return ""
    words = NO_WORD.sub(" ", each.name.lower()).split()
    return next((kind for kind in NAMED_KINDS if kind in words), "")


def listed_kinds(sensors: Iterable[tuple[str, str]]) -> str:
    """Return how many of each kind there are, and their names, from pairs (kind, name)."""
    names: dict[str, list[str]] = {}
    for kind, name in sensors:
        names.setdefault(kind, []).append(name)
    return ", ".join(
        f"{len(own)} {_noun(kind, len(own))} ({', '.join(own)})" for kind, own in names.items()
    )


def _noun(kind: str, count: int) -> str:
    noun = kind if kind in NOUNS else f"{kind} sensor"
    return noun if count == 1 else f"{noun}s"
