"""The open scene as the source of the command line's studies: what it shows, or its variants."""

import argparse
import contextlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import bpy

from .. import document
from ..engine import app, jobs, pe
from .open_file import (
    OPTIMIZED,
    from_file,
    opened_scene,
    opened_study,
    quiet_blender,
    write_front,
    write_optimized,
)


class SceneStudies(app.StudyFiles):
    """Studies of the open scene."""

    @property
    def versions(self) -> dict[str, str]:
        """Versions of Blender, for the results."""
        return document.blender_version()

    def add_arguments(self, verb: argparse.ArgumentParser, takes: str) -> None:
        """Add what names variants to the parser of a verb."""
        if takes in (app.ONE, app.PERHAPS):
            about = "this variant in place of what stands in the scene"
            verb.add_argument("--variant", metavar="NAME", help=about)
        elif takes == app.SOME:
            about = "variants, in place of what stands in the scene (compare: of all)"
            verb.add_argument("variants", nargs="*", metavar="NAME", help=about)

    def study(self, args: argparse.Namespace) -> pe.Study:
        """Return the study of the scene, or of a variant, with the changes of the options."""
        return self.changed(opened_study(args.variant), args, bpy.data.filepath)

    def opened(self) -> pe.Study:
        """Return the study of the scene: a session begins with it."""
        return opened_study()

    def studies(self, args: argparse.Namespace) -> dict[str, pe.Study]:
        """Return the studies of variants by name, with the changes of the options: of those that
        are named; else to compare of all, and for a page of what stands in the scene."""
        scene = opened_scene()
        names = args.variants
        if not names and args.kind == "compare" and args.built is None:
            names = [row.name for row in scene.perception_entropy.variants]
            if not names:
                raise pe.InputError(bpy.data.filepath, "variants", "at least one", "none")
        if not names:
            name = Path(bpy.data.filepath).stem or "scene"
            return {name: self.changed(opened_study(), args, bpy.data.filepath)}
        found = studies_of(scene, names)
        return {n: self.changed(s, args, bpy.data.filepath) for n, s in found.items()}

    @contextlib.contextmanager
    def naming(self, _: argparse.Namespace) -> Iterator[None]:
        """Have errors of the scene name the open file, within."""
        with from_file():
            yield

    def artifacts(self, study: pe.Study, *, searches: bool) -> Sequence[app.More]:
        """Return the optimized scene of a search. `InputError` where the scene could not take its
        result."""
        if not searches:
            return ()
        with from_file():
            check = document.check_choosable if jobs.has_front(study) else document.check_placeable
            check(bpy.context.scene, study)
        return [app.More([OPTIMIZED], leave_scene)]

    def stored_result(self, study: pe.Study, _: argparse.Namespace) -> Mapping[str, Any] | None:
        """Return the last result of the scene; None where it is not of the study."""
        return document.stored_result(opened_scene(), study)

    def notes(self) -> tuple:
        """Return warnings about data that the scene misses."""
        return document.missing_data(bpy.context.scene)


def leave_scene(found: jobs.Outcome | jobs.TradeOff, data: dict, folder: Path) -> None:
    """Write the scene with the result of a search; the designs of a front are its variants."""
    with quiet_blender():
        if isinstance(found, jobs.TradeOff):
            write_front(found, folder)
        else:
            write_optimized(found, data, folder)


def studies_of(scene: bpy.types.Scene, names: Sequence[str]) -> dict[str, pe.Study]:
    """Return the studies of variants where they are kept, by name."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    with from_file():
        rows = {name: document.variant_named(scene, name) for name in names}
        return {n: document.study_of_variant(scene, row, depsgraph) for n, row in rows.items()}
