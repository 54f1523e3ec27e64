"""Names of the panel stay English, whatever the language of Blender's interface.

Blender looks names up in its own catalogue: "Range" would become a German word beside names that
the catalogue lacks. In a context that no catalogue has, Blender finds no word and shows the name.
"""

from inspect import get_annotations
from typing import Any, get_type_hints

import bpy

CONTEXT = "Perception Entropy"
"""The context of our names. No catalogue has it."""
DEFERRED = type(bpy.props.BoolProperty())
"""What a declared property is until its class is registered."""
LABELLED = (bpy.types.Operator, bpy.types.Panel, bpy.types.Menu)
"""Classes with labels of their own."""


def keep_english(cls: type) -> None:
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
