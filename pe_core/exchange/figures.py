"""Numbers in foreign files: one rule for every reader.

A number stands as a number or as text (XML, tables, DriveWorks' and protobuf's JSON). It has to be
finite and in the range of what it measures. A word, NaN, an infinity or a size that no sensor has
is refused with the file, the field, what was expected and what was found; never taken as 0, and
never as if it were not there.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

from ..errors import InputError, shown
from ..kinds.camera.lens.lens import COEFFICIENT, FOCAL, PLACE
from ..kinds.camera.model import FARTHEST, PIXELS
from ..kinds.lidar.model import RANGE, STEPS
from ..kinds.ranges import MIN_RANGE
from ..text.values import FINITE, Number, Whole

__all__ = ["COEFFICIENT", "FARTHEST", "FOCAL", "MIN_RANGE", "PIXELS", "PLACE", "RANGE", "STEPS"]
__all__ += ["AZIMUTH", "CHANNELS", "ELEVATION", "FOV_RAD", "figure", "figures", "whole_figure"]

QUARTER = math.pi / 2.0
ELEVATION = Number(-QUARTER, QUARTER, unit="rad", noun="angle")
AZIMUTH = Number(-4.0 * math.pi, 4.0 * math.pi, unit="rad", noun="angle")
FOV_RAD = Number(0.0, math.pi, above=True, below=True, unit="rad", noun="angle")
"""Field of view of a pinhole."""
CHANNELS = Whole(1, 10_000, "channels")
PLAIN = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
"""A number as files write it; Python alone takes 1_0 and digits of other scripts, too."""
LONGEST = 400
"""Characters of a number; the longest float written out has 325 digits after its point."""


def figure(source: object, field: str, value: Any, rule: Number = FINITE) -> float:
    """Return a number of a rule, given as a number or as text.

    Raises
    ------
    InputError
        When it is none, not finite or not in the range.
    """
    if not isinstance(value, str):
        return rule.checked(source, field, value)
    text = value.strip()
    if len(text) > LONGEST or not PLAIN.fullmatch(text):
        raise InputError(source, field, rule.words(), shown(value))
    number = float(text)
    if not rule.holds(number):
        raise InputError(source, field, rule.words(number), shown(value))
    return number


def whole_figure(source: object, field: str, value: Any, rule: Whole = PIXELS) -> int:
    """Return a whole number of a rule, given as a number or as text; else raise `InputError`."""
    if isinstance(value, str) and len(value) <= LONGEST and PLAIN.fullmatch(value.strip()):
        number = float(value)
        return rule.checked(source, field, number if math.isfinite(number) else value)
    return rule.checked(source, field, value)


def figures(
    source: object, field: str, text: Any, counts: Sequence[int] | None, rule: Number = FINITE
) -> list[float]:
    """Return numbers with blanks between, as many as one of `counts`; None: any number of them.

    Raises
    ------
    InputError
        When there are more or fewer, or one is none, not finite or not in the range.
    """
    words = str(text).split() if isinstance(text, str) else [text]
    if counts is not None and len(words) not in counts:
        many = " or ".join(map(str, counts))
        raise InputError(source, field, f"{many} numbers", shown(text))
    return [figure(source, field, word, rule) for word in words]
