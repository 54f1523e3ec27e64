"""The review picture of a result: vehicle, sensors, fields of view and figures."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import bpy

from .captions import (
    caption_of,
    frame_of,
    legend_of,
    mark_moves,
    mark_rings,
    mark_sensors,
    write_page,
)
from .picture_geometry import look_at
from .stage import Lettering, stage
from .subject import RING_TEXT, RINGS_M, Subject

if TYPE_CHECKING:
    from ..engine import pe

__all__ = ["picture_of", "render_review"]

DEFAULT_SIZE = (1600, 900)


def render_review(
    scene: bpy.types.Scene,
    study: pe.Study,
    outcome: pe.Outcome,
    path: str | Path,
    size: tuple[int, int] = DEFAULT_SIZE,
) -> Path:
    """Render the review picture of an outcome, with Workbench; also without a window.

    The picture is built in a temporary scene; `scene` is not changed.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its settings name the vehicle's collection; without one the study's mesh is shown.
    study : Study
        The rig to show, usually ``outcome.study``.
    outcome : Outcome
        The figures, and the start of the search.
    path : path
        PNG to write, atomically.
    size : (width, height)
        [px].

    Raises
    ------
    InputError
        When the picture cannot be written there.
    """
    words = caption_of(study, outcome)
    subject = Subject.of(study, outcome)
    with stage() as on:
        view = look_at(subject.points_in_view(), frame_of(len(words.table), size))
        on.set_camera(view)
        subject.build(on, view, scene)
        pen = Lettering.on(on, view)
        legend = legend_of(study.rig, stopped=subject.any_stopped, moved=bool(subject.moves()))
        write_page(pen, words, legend)
        mark_rings(pen, RINGS_M, RING_TEXT)
        mark_moves(pen, subject.moves())
        mark_sensors(pen, study.rig, subject.moves())
        on.render(Path(path))
    return Path(path)


def picture_of(scene: bpy.types.Scene, outcome: pe.Outcome) -> bytes:
    """Return the review picture of an outcome as the bytes of a PNG, with the same errors."""
    with tempfile.TemporaryDirectory(prefix="perception-entropy-") as folder:
        path = Path(folder, "review.png")
        return render_review(scene, outcome.study, outcome, path).read_bytes()
