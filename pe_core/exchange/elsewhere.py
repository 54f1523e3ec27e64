"""What takes a library to write: packages beside the engine have it, found by entry points.

An entry point of the group `LIBRARIES` has the name of what it brings, and leads to it.
"""

from __future__ import annotations

from importlib.metadata import entry_points
from typing import Any

from ..errors import InputError
from ..text.plugins import load_plugin

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
    expected = f"pip install 'perception-entropy[{EXTRAS[name]}]'"
    for point in entry_points(group=LIBRARIES, name=name):
        try:
            return load_plugin(point)
        except ImportError as error:
            raise InputError(title, "library", expected, " ".join(str(error).split())) from error
    raise InputError(title, "library", expected, "none installed")
