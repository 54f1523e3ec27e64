"""Names that ROS takes for frames, made of any."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Collection, Sequence

from .carried import CAMERA, CarriedSensor

OPTICAL = "_optical"
"""What the name of a camera's optical frame ends in."""
ILLEGAL, ILLEGAL_IN_TF = (re.compile(f"[^A-Za-z0-9_{more}]+") for more in ("", "/"))


def legal_frame(name: str, *, slashes: bool = False) -> str:
    """Return a name of letters, digits and underscores that begins with a letter.

    With `slashes`, it may have parts, as frames of tf2 do.
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    legal = (ILLEGAL_IN_TF if slashes else ILLEGAL).sub("_", plain).strip("_/")
    return legal if legal[:1].isalpha() else f"sensor_{legal}".rstrip("_")


def with_legal_frames(
    sensors: Sequence[CarriedSensor],
    *,
    slashes: bool = False,
    frames: Callable[[CarriedSensor], Collection[str]] = lambda each: (each.name,),
    taken: Collection[str] = (),
    not_ending: str = "",
) -> tuple[tuple[CarriedSensor, ...], list[str]]:
    """Return sensors under legal names, no two frames alike, and a line for each that changed.

    Parameters
    ----------
    sensors : sequence of CarriedSensor
    slashes : bool
        Whether names may have parts.
    frames : callable
        All frames that a sensor of a name brings: an optical one beside its own.
    taken : collection of str
        Frames that are there already.
    not_ending : str
        What no sensor's name ends in: it tells other frames.
    """
    used, done, lines = set(taken), [], []
    for each in sensors:
        legal = legal_frame(each.name, slashes=slashes)
        if not_ending and legal.endswith(not_ending):
            legal += "_sensor"
        named, number = each.called(legal), 2
        while used & set(frames(named)):
            named, number = each.called(f"{legal}_{number}"), number + 1
        used |= set(frames(named))
        done.append(named)
        if named.name != each.name:
            lines.append(f"{each.name}: called {named.name}, which is a legal frame of its own")
    return tuple(done), lines


def with_optical_frames(
    sensors: Sequence[CarriedSensor], taken: Collection[str]
) -> tuple[tuple[CarriedSensor, ...], list[str]]:
    """Return sensors under legal names, of which cameras bring an optical frame (REP 103)."""
    return with_legal_frames(sensors, frames=_own_and_optical, taken=taken, not_ending=OPTICAL)


def _own_and_optical(each: CarriedSensor) -> tuple[str, ...]:
    return (each.name, each.name + OPTICAL) if each.kind == CAMERA else (each.name,)
