"""Properties that no setting of the engine declares, each with its label and its tooltip."""

from collections.abc import Callable, Sequence
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
from bpy.types import PropertyGroup


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


def view(
    read: Callable[[PropertyGroup], Any],
    write: Callable[[PropertyGroup, Any], None],
    items: Sequence[tuple[Any, ...]] = (),
    *,
    several: bool = False,
    low: float | None = None,
    high: float | None = None,
) -> dict[str, Any]:
    """Return the callbacks of a property that stores nothing. Blender hands over the numbers of a
    menu's `items`, and limits no number to the range of the property: from `low` to `high`.
    `several`: of the menu's items a set is chosen."""
    numbers = {item[0]: item[-1] if len(item) > 3 else n for n, item in enumerate(items)}
    names = {number: name for name, number in numbers.items()}

    def get(group: PropertyGroup) -> Any:
        value = read(group)
        if several:
            return sum(numbers[name] for name in numbers if name in value)
        return numbers.get(value, next(iter(names))) if items else value

    def put(group: PropertyGroup, value: Any) -> None:
        if several:
            value = {name for number, name in names.items() if value & number}
        elif items:
            value = names[value]
        elif isinstance(value, int | float):
            value = value if low is None else max(value, low)
            value = value if high is None else min(value, high)
        write(group, value)

    return {"get": get, "set": put}
