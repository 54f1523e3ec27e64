"""What there is to add: the catalogue's sensors by kind and maker, each in a few words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import bpy

from .. import bridge
from ..engine import catalog, graphics, kinds
from .mounting import mount_of

SENSOR_COLORS = graphics.SENSOR_COLORS
"""Colours of sensors in the 3D view, in the order of the list, again from the first."""


@dataclass(frozen=True, slots=True)
class Offer:
    """A kind of sensor to choose from: its name, what people call it, its usual model."""

    kind: str
    label: str
    usual: str


def offers() -> Iterator[Offer]:
    """Yield the engine's kinds that have a model in the catalogue."""
    for kind in kinds.KINDS.values():
        models = catalog.names(kind.name)
        if models:
            yield Offer(kind.name, kind.label, mount_of(kind.name).usual or models[0])


def makers(kind: str | None) -> list[str]:
    """Who makes sensors of a kind, or of any; in the order of the catalogue."""
    return list(dict.fromkeys(each.maker for each in catalog.entries().values() if _is(each, kind)))


def models(kind: str | None, maker: str | None = None) -> list[str]:
    """Names of a kind's sensors, of one maker or of all."""
    entries = (each for each in catalog.entries().values() if _is(each, kind))
    return [each.name for each in entries if maker in (None, each.maker)]


def brief(model: str) -> str:
    """Return a sensor of the catalogue in a few words: channels, field of view, range."""
    found = catalog.load(model)
    return kinds.kind_of(found).brief(found)


def described(model: str) -> str:
    """Return a sensor of the catalogue in a few lines, for a tooltip; nothing where it has none."""
    entry = catalog.entries().get(model)
    if entry is None:
        return ""
    found = catalog.load(model)
    lines = [" ".join(line.split()) for line in kinds.kind_of(found).words(found)]
    return "\n".join([model, *lines])


def _is(entry: catalog.Entry, kind: str | None) -> bool:
    return entry.kind in kinds.KINDS and kind in (None, entry.kind)


def held_by(obj: bpy.types.Object) -> str:
    """Name what holds a sensor where it is, so that its pose is not typed; empty: it is free."""
    return bridge.holder_of(obj)
