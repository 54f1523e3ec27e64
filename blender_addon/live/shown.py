"""Which score is shown of a scene: one at a time, the same in the panel and in the read-out.

With *Live* on that is the live score, or, where things rest and the stored result is of the scene
as it stands, the stored result: it looks at more. With *Live* off it is the stored result.
"""

from __future__ import annotations

from typing import NamedTuple

import bpy

from . import latest


class ShownScore(NamedTuple):
    """The score that is shown.

    Attributes
    ----------
    entropy, coverage, stderr : float
        Entropy and its standard error [nats], share that is seen, 0 to 1.
    exact : bool
        Whether it is of the scene as it stands; else it is a preview.
    stored : bool
        Whether it is the stored result.
    picture_follows : bool
        Whether beams and maps in the 3D view are still those of before the last move.
    """

    entropy: float
    coverage: float
    stderr: float
    exact: bool
    stored: bool
    picture_follows: bool = False


def shown_score(scene: bpy.types.Scene) -> ShownScore | None:
    """Return the score that is shown of a scene with *Live* on; None while there is none yet."""
    settings, reading = scene.perception_entropy, latest.reading(scene.name)
    if reading is None or not settings.live.on:
        return None
    exact = latest.is_exact(scene.name, reading)
    if exact and settings.has_result and not settings.result_stale:
        own = settings.result_entropy, settings.result_coverage, settings.result_stderr
        return ShownScore(*own, exact=True, stored=True)
    glance = reading.glance
    return ShownScore(glance.entropy, glance.coverage, glance.stderr, exact, stored=False)
