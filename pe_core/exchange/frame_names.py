"""Names that ROS takes for frames, made of any."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from .carried import CarriedSensor, named_apart

ILLEGAL, ILLEGAL_IN_TF = (re.compile(f"[^A-Za-z0-9_{more}]+") for more in ("", "/"))


def legal_frame(name: str, *, slashes: bool = False) -> str:
    """Return a name of letters, digits and underscores that begins with a letter.

    With `slashes`, it may have parts, as frames of tf2 do.
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    legal = (ILLEGAL_IN_TF if slashes else ILLEGAL).sub("_", plain).strip("_/")
    return legal if legal[:1].isalpha() else f"sensor_{legal}".rstrip("_")


def with_legal_frames(
    sensors: Sequence[CarriedSensor], *, slashes: bool = False
) -> tuple[tuple[CarriedSensor, ...], list[str]]:
    """Return sensors under legal names, no two alike, and a line for each that changed."""
    names = named_apart([legal_frame(each.name, slashes=slashes) for each in sensors])
    pairs = list(zip(sensors, names, strict=True))
    lines = [f"{s.name}: called {n}, which is a legal frame" for s, n in pairs if s.name != n]
    return tuple(sensor.called(name) for sensor, name in pairs), lines
