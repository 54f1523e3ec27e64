"""``blender -b FILE.blend --command pe VERB``: what the panel does, without a window.

Verbs, options, progress, files and exit statuses are those of the command ``pe``; the study is the
open scene.
"""

import argparse
import contextlib
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TextIO

import bpy

from ..engine import app, pe
from .open_file import flush, take_over_process
from .scene_source import SceneStudies
from .scene_verbs import check_scene, list_variants, where_in_scene

__all__ = ["flush", "in_blender", "main", "register", "take_over_process", "unregister"]

IN_BLENDER = "blender -b FILE.blend --command pe"
OWN = {"check": check_scene, "where": where_in_scene}
"""What verbs do in place of those of ``pe``: films, mounts of the scene."""
OF_FILES = ("set", "sweep")  # Verbs of study files, which Blender does not have


def main(argv: Sequence[str], prog: str, out: TextIO) -> int:
    """Run the command on the file that is open; results go to `out`, all else to stderr. Returns
    the exit status of ``pe``."""
    file = shlex.quote(Path(bpy.data.filepath).name or "FILE.blend")
    named = prog.replace("FILE.blend", file)
    try:
        with contextlib.redirect_stdout(out):
            args = parser(prog, out, argv).parse_args(argv)
    except SystemExit as stop:  # help was asked for, or the usage was wrong
        return int(stop.code or 0)
    except pe.InputError as error:
        app.tell(str(error))
        return app.BAD_INPUT
    return app.run(lambda: app.answer(args, named, argv), out)


def in_blender(argv: Sequence[str]) -> int:
    """Called by Blender for ``--command pe``."""
    return main(argv, IN_BLENDER, take_over_process())


_registered: list[object] = []


def register() -> None:
    """Register ``--command pe``."""
    _registered.append(bpy.utils.register_cli_command("pe", in_blender))


def unregister() -> None:
    """Unregister the command."""
    bpy.utils.unregister_cli_command(_registered.pop())


def parser(
    prog: str, out: TextIO | None = None, argv: Sequence[str] = ()
) -> argparse.ArgumentParser:
    """Return the parser of the command line; replies of a session go to `out`."""
    source = SceneStudies()
    source.out = out
    shared = [verb for verb in app.VERBS if verb.name not in OF_FILES]
    verbs = [verb._replace(function=OWN.get(verb.name, verb.function)) for verb in shared]
    about = "list the variants in the file"
    verbs.append(
        app.Verb(
            "variants",
            "show",
            about,
            app.NONE,
            options="",
            function=list_variants,
            prints=tuple[Mapping[str, Any], ...],
        )
    )
    top, _ = app.command_parser(prog, f"pe {pe.__version__}", verbs, source, argv=argv)
    return top
