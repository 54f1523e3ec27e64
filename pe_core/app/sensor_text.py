"""A sensor of the catalogue as text, with a small plot where its kind has one."""

from __future__ import annotations

from ..catalog import Entry, load
from ..kinds import kind_of


def describe(entry: Entry) -> str:
    """Return the figures of a catalogue entry, their source, and a plot if there is one."""
    model = load(entry.name)
    kind = kind_of(model)
    plot = kind.plot(model)
    lines = [entry.name, *kind.words(model), f"source          {entry.source}"]
    return "\n".join([*lines, *(["", *plot] if plot else [])])
