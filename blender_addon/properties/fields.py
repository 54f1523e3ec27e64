"""Properties that no setting of the engine declares, each with its label and its tooltip."""

from typing import Any

from bpy.props import (
    BoolProperty,
    BoolVectorProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)


def switch(label: str, about: str, default: bool = False, **more: Any) -> Any:
    """Return a property that is on or off."""
    return BoolProperty(name=label, description=about, default=default, **more)


def switches(label: str, about: str, size: int, **more: Any) -> Any:
    """Return a property of several switches."""
    return BoolVectorProperty(name=label, description=about, size=size, **more)


def whole(label: str, about: str, default: int = 0, **more: Any) -> Any:
    """Return a property of a whole number."""
    return IntProperty(name=label, description=about, default=default, **more)


def number(label: str, about: str, default: float = 0.0, **more: Any) -> Any:
    """Return a property of a number."""
    return FloatProperty(name=label, description=about, default=default, **more)


def numbers(label: str, about: str, size: int, **more: Any) -> Any:
    """Return a property of several numbers."""
    return FloatVectorProperty(name=label, description=about, size=size, **more)


def text(label: str, about: str, default: str = "", **more: Any) -> Any:
    """Return a property of a text."""
    return StringProperty(name=label, description=about, default=default, **more)


def menu(label: str, about: str, items: Any, **more: Any) -> Any:
    """Return a property of one of several texts, or of some of them."""
    return EnumProperty(name=label, description=about, items=items, **more)


def rows(label: str, about: str, of: type, **more: Any) -> Any:
    """Return a property of a list of groups."""
    return CollectionProperty(name=label, description=about, type=of, **more)


def pointer(label: str, about: str, to: Any, **more: Any) -> Any:
    """Return a property of one group, or of one of Blender's data-blocks."""
    return PointerProperty(name=label, description=about, type=to, **more)
