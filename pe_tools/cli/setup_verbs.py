"""`pe doctor` and `pe completion`: what is installed, and the completion of shells."""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base import dump_json, plugins
from pe_core.base.errors import available_bytes, size_text
from pe_core.base.files import reason_of
from pe_core.version import __version__

from .command import FILES, FOLDERS
from .terminal import DONE, Answer

PACKAGES: Mapping[str, tuple[str, ...]] = {
    "notebook": ("matplotlib", "pandas", "tqdm"),
    "parquet": ("pyarrow",),
    "meshes": ("pycollada", "usd-core"),
    "cluster": ("distributed",),
    "rerun": ("rerun-sdk", "pyarrow"),
    "argoverse": ("pyarrow",),
    "studies": ("matplotlib", "tensorflow"),
    "completion": ("shtab",),
    "blender": ("bpy",),
}
"""Packages of each extra that users install."""
VERSION_TIMEOUT_S = 30
BLENDER, COMMAND = "BLENDER", "blender"
SHELLS = ("bash", "zsh", "fish")


def add_setup_verbs(verbs: Any, top: Callable[[], argparse.ArgumentParser]) -> None:
    """Add ``doctor`` and ``completion``; `top` returns the parser of the whole command."""
    parser = verbs.add_parser("doctor", help="what is installed, to paste into a report")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(function=doctor)
    parser = verbs.add_parser("completion", help="print the script that completes pe in a shell")
    parser.add_argument("shell", choices=SHELLS, metavar="SHELL", help=", ".join(SHELLS))
    parser.set_defaults(function=lambda args: (completion(top(), args.shell), DONE))


def doctor(args: argparse.Namespace) -> Answer:
    """Return what is installed; missing extras are no error."""
    found = installation()
    return (dump_json(found) if args.json else "\n".join(_lines(found))), DONE


def installation() -> dict[str, Any]:
    """Return versions, extras, Blenders, processors, memory and the temporary folder.

    Paths have ``~`` for the user's home folder.
    """
    memory, processors = available_bytes(), os.cpu_count() or 1
    if hasattr(os, "sched_getaffinity"):
        processors = len(os.sched_getaffinity(0))
    try:
        with tempfile.NamedTemporaryFile() as file:
            temporary = f"{_without_home(str(Path(file.name).parent))} (writable)"
    except OSError as error:
        temporary = f"not writable: {reason_of(error)}"
    return {
        "perception_entropy": __version__,
        "installed_in": _without_home(str(Path(__file__).parents[2])),
        "python": f"{platform.python_version()} ({_without_home(sys.executable)})",
        "numpy": np.__version__,
        "platform": platform.platform(),
        "processors": processors,
        "memory_available": "not known" if memory is None else size_text(memory),
        "temporary_folder": temporary,
        "extras": {extra: extra_text(extra) for extra in PACKAGES},
        "blenders": dict(blenders()),
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


def blenders() -> Iterator[tuple[str, str]]:
    """Yield where a Blender was looked for, and its version and path: $BLENDER, then PATH."""
    if named := os.environ.get(BLENDER):
        yield f"${BLENDER}", _blender_text(named)
    yield "PATH", _blender_text(COMMAND)


def _blender_text(command: str) -> str:
    path = shutil.which(command)
    if path is None:
        return "none" if command == COMMAND else f"none: {_without_home(command)} is no program"
    shown = _without_home(path)
    try:
        run = subprocess.run(
            [path, "--version"], capture_output=True, text=True, timeout=VERSION_TIMEOUT_S
        )
    except (OSError, ValueError, subprocess.TimeoutExpired) as error:
        return f"{shown} does not run: {' '.join(str(error).split())}"
    match = re.search(r"^Blender (\S+.*)$", run.stdout, re.MULTILINE)
    return f"{match[1]} ({shown})" if match else f"{shown} tells no version"


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


def completion(top: argparse.ArgumentParser, shell: str) -> str:
    """Return the script that completes the command `pe` in a shell.

    `InputError` where the library that makes the script is not installed.
    """
    shtab = plugins.required_package("shtab")
    _complete_paths(top, shtab)
    script: str = shtab.complete(top, shell)
    return script


def _complete_paths(parser: argparse.ArgumentParser, shtab: Any) -> None:
    """Mark the arguments of a parser and its verbs that are files and folders."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for verb in action.choices.values():
                _complete_paths(verb, shtab)
        elif action.metavar in FILES:
            action.complete = shtab.FILE  # type: ignore[attr-defined]  # where shtab looks for it
        elif action.metavar in FOLDERS:
            action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
