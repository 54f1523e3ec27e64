"""Faces of packages whose names are loaded when one is first asked for: a command starts with what
it needs. Python 3.15 has ``lazy from`` for the same (PEP 810)."""

import _imp
import builtins
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any, NamedTuple

_origins: dict[str, dict[str, "_FaceName"]] = {}
"""By package where the names of its face come from."""


class _FaceName(NamedTuple):
    """Where a name of a face comes from: a module, relative to the package, and the name there."""

    module: str
    name: str

    def value(self, package: str) -> Any:
        """Load what is named. Of ``from . import name`` that is a module."""
        if not self.module.strip("."):
            return import_module(self.module + self.name, package)
        return getattr(import_module(self.module, package), self.name)


class _Noted:
    """Stands for a module while names that are imported from it are noted."""

    def __init__(self, module: str) -> None:
        self._module = module

    def __getattr__(self, name: str) -> _FaceName:
        return _FaceName(self._module, name)


class _Face(ModuleType):
    """A package that loads a name of its face when it is first asked for."""

    def __getattr__(self, name: str) -> Any:
        origin = _origins[self.__name__].get(name)
        if origin is None:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        value = vars(self)[name] = origin.value(self.__name__)
        return value

    def __setattr__(self, name: str, value: Any) -> None:
        is_shadow = isinstance(value, ModuleType) and name in _origins[self.__name__]
        if not is_shadow:  # Python sets a module that it loads, and a function may have its name
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*vars(self), *_origins[self.__name__]})


@contextmanager
def lazy_face(package: str) -> Iterator[None]:
    """Within, ``from .module import name`` in the face of a package loads nothing yet.

    Parameters
    ----------
    package : str
        ``__name__`` of the package whose ``__init__`` has the imports.
    """
    face = sys.modules[package]
    variables = vars(face)

    def note(
        name: str,
        importer: Mapping[str, object] | None = None,
        scope: Mapping[str, object] | None = None,
        names: Sequence[str] = (),
        level: int = 0,
    ) -> Any:
        if importer is variables:
            return _Noted("." * level + name)
        return load(name, importer, scope, names, level)  # of another thread

    _imp.acquire_lock()  # one thread at a time: two would put back each other's `note`
    load = builtins.__import__
    builtins.__import__ = note  # type: ignore[assignment]
    try:
        yield
    finally:
        builtins.__import__ = load
        _imp.release_lock()
    origins = {name: value for name, value in variables.items() if isinstance(value, _FaceName)}
    for name in origins:
        del variables[name]
    _origins[package] = origins
    face.__class__ = _Face


def public_names(package: str) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return `__getattr__` and `__dir__` of a package that shows the names of its `public`."""

    def get(name: str) -> object:
        if not name.startswith("__") and find_spec(f"{package}.{name}"):
            return import_module(f".{name}", package)
        public = import_module(".public", package)
        if name == "__all__":
            return sorted(public.__all__)
        if name not in public.__all__:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = vars(sys.modules[package])[name] = getattr(public, name)
        return value

    def names() -> list[str]:
        return sorted(import_module(".public", package).__all__)

    return get, names
