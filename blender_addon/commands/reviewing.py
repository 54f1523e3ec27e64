"""The verb ``review``: a page of the scene's sensors, or of variants side by side."""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

from .. import bridge
from ..engine import app, page, pe
from .opened import opened_scene, opened_study
from .streams import quiet_blender
from .variants import studies_of


def review_scene(args: argparse.Namespace) -> app.Answer:
    """Score what stands in the scene, or variants, and write the page."""
    if args.variants:
        studies = studies_of(opened_scene(), args.variants)
    else:
        studies = {Path(bpy.data.filepath).stem or "scene": opened_study()}
    # The picture shows the scene's own vehicle: variants have theirs drawn.
    picture = rendered if args.render and not args.variants else None
    return page.review_studies(studies, args, picture, bridge.blender_version())


def rendered(outcome: pe.Outcome) -> bytes:
    """Return Blender's picture of an outcome, PNG."""
    from .. import review  # only who wants a picture pays for it

    with quiet_blender():
        return review.picture_of(bpy.context.scene, outcome)
