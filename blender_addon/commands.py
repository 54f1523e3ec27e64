"""``blender -b FILE.blend --command pe VERB``: what the panel does, without a window.

Options, progress, files and exit statuses are those of the command ``pe``.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import secrets
import signal
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TextIO

import bpy

from . import bridge
from .engine import app, pe, studies

REVIEW, OPTIMIZED = "review.png", "optimized.blend"
IN_BLENDER = "blender -b FILE.blend --command pe"


def main(argv: Sequence[str], prog: str, out: TextIO) -> int:
    """Run the command on the file that is open; results go to `out`, all else to stderr.

    Returns the exit status: 0 done, 1 bad input, 2 usage, 130 interrupted.
    """
    try:
        with contextlib.redirect_stdout(out):
            args = parser(prog).parse_args(argv)
    except SystemExit as stop:  # help was asked for, or the usage was wrong
        return int(stop.code or 0)
    return app.run(lambda: args.function(args), out)


def parser(prog: str) -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    top = argparse.ArgumentParser(prog=prog, description="Perception entropy of vehicle sensors.")
    top.add_argument("--version", action="version", version=f"pe {pe.__version__}")
    verbs = top.add_subparsers(required=True, metavar="VERB")
    score = verbs.add_parser("score", help="score the sensors of the scene")
    optimize = verbs.add_parser("optimize", help="search for better places for the sensors")
    for verb, job in ((score, pe.ScoreJob), (optimize, pe.OptimizeJob)):
        app.add_run_options(verb, search=job is pe.OptimizeJob)
        verb.add_argument("--no-render", action="store_true", help=f"no {REVIEW}")
        verb.set_defaults(function=run_job, job=job)
    export = verbs.add_parser("export", help="write the scene as a study with its mesh")
    export.add_argument("-o", "--output", metavar="DIR", required=True, help="folder for them")
    export.set_defaults(function=export_study)
    app.add_sensors_verb(verbs)
    return top


def run_job(args: argparse.Namespace) -> app.Answer:
    """Score or optimize, and leave the results in the output folder."""
    study = app.with_options(opened_study(), args)
    output = None if args.output is None else pe.prepare_folder(args.output)
    outcome = app.drive(args.job(study, args.workers), output)
    host = bridge.blender_version()
    if output is None:
        data = pe.result_dict(outcome, host)
    else:
        data = pe.write_outcome(outcome, output, host)
        with quiet_blender():
            leave_scene(outcome, output, render=not args.no_render)
    return app.answer(outcome, data, as_json=args.json)


def export_study(args: argparse.Namespace) -> app.Answer:
    """Write the scene as a study file, with the vehicle's mesh."""
    path = pe.prepare_folder(args.output) / studies.STUDY
    pe.export_study(opened_study(), path)
    return str(path), app.DONE


def opened_study() -> pe.Study:
    """Return the study in the file that is open; errors name the file."""
    path, scene = bpy.data.filepath, bpy.context.scene
    if not path:
        expected = "an existing .blend file before --command"
        raise pe.InputError("blender", "file", expected, "none opened")
    if scene.perception_entropy.vehicle is None and not bridge.sensor_objects(scene):
        expected = "a vehicle collection and sensors, set in the tab Perception"
        raise pe.InputError(path, f"scene {scene.name!r}", expected, "neither")
    try:
        return bridge.study_from_scene(scene, bpy.context.evaluated_depsgraph_get())
    except pe.InputError as error:
        raise error.at(path) if error.source == "scene" else error from None


def leave_scene(outcome: pe.Outcome, output: Path, *, render: bool) -> None:
    """Write what only Blender can: the scene with the sensors moved, and the picture."""
    scene = bpy.context.scene
    if outcome.kind == "optimize":
        bridge.place_rig(scene, outcome.study.rig)
        bridge.store_outcome(scene, outcome)
        save_copy(output / OPTIMIZED)
    if render:
        from . import review  # only who wants a picture pays for it

        review.render_review(scene, outcome.study, outcome, output / REVIEW)


def save_copy(path: Path) -> None:
    """Save the open scene to another file, all of it or nothing; the open file stays as it is."""
    temporary = path.with_name(f".{path.stem}.{secrets.token_hex(4)}.blend")
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(temporary), copy=True, compress=True)
        os.replace(temporary, path)
    except (OSError, RuntimeError) as error:
        raise pe.InputError(path, "file", "a place to write to", error) from None
    finally:
        temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def quiet_blender() -> Iterator[None]:
    """Keep back what Blender and the graphics driver print, unless the work fails."""
    sys.stderr.flush()
    shown = os.dup(2)
    with tempfile.TemporaryFile() as kept:
        os.dup2(kept.fileno(), 1)
        os.dup2(kept.fileno(), 2)
        try:
            yield
        except BaseException:
            kept.seek(0)
            os.write(shown, kept.read())
            raise
        finally:
            sys.stderr.flush()
            os.dup2(shown, 1)
            os.dup2(shown, 2)
            os.close(shown)


def take_over_process() -> TextIO:
    """Make Ctrl-C Python's and stdout ours; return the stream that results go to.

    Blender prints what it reads, renders and saves on stdout: that goes to stderr from now on.
    Its own handler of Ctrl-C would leave the results behind.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.stdout.flush()
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return out


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
