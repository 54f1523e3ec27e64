"""``blender -b FILE.blend --command pe VERB``: what the panel does, without a window.

Options, progress, files and exit statuses are those of the command ``pe``.
"""

import argparse
import contextlib
import shlex
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TextIO

import bpy

from ..engine import app, page, pe
from .open_file import flush, take_over_process
from .scene_verbs import (
    check_scene_requirements,
    compare_variants,
    drive_by_scene,
    explain_study,
    export_study,
    list_variants,
    review_scene,
    run_job,
    where_in_scene,
)

__all__ = ["flush", "in_blender", "main", "register", "take_over_process", "unregister"]

IN_BLENDER = "blender -b FILE.blend --command pe"
VerbPart = Callable[..., Any]


def main(argv: Sequence[str], prog: str, out: TextIO) -> int:
    """Run the command on the file that is open; results go to `out`, all else to stderr. Returns
    the exit status. 0: done; 1: bad input, or results that cannot be written; 2: usage; 128 plus
    the number of a signal."""
    try:
        with contextlib.redirect_stdout(out):
            args = parser(prog).parse_args(argv)
        file = shlex.quote(Path(bpy.data.filepath).name or "FILE.blend")
        args.command_line = app.as_typed(prog.replace("FILE.blend", file), argv)
    except SystemExit as stop:  # help was asked for, or the usage was wrong
        return int(stop.code or 0)
    except pe.InputError as error:
        app.tell(str(error))
        return app.BAD_INPUT
    return app.run(lambda: args.function(args), out)


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


def parser(prog: str) -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    top = app.Parser(prog=prog, description="Perception entropy of vehicle sensors.")
    top.add_argument("--version", action="version", version=f"pe {pe.__version__}")
    verbs = top.add_subparsers(required=True, metavar="VERB")
    score = verbs.add_parser("score", help="score the sensors of the scene")
    optimize = verbs.add_parser("optimize", help="search for better places for the sensors")
    for verb, kind in ((score, "score"), (optimize, "optimize")):
        app.add_run_options(verb, search=verb is optimize)
        add_variant_option(verb)
        verb.set_defaults(function=run_job, kind=kind)
    page.add_page()
    app.add_page_option(optimize)

    def made(name: str, about: str, run: VerbPart, *options: VerbPart) -> argparse.ArgumentParser:
        verb = verbs.add_parser(name, help=about)
        for add in options:
            add(verb)
        verb.set_defaults(function=run)
        return verb

    about = "write the scene as a study with its mesh, or its rig for another program"
    also_study = partial(app.add_export_options, also_study=True)
    made("export", about, export_study, also_study, add_variant_option)
    about = "the score in words, or one place of it"
    made("explain", about, explain_study, app.add_explain_options, add_variant_option)
    about = "hold the scene to its requirements; 3: not all are met"
    made("check", about, check_scene_requirements, app.add_check_options, add_variant_option)
    about = "when tracks of what moves are confirmed; 3: some too late"
    driven = made("drive-by", about, drive_by_scene, app.add_drive_by_options, add_variant_option)
    about = "as --story; with -o FILM.webm or .mp4 one, which is rendered as a film"
    driven.add_argument("stories", nargs="*", metavar="STORY", help=about)
    about = "score one more sensor all over the vehicle's surface"
    made("where", about, where_in_scene, app.add_where_options, add_variant_option)
    listing = made("variants", "list the variants in the file", list_variants)
    listing.add_argument("--json", action="store_true", help="print JSON")
    about = "score variants and put them side by side"
    compare = made("compare", about, compare_variants, app.add_compare_options)
    compare.add_argument("variants", nargs="*", metavar="NAME", help="of these (default: all)")
    about = "write a page to hand on: what the sensors see"
    review = made("review", about, review_scene, page.add_review_options, app.add_score_options)
    about = "variants side by side (default: what stands in the scene)"
    review.add_argument("variants", nargs="*", metavar="NAME", help=about)
    app.add_sensors_verb(verbs)
    app.add_rigs_verb(verbs)
    return top


def add_variant_option(verb: argparse.ArgumentParser) -> None:
    """Add the option that puts a variant in place of what stands in the scene."""
    about = "this variant in place of what stands in the scene"
    verb.add_argument("--variant", metavar="NAME", help=about)
