"""``blender -b FILE.blend --command pe VERB``: what the panel does, without a window.

Options, progress, files and exit statuses are those of the command ``pe``.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import signal
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TextIO

import bpy

from . import bridge, stale
from .engine import app, pe, studies

OPTIMIZED, REVIEW = studies.OPTIMIZED, studies.REVIEW
ENDS = {
    b"\x89PNG": b"IEND\xaeB`\x82",
    b"\x28\xb5\x2f\xfd": b"\xb1\xea\x92\x8f",
}
"""What ends a file that begins so: a PNG, and a compressed .blend (zstd with a table of frames)."""
IN_BLENDER = "blender -b FILE.blend --command pe"


def main(argv: Sequence[str], prog: str, out: TextIO) -> int:
    """Run the command on the file that is open; results go to `out`, all else to stderr.

    Returns the exit status: 0 done; 1 bad input, or results that are elsewhere; 2 usage; 128 and
    its number for a signal.
    """
    try:
        with contextlib.redirect_stdout(out):
            args = parser(prog).parse_args(argv)
    except SystemExit as stop:  # help was asked for, or the usage was wrong
        return int(stop.code or 0)
    return app.run(lambda: args.function(args), out)


def parser(prog: str) -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    top = app.Parser(prog=prog, description="Perception entropy of vehicle sensors.")
    top.add_argument("--version", action="version", version=f"pe {pe.__version__}")
    verbs = top.add_subparsers(required=True, metavar="VERB")
    score = verbs.add_parser("score", help="score the sensors of the scene")
    optimize = verbs.add_parser("optimize", help="search for better places for the sensors")
    for verb, job in ((score, pe.ScoreJob), (optimize, pe.OptimizeJob)):
        app.add_run_options(verb, search=job is pe.OptimizeJob)
        verb.add_argument("--no-render", action="store_false", dest="render", help=f"no {REVIEW}")
        add_variant_option(verb)
        verb.set_defaults(function=run_job, job=job, kind=verb.prog.split()[-1])
    export = verbs.add_parser("export", help="write the scene as a study with its mesh")
    export.add_argument("-o", "--output", metavar="DIR", required=True, help="folder for them")
    add_variant_option(export)
    export.set_defaults(function=export_study)
    explain = verbs.add_parser("explain", help="the score in words, or one place of it")
    app.add_explain_options(explain)
    add_variant_option(explain)
    explain.set_defaults(function=explain_study)
    listing = verbs.add_parser("variants", help="list the variants in the file")
    listing.add_argument("--json", action="store_true", help="print JSON")
    listing.set_defaults(function=list_variants)
    compare = verbs.add_parser("compare", help="score variants and put them side by side")
    compare.add_argument("variants", nargs="*", metavar="NAME", help="of these (default: all)")
    app.add_compare_options(compare)
    compare.set_defaults(function=compare_variants)
    app.add_sensors_verb(verbs)
    return top


def add_variant_option(verb: argparse.ArgumentParser) -> None:
    """Add the option that puts a variant in place of what stands in the scene."""
    about = "this variant in place of what stands in the scene"
    verb.add_argument("--variant", metavar="NAME", help=about)


def run_job(args: argparse.Namespace) -> app.Answer:
    """Score or optimize, and leave the results in the output folder."""
    study, kind = app.with_options(opened_study(args.variant), args), args.kind
    if kind == "optimize":
        with from_file():
            bridge.check_placeable(bpy.context.scene, study)
    output, ours = args.output, [OPTIMIZED] * (kind == "optimize") + [REVIEW] * args.render
    if output is not None:
        output = pe.prepare_folder(output, [*ours, *studies.result_names(study, kind)])

    def leave(outcome: pe.Outcome, data: dict, folder: Path) -> None:
        with quiet_blender():
            leave_scene(outcome, data, folder, render=args.render)

    job = args.job(study, args.workers)
    job.notes = bridge.missing_pieces(bpy.context.scene)
    return app.carry_out(
        job,
        output,
        as_json=args.json,
        host=bridge.blender_version(),
        more=app.More(ours, leave),
    )


def export_study(args: argparse.Namespace) -> app.Answer:
    """Write the scene as a study file, with the vehicle's mesh."""
    study = opened_study(args.variant)
    path = pe.prepare_folder(args.output) / studies.STUDY
    pe.export_study(study, path)
    return str(path), app.DONE


def explain_study(args: argparse.Namespace) -> app.Answer:
    """Tell the scene's score in words, or ask a place."""
    return app.explain(app.with_options(opened_study(args.variant), args), args)


def list_variants(args: argparse.Namespace) -> app.Answer:
    """List the variants with the scores that are kept with them."""
    scene = opened_scene()
    bridge.check_variants(scene, stale.fingerprint(scene))
    data = [bridge.variant_dict(scene, row) for row in scene.perception_entropy.variants]
    if args.json:
        return json.dumps(data, indent=2), app.DONE
    return "\n".join(map(_listed, data)) or "no variants", app.DONE


