"""Texts of the panel and the 3D view: typeset, and in plain words in *Simple*.

The panel is English. Labels are drawn with ``translate=False``: Blender would translate those words
that its own catalogue has, also the name of a sensor.
"""

import re
from functools import lru_cache

import bpy

from .choices import SIMPLE

PLAIN = (
    (r" (?:nats\b|\[nats\])", ""),
    (r"\b(?:Perception entropy|Entropy)\b", "Score"),
    (r"\b(?:perception entropy|entropy)\b", "score"),
    (r"\bof the prior\b", "of where objects are expected"),
)
"""Words of the metric, and those that *Simple* has in sentences instead."""


@lru_cache(maxsize=1024)
def typeset(text: str) -> str:
    """Return a text as it is drawn: square metres with a raised 2, errors with their sign."""
    return text.replace(" m2", " m²").replace("[m2]", "[m²]").replace("+- ", "± ")


@lru_cache(maxsize=1024)
def plain(text: str) -> str:
    """Return a sentence in plain words."""
    for term, word in PLAIN:
        text = re.sub(term, word, text)
    return text


def is_simple(scene: bpy.types.Scene) -> bool:
    """Whether the tab has the panels of the first hour alone, and plain words."""
    return scene.perception_entropy.panels == SIMPLE


def worded(scene: bpy.types.Scene, text: str) -> str:
    """Return a text as it is drawn, in plain words in *Simple*."""
    return plain(typeset(text)) if is_simple(scene) else typeset(text)


def draw_label(layout: bpy.types.UILayout, text: str, icon: str = "NONE") -> None:
    """Draw a label as it is written."""
    layout.label(text=typeset(text), icon=icon, translate=False)
