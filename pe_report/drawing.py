"""Whether there is matplotlib, and the module that draws with it: imported when a plot is drawn."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from pe_core import InputError

EXTRA = 'pip install "perception-entropy[report]"'


def has_matplotlib() -> bool:
    """Whether matplotlib is installed; it is not imported."""
    try:
        return find_spec("matplotlib") is not None
    except ValueError:  # a module without a specification stands in its place
        return False


def figures() -> Any:
    """Return the module of figures.

    Raises
    ------
    InputError
        Where matplotlib is missing.
    """
    return _drawing_module("figures")


def front_figure() -> Any:
    """Return the module of the plot of a front; the same error."""
    return _drawing_module("front")


def validity_figures() -> Any:
    """Return the module of the plots of ``pe validate``; the same error."""
    return _drawing_module("validity.figures")


def _drawing_module(name: str) -> Any:
    try:
        return import_module(f".{name}", __package__)
    except ImportError:
        raise InputError("plots", "package", f"matplotlib: {EXTRA}", "no matplotlib") from None
