"""What is known now, scene by scene, for whoever shows it: plain data, gone with the file.

`Scored` is the last finished score in full, its ground map included. `Reading` is what the live
score says of the scene as it is, or was a moment ago.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..engine import pe


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
    before : Glance or None
        The same before the drag began, or the one that is under way; None for the first.
    rested : bool
        Whether it was read of a scene at rest: exactly, and to the bit as any front end would.
    rig : Rig
        What was scored.
    moved_m : float
        How far a body of very many triangles was moved by making it simpler, at most; 0 as a rule.
    """

    glance: pe.Glance
    before: pe.Glance | None
    rested: bool
    rig: pe.Rig
    moved_m: float = 0.0


_scored: dict[str, Scored] = {}
_readings: dict[str, Reading] = {}
_notes: dict[str, str] = {}
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
    _notes.pop(scene_name, None)


def note(scene_name: str) -> str:
    """Return why the reading is not that of the scene as it is; "" when it is, or soon will be."""
    return _notes.get(scene_name, "")


def set_note(scene_name: str, line: str) -> None:
    """Keep why there is no newer reading, in one line."""
    _notes[scene_name] = line


def forget_reading(scene_name: str) -> None:
    """Drop what the live score said of a scene: it no longer is asked."""
    _readings.pop(scene_name, None)
    _notes.pop(scene_name, None)


def forget() -> None:
    """Drop everything: another file is about to be shown, or nothing any more."""
    for each in (_scored, _readings, _notes):
        each.clear()
