"""``blender -b FILE.blend --command pe VERB``: what the panel does, without a window.

Options, progress, files and exit statuses are those of the command ``pe``.
"""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

import bpy

from ..engine import app
from .parser import parser
from .streams import flush, take_over_process

__all__ = ["flush", "in_blender", "main", "register", "take_over_process", "unregister"]

IN_BLENDER = "blender -b FILE.blend --command pe"


def main(argv: Sequence[str], prog: str, out: TextIO) -> int:
    """Run the command on the file that is open; results go to `out`, all else to stderr.

    Returns the exit status: 0 done; 1 bad input, or results that are elsewhere; 2 usage; 128 and
    its number for a signal.
    """
    try:
        with contextlib.redirect_stdout(out):
            args = parser(prog).parse_args(argv)
        file = shlex.quote(Path(bpy.data.filepath).name or "FILE.blend")
        args.command_line = app.as_typed(prog.replace("FILE.blend", file), argv)
    except SystemExit as stop:  # help was asked for, or the usage was wrong
        return int(stop.code or 0)
    return app.run(lambda: args.function(args), out)


def in_blender(argv: Sequence[str]) -> int:
    """Called by Blender for ``--command pe``."""
    return main(argv, IN_BLENDER, take_over_process())


_registered: list[object] = []


def register() -> None:
    """Make ``--command pe`` known."""
    _registered.append(bpy.utils.register_cli_command("pe", in_blender))


def unregister() -> None:
    """Take it back."""
    bpy.utils.unregister_cli_command(_registered.pop())
