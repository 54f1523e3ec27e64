"""The open .blend file on the command line: study, streams, artifacts that only Blender writes."""

import contextlib
import os
import signal
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import bpy

from .. import document
from ..caches import result_staleness
from ..engine import app, jobs, pe, studies, text

OPTIMIZED = studies.OPTIMIZED
BLEND_BEGIN = b"\x28\xb5\x2f\xfd"
BLEND_END = b"\xb1\xea\x92\x8f"
"""Of a complete compressed .blend file (zstd with its seek table)."""


def opened_study(variant: str | None = None) -> pe.Study:
    """Return the study of the open file, with a variant's sensors if one is named. Errors name the
    file."""
    scene = opened_scene()
    with from_file():
        if variant is not None:
            document.activate_variant(scene, document.variant_named(scene, variant))
        if scene.perception_entropy.states:
            scene.frame_set(scene.perception_entropy.drawn_frame)
        return document.study_as_drawn(scene)


@contextlib.contextmanager
def from_file() -> Iterator[None]:
    """Have errors of the scene name the open file, within."""
    try:
        yield
    except pe.InputError as error:
        raise error.at(bpy.data.filepath) if error.source == "scene" else error from None


def opened_scene() -> bpy.types.Scene:
    """Return the scene of the open file. `InputError` when no file is open, or the scene has
    neither a vehicle nor sensors."""
    path = bpy.data.filepath
    scene = bpy.context.scene
    if not path:
        expected = "an existing .blend file before --command"
        raise pe.InputError("blender", "file", expected, "none opened")
    for file in (path, *bpy.utils.blend_paths(absolute=True)):  # linked files, pictures
        text.note_input(file)
    if scene.perception_entropy.vehicle is None and not document.sensor_objects(scene):
        expected = "a vehicle collection and sensors, set in the tab Perception"
        raise pe.InputError(path, f"scene {scene.name!r}", expected, "neither")
    return scene


def write_optimized(outcome: jobs.Outcome, data: dict, folder: Path) -> None:
    """Write the optimized scene beside the results of a search."""
    scene = bpy.context.scene
    document.place_rig(scene, outcome.study.rig)
    taken = result_staleness.fingerprint(scene)
    document.store_outcome(scene, outcome, taken.text)
    _, best = document.store_search(scene, outcome, taken.surroundings)
    document.mark_active(scene, best)
    jobs.add_to_result(data, folder, {OPTIMIZED: save_copy})


def write_front(found: jobs.TradeOff, folder: Path) -> None:
    """Write the scene with the designs of a front as variants."""
    scene = bpy.context.scene
    document.store_front(scene, found, result_staleness.fingerprint(scene).surroundings)
    with jobs.FileSet(folder) as files:
        files.add(OPTIMIZED, save_copy)


def save_copy(path: Path) -> None:
    """Save the open scene to another file; the open file stays as it is."""
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=True)
    except RuntimeError as error:
        raise pe.InputError(path, "file", "a path that can be written", error) from None
    check_complete(path)


def check_complete(path: Path) -> None:
    """Raise `InputError` where a compressed .blend file is incomplete. On a full disk Blender
    leaves half a file, or none, without an error."""
    data = path.read_bytes() if path.is_file() else b""
    end = BLEND_END if data.startswith(BLEND_BEGIN) else b""
    if not data or not data.endswith(end):
        found = f"that {len(data)} bytes of it could be written"
        raise pe.InputError(path, "file", "enough space on the disk", found)


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
    """Flush a stream if it is open; ignore errors."""
    if stream is not None:
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