def _listed(row: dict) -> str:
    """One line of the list: which one stands in the scene, its name, its score."""
    score = "not scored" if row["entropy"] is None else f"{row['entropy']:.4f} nats"
    old = "  (scored before vehicle, prior or settings changed)" if row["stale"] else ""
    return f"{'*' if row['active'] else ' '} {row['name']}  {score}{old}"


def compare_variants(args: argparse.Namespace) -> app.Answer:
    """Score variants where they are kept, and put them side by side."""
    scene = opened_scene()
    names = args.variants or [row.name for row in scene.perception_entropy.variants]
    depsgraph = bpy.context.evaluated_depsgraph_get()
    studies = {}
    with from_file():
        for name in names:
            row = bridge.variant_named(scene, name)
            study = bridge.study_of_variant(scene, row, depsgraph)
            studies[name] = app.with_options(study, args)
    if not studies:
        raise pe.InputError(bpy.data.filepath, "variants", "at least one", "none")
    return app.compare(studies, args)


def opened_study(variant: str | None = None) -> pe.Study:
    """Return the study in the file that is open, after putting a variant there.

    Errors name the file.
    """
    scene = opened_scene()
    with from_file():
        if variant is not None:
            bridge.put_variant(scene, bridge.variant_named(scene, variant))
        return bridge.study_from_scene(scene, bpy.context.evaluated_depsgraph_get())


@contextlib.contextmanager
def from_file() -> Iterator[None]:
    """Have errors of the scene name the file that is open."""
    try:
        yield
    except pe.InputError as error:
        raise error.at(bpy.data.filepath) if error.source == "scene" else error from None


def opened_scene() -> bpy.types.Scene:
    """Return the scene of the file that is open; complain when it has nothing of ours."""
    path, scene = bpy.data.filepath, bpy.context.scene
    if not path:
        expected = "an existing .blend file before --command"
        raise pe.InputError("blender", "file", expected, "none opened")
    if scene.perception_entropy.vehicle is None and not bridge.sensor_objects(scene):
        expected = "a vehicle collection and sensors, set in the tab Perception"
        raise pe.InputError(path, f"scene {scene.name!r}", expected, "neither")
    return scene


def leave_scene(outcome: pe.Outcome, data: dict, folder: Path, *, render: bool) -> None:
    """Write what only Blender can: the scene with the sensors moved, and the picture."""
    scene = bpy.context.scene
    if outcome.kind == "optimize":
        bridge.place_rig(scene, outcome.study.rig)
        taken = stale.fingerprint(scene)
        bridge.store_outcome(scene, outcome, taken.text)
        bridge.keep_search(scene, outcome, taken.surroundings)
        studies.add_to_result(data, folder, {OPTIMIZED: save_copy})
    if render:
        from . import review  # only who wants a picture pays for it

        def picture(path: Path) -> None:
            try:
                review.render_review(scene, outcome.study, outcome, path)
            except RuntimeError as error:
                raise pe.InputError(path, "file", "a picture", error) from None
            complain_unless_whole(path)

        studies.add_to_result(data, folder, {REVIEW: picture})


def save_copy(path: Path) -> None:
    """Save the open scene to another file; the open file stays as it is."""
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=True)
    except RuntimeError as error:
        raise pe.InputError(path, "file", "a place to write to", error) from None
    complain_unless_whole(path)


def complain_unless_whole(path: Path) -> None:
    """Raise `InputError` when a file has not the end that its beginning promises.

    On a full disk Blender leaves half a file, or none, and says nothing.
    """
    data = path.read_bytes() if path.is_file() else b""
    end = next((end for begin, end in ENDS.items() if data.startswith(begin)), b"")
    if not data or not data.endswith(end):
        found = f"that {len(data)} bytes of it could be written"
        raise pe.InputError(path, "file", "room to write to", found)


@contextlib.contextmanager
def quiet_blender() -> Iterator[None]:
    """Keep back what Blender and the graphics driver print, unless the work fails."""
    flush(sys.stderr)
    shown = os.dup(2)
    with tempfile.TemporaryFile() as kept:
        os.dup2(kept.fileno(), 1)
        os.dup2(kept.fileno(), 2)
        try:
            yield
        except BaseException:
            with contextlib.suppress(OSError):
                kept.seek(0)
                os.write(shown, kept.read())
            raise
        finally:
            flush(sys.stderr)
            os.dup2(shown, 1)
            os.dup2(shown, 2)
            os.close(shown)


def take_over_process() -> TextIO:
    """Make Ctrl-C Python's and stdout ours; return the stream that results go to.

    Blender prints what it reads, renders and saves on stdout: that goes to stderr from now on.
    Its own handler of Ctrl-C would leave the results behind. A pipe that nobody reads, or a file
    that may not grow, is an error where we write and not the end of the process.
    """
    app.open_missing_streams()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for name in ("SIGPIPE", "SIGXFSZ"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    flush(sys.stdout)
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return out


def flush(stream: TextIO | None) -> None:
    """Hand on what a stream still holds, where it goes anywhere."""
    if stream is not None:
        with contextlib.suppress(OSError, ValueError):
            stream.flush()


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
