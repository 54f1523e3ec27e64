"""What takes a library to write: packages beside the engine have it, found by entry points.

An entry point of the group `LIBRARIES` has the name of what it brings, and leads to it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from ..errors import InputError
from ..text.plugins import call_plugin, load_plugin

LIBRARIES = "pe_core.libraries"
EXTRAS = {"dxf": "cad", "rerun": "rerun", "feather": "argoverse"}
"""The extra that brings each: ``pip install 'perception-entropy[cad]'``."""


def brought(name: str, title: str) -> Any:
    """Return what an entry point leads to; `title` is what asks for it.

    Raises
    ------
    InputError
        There is none, or it lacks its library, and what installs it.
    """
    return _loaded(name, title)[1]


def brought_function(name: str, title: str) -> Callable[..., Any]:
    """Return the function that an entry point leads to; what it raises is one line.

    Raises
    ------
    InputError
        As `brought`.
    """
    return partial(call_plugin, *_loaded(name, title))


def _loaded(name: str, title: str) -> tuple[EntryPoint, Any]:
    expected = f"pip install 'perception-entropy[{EXTRAS[name]}]'"
    for point in entry_points(group=LIBRARIES, name=name):
        try:
            return point, load_plugin(point)
        except ImportError as error:
            raise InputError(title, "library", expected, " ".join(str(error).split())) from error
    raise InputError(title, "library", expected, "none installed")
