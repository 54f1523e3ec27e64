"""Packages that the command line uses where they are installed: extras, never needed.

The engine imports NumPy and the standard library alone; this is the one place that looks for more.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

EXTRAS = {"tqdm": "progress", "distributed": "cluster"}
"""Optional packages, and the extra that brings each: ``pip install .[progress]``."""


def extra(package: str) -> Any | None:
    """Return a package of `EXTRAS`; None where it is not installed."""
    assert package in EXTRAS
    try:
        return import_module(package)
    except ImportError:
        return None
