"""Plugins: what packages beside the engine bring, found by entry points.

A plugin is somebody else's program: it may lack a library, fail, or return something else than was
asked for. Whatever it does ends as one line that names the plugin and its package.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import EntryPoint
from typing import Any

from ..errors import InputError


def plugin_name(point: EntryPoint) -> str:
    """Return a plugin as messages call it: its name and the package that brings it."""
    package = point.dist.name if point.dist is not None else point.module
    return f"plugin {point.name!r} of {package}"


def load_plugin(point: EntryPoint) -> Any:
    """Return what an entry point leads to.

    Raises
    ------
    ImportError
        A library is missing: the caller knows what installs it.
    InputError
        The plugin fails while it is loaded.
    """
    return _guarded(point, "to load", point.load, ImportError)


def call_plugin(point: EntryPoint, function: Any, *arguments: Any) -> Any:
    """Call a plugin's function.

    Raises
    ------
    InputError
        It is no function, or whatever the function raises; its own `InputError` as it is.
    """
    if not callable(function):
        raise InputError(plugin_name(point), "entry point", "a function", type(function).__name__)
    return _guarded(point, "to run to its end", lambda: function(*arguments), InputError)


def _guarded(
    point: EntryPoint, expected: str, work: Callable[[], Any], let: type[Exception]
) -> Any:
    try:
        return work()
    except let:
        raise
    except (Exception, SystemExit) as error:  # another program's: it may raise anything
        found = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(plugin_name(point), "plugin", expected, found) from error
