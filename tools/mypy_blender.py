"""What Blender's type stubs cannot say: a plugin of mypy for the add-on.

The stubs call nearly every attribute of Blender's optional, since a context of no window has no
area, and a file may have no scene. Where the add-on runs, a panel has a layout and a context has a
scene. What may truly be missing is tested by the add-on's tests, in windows and without. So an
attribute of one of Blender's classes has no ``None`` in its type when it is read; the add-on's own
functions keep theirs.

Names that a function of Blender chooses from are text: of icons there are a thousand, and others
in each version.

Blender's classes also get attributes while Blender runs: the add-on's properties, and those of the
subclass that an object really is (``Space`` is a ``SpaceView3D``). Both are ``Any``.
"""

from __future__ import annotations

from collections.abc import Callable

from mypy.nodes import MDEF, SymbolTableNode, Var
from mypy.plugin import AttributeContext, ClassDefContext, MethodSigContext, Plugin
from mypy.types import (
    AnyType,
    CallableType,
    FunctionLike,
    Instance,
    LiteralType,
    NoneType,
    Type,
    TypeOfAny,
    UnionType,
    flatten_nested_unions,
    get_proper_type,
)

BLENDER = "bpy.types."
WITH_SETTINGS = {f"{BLENDER}{name}" for name in ("Scene", "Object")}
"""Classes that have the add-on's settings, as ``properties.add_pointers`` adds them."""
SUBCLASSED = {
    f"{BLENDER}{name}"
    for name in (
        "AddonPreferences",
        "Attribute",
        "Curve",
        "NodeSocket",
        "Operator",
        "OperatorProperties",
        "Property",
        "PropertyGroup",
        "Space",
    )
}
"""Classes of whose objects one reads what a subclass has."""
MAX_CLASSES = 3
"""An attribute of more classes (``Object.data`` has fourteen) is ``Any``."""


class BlenderPlugin(Plugin):
    """The hooks that mypy asks for."""

    def get_attribute_hook(self, fullname: str) -> Callable[[AttributeContext], Type] | None:
        """Return how the type of an attribute changes."""
        return _plain if fullname.startswith(BLENDER) else None

    def get_method_signature_hook(
        self, fullname: str
    ) -> Callable[[MethodSigContext], FunctionLike] | None:
        """Return how the signature of a method changes."""
        return _names_as_text if fullname.startswith(BLENDER) else None

    def get_customize_class_mro_hook(
        self, fullname: str
    ) -> Callable[[ClassDefContext], None] | None:
        """Return what is added to a class."""
        if fullname in WITH_SETTINGS or fullname in SUBCLASSED:
            return _add_attributes
        return None


def _plain(context: AttributeContext) -> Type:
    kind = get_proper_type(context.default_attr_type)
    if isinstance(kind, UnionType) and any(_is_id(item) for item in kind.items):
        return AnyType(TypeOfAny.special_form)
    if context.is_lvalue and _is_choice(kind):
        return context.api.named_generic_type("builtins.str", [])
    if context.is_lvalue or not isinstance(kind, UnionType):
        return context.default_attr_type
    items = [item for item in kind.items if not isinstance(get_proper_type(item), NoneType)]
    if len(items) > MAX_CLASSES:
        return AnyType(TypeOfAny.special_form)
    return UnionType.make_union(items)


def _names_as_text(context: MethodSigContext) -> CallableType:
    signature = context.default_signature
    text = context.api.named_generic_type("builtins.str", [])
    return signature.copy_modified(
        arg_types=[text if _is_choice(kind) else kind for kind in signature.arg_types]
    )


def _is_choice(kind: Type) -> bool:
    """Whether a type lists names: of icons, say, which differ between Blender's versions."""
    items = flatten_nested_unions([kind])
    return any(isinstance(get_proper_type(item), LiteralType) for item in items)


def _is_id(kind: Type) -> bool:
    """Whether a type is that of any data-block: which it is, only the add-on knows."""
    proper = get_proper_type(kind)
    return isinstance(proper, Instance) and proper.type.fullname == f"{BLENDER}ID"


def _add_attributes(context: ClassDefContext) -> None:
    info = context.cls.info
    anything = AnyType(TypeOfAny.special_form)
    if info.fullname in WITH_SETTINGS:
        settings = Var("perception_entropy", anything)
        settings.info = info
        settings._fullname = f"{info.fullname}.perception_entropy"
        info.names[settings.name] = SymbolTableNode(MDEF, settings)
    if info.fullname in SUBCLASSED:
        info.fallback_to_any = True


def plugin(_version: str) -> type[Plugin]:
    """Return the plugin, as mypy asks for it."""
    return BlenderPlugin
