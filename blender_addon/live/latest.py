"""What is known now, scene by scene, for whoever shows it: plain data, gone with the file.

`Scored` is the last finished score in full, its ground map included. `Reading` is what the live
score says of the scene as it is, or was a moment ago.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

from ..engine import pe
from .reference import Baseline


@dataclass(frozen=True)
class Scored:
    """A study, its score, and the signature of the scene that it was read from."""

    signature: str
    study: pe.Study
    score: pe.Score


@dataclass(frozen=True)
class Reading:
    """What the live score says.

    Attributes
    ----------
    glance : Glance
        The whole rig's entropy and coverage, by class and by zone; a draft while it moves.
    reference : Baseline or None
        What it is compared with; None where there is nothing to compare with yet.
    rested : bool
        Whether it was read of a scene at rest: exactly, and to the bit as any front end would.
    rig : Rig
        What was scored.
    moved_m : float
        How far a body of very many triangles was moved by making it simpler, at most; 0 as a rule.
    number : int
        Which of the scene's requests it answers.
    problem : Hashable
        Tells vehicle, prior, space and settings it was scored under from others.
    """

    glance: pe.Glance
    reference: Baseline | None
    rested: bool
    rig: pe.Rig
    moved_m: float = 0.0
    number: int = 0
    problem: Hashable = None

    @property
    def before(self) -> pe.Glance | None:
        """What the score is compared with, once it is known."""
        return None if self.reference is None else self.reference.glance


_scored: dict[str, Scored] = {}
_readings: dict[str, Reading] = {}
_exact: dict[str, Reading] = {}
_notes: dict[str, str] = {}
_requests: dict[str, int] = {}
"""By the scene's name."""


def scored(scene_name: str) -> Scored | None:
    """Return the last finished score of a scene in this session, None when there was none."""
    return _scored.get(scene_name)


def note_scored(scene_name: str, found: Scored) -> None:
    """Keep a finished score; the ground map of the one before is let go."""
    _scored[scene_name] = found


def reading(scene_name: str) -> Reading | None:
    """Return what the live score says of a scene, None when it says nothing yet."""
    return _readings.get(scene_name)


def note_reading(scene_name: str, found: Reading) -> None:
    """Keep what the live score says; what was in its way no longer is."""
    _readings[scene_name] = found
    if found.rested:
        _exact[scene_name] = found
    _notes.pop(scene_name, None)


def exact(scene_name: str) -> Reading | None:
    """Return the last exact reading: previews may have come since."""
    return _exact.get(scene_name)


def note_request(scene_name: str) -> int:
    """Note that the scene is no longer as it was read before; return the number of the request."""
    _requests[scene_name] = number = _requests.get(scene_name, 0) + 1
    return number


def is_exact(scene_name: str, found: Reading) -> bool:
    """Whether a reading is the exact score of the scene as it stands; else it is a preview."""
    return found.rested and found.number == _requests.get(scene_name, 0)


def note(scene_name: str) -> str:
    """Return why the reading is not that of the scene as it is; "" when it is, or soon will be."""
    return _notes.get(scene_name, "")


def set_note(scene_name: str, line: str) -> None:
    """Keep why there is no newer reading, in one line."""
    _notes[scene_name] = line


def forget_reading(scene_name: str) -> None:
    """Drop what the live score said of a scene: it no longer is asked."""
    _readings.pop(scene_name, None)
    _exact.pop(scene_name, None)
    _notes.pop(scene_name, None)


def forget() -> None:
    """Drop everything: another file is about to be shown, or nothing any more."""
    for each in (_scored, _readings, _exact, _notes, _requests):
        each.clear()
