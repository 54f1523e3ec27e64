"""``python -m blender_addon FILE.blend VERB``: the command in bpy, without a Blender installed."""

import shutil
import sys
from pathlib import Path
from typing import NoReturn, TextIO

import bpy

from . import commands, register, unregister
from .engine import app, pe

PROG = "python -m blender_addon FILE.blend"
USAGE = f"usage: {PROG} VERB [options]\n"


def main(argv: list[str]) -> int:
    """Open the file, run the command on it, and return its exit status."""
    if not argv or argv[0].startswith("-"):
        sys.stderr.write(USAGE)
        return app.USAGE if argv[:1] not in (["-h"], ["--help"]) else app.DONE
    out = commands.take_over_process()
    bpy.ops.wm.read_factory_settings(use_empty=True)  # nothing of a user's own takes part
    register()
    try:
        status = run_on_file(argv, out)
        commands.flush(out)
        return status
    finally:
        unregister()


def run_on_file(argv: list[str], out: TextIO) -> int:
    """Open the file with the add-on registered, run the command, and return its exit status."""
    return app.run(lambda: open_file(argv[0])) or commands.main(argv[1:], PROG, out)


def open_file(name: str) -> app.Answer:
    """Open a .blend file; nothing to print."""
    path = Path(name)
    if not path.is_file():
        raise pe.InputError(name, "", "", "no such file")
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False)
    except RuntimeError as error:
        found = str(error).strip().removeprefix("Error: ")
        raise pe.InputError(name, "file", "a .blend file", found) from None
    return "", app.DONE


def leave(status: int) -> NoReturn:
    """End the process: bpy 4.5 does not end by itself once it has evaluated a driver by Python."""
    shutil.rmtree(bpy.app.tempdir, ignore_errors=True)  # as its own exit would
    app.leave(status, at_once=True)


if __name__ == "__main__":
    leave(main(sys.argv[1:]))
