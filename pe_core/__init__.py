"""Perception entropy of a vehicle's LiDARs and cameras: the engine, pure NumPy.

The metric is from Ma, Liu and Li, "Perception Entropy: A Metric for Multiple Sensors Configuration
Evaluation and Design", ICRA 2021. Lower is better.

The names in `pe_core.public` are here too. They are loaded when one is first asked for: NumPy takes
a while, and the command has to answer Ctrl-C meanwhile.
"""

import sys
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # a checker knows these names, and no others
    from .public import *  # noqa: F403


def _lazy_names(package: str) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
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


if not TYPE_CHECKING:
    __getattr__, __dir__ = _lazy_names(__name__)
