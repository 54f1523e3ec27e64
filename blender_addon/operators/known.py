"""Scores that need not be made again: of the very same study, to the bit."""

from __future__ import annotations

import bpy

from .. import bridge, changes
from ..engine import pe
from ..live import latest


def known_score(
    scene: bpy.types.Scene, study: pe.Study, taken: bridge.Fingerprint
) -> pe.Score | None:
    """Return the score of a study as it was read from a scene, if it was made in this session.

    A file of labelled boxes may hold others than it did: what was counted from one is not known.
    """
    found = latest.scored(scene.name)
    if found is None or found.signature != taken.text or study.prior.boxes is not None:
        return None
    return found.score


def remember(scene: bpy.types.Scene, outcome: pe.Outcome, signature: str) -> None:
    """Keep what a job found, for the views and for the next search."""
    latest.note_scored(scene.name, latest.Scored(signature, outcome.study, outcome.after))
    changes.picture.tell()
