"""`pe doctor`: what is installed."""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import sys
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base import dump_json, plugins
from pe_core.version import __version__

from .terminal import DONE, Answer

PACKAGES: Mapping[str, tuple[str, ...]] = {
    "notebook": ("matplotlib", "pandas", "tqdm"),
    "meshes": ("pycollada", "usd-core"),
    "cluster": ("distributed",),
    "argoverse": ("pyarrow",),
    "studies": ("matplotlib", "tensorflow"),
    "blender": ("bpy",),
}
"""Packages of each extra that users install."""


def add_doctor_verb(verbs: Any) -> None:
    """Add ``doctor``."""
    parser = verbs.add_parser("doctor", help="what is installed, to paste into a report")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(function=doctor)


def doctor(args: argparse.Namespace) -> Answer:
    """Return what is installed; missing extras are no error."""
    found = installation()
    return (dump_json(found) if args.json else "\n".join(_lines(found))), DONE


def installation() -> dict[str, Any]:
    """Return versions, extras, Blender and processors. Paths have ``~`` for the home folder."""
    named = os.environ.get("BLENDER", "blender")
    return {
        "perception_entropy": __version__,
        "installed_in": _without_home(str(Path(__file__).parents[2])),
        "python": f"{platform.python_version()} ({_without_home(sys.executable)})",
        "numpy": np.__version__,
        "platform": platform.platform(),
        "processors": os.cpu_count() or 1,
        "blender": _without_home(shutil.which(named) or f"none: {named} is no program"),
        "extras": {extra: extra_text(extra) for extra in PACKAGES},
    }


def extra_text(extra: str) -> str:
    """Return the versions of an extra's packages, or how to install the extra."""
    versions = {package: _version(package) for package in PACKAGES[extra]}
    if None in versions.values():
        return f"missing: {plugins.extra_text(extra)}"
    return ", ".join(f"{package} {found}" for package, found in versions.items())


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _without_home(path: str) -> str:
    """Return a path with ``~`` for the home folder: the user's name is not pasted."""
    home = os.path.expanduser("~").rstrip(os.sep)
    is_inside = len(home) > 1 and (path + os.sep).startswith(home + os.sep)
    return f"~{path[len(home) :]}" if is_inside else path


def _lines(found: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines of an installation: names with underscores as words, then what was found."""
    width = max(len(key) for key in found)
    for key, value in found.items():
        name = key.replace("_", " ")
        if not isinstance(value, Mapping):
            yield f"{name:{width}}  {value}"
            continue
        yield name
        inner = max(len(each) for each in value)
        yield from (f"  {each:{inner}}  {text}" for each, text in value.items())
