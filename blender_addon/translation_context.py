"""The context in which Blender looks our texts up.

A text of Blender's own contexts is looked up in Blender's catalogue first: where that has the same
word, its translation wins, be it of another meaning: "Range" of numbers, or "Key" of an animation.
No catalogue but ours has this context.
"""

from collections.abc import Iterator
from inspect import get_annotations
from typing import Any, get_type_hints

import bpy

CONTEXT = "Perception Entropy"
DEFERRED = type(bpy.props.BoolProperty())
"""What a declared property is until its class is registered."""
LABELLED = (bpy.types.Operator, bpy.types.Panel, bpy.types.Menu)
"""Classes with labels of their own."""


def in_own_context(cls: type) -> None:
    """Put the label of a class and the names of its properties into our context."""
    if issubclass(cls, LABELLED):
        cls.bl_translation_context = CONTEXT
    cls.__annotations__ = get_annotations(cls) | {
        name: declared.function(**declared.keywords | {"translation_context": CONTEXT})
        for name, declared in own_properties(cls).items()
    }


def own_properties(cls: type) -> dict[str, Any]:
    """Return the properties that a class and our mixins of it declare; not those of Blender's."""
    ours = [each for each in cls.__mro__ if not each.__module__.startswith("bpy")]
    names = {name for each in ours for name in get_annotations(each)}
    declared = get_type_hints(cls)  # the annotations themselves are strings
    return {
        name: each
        for name, each in declared.items()
        if name in names and isinstance(each, DEFERRED)
    }


def names_of(cls: type) -> Iterator[str]:
    """Yield the texts of a class that Blender looks up: its label, names and items of menus."""
    if issubclass(cls, LABELLED):
        yield getattr(cls, "bl_label", "")
    for declared in own_properties(cls).values():
        yield declared.keywords.get("name", "")
        yield from (item[1] for item in _items(declared))


def _items(declared: Any) -> tuple[tuple[Any, ...], ...]:
    """Return the items of a menu that are known beforehand."""
    items = declared.keywords.get("items", ())
    return () if callable(items) else tuple(items)
