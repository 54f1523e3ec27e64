"""What mounting errors do to a placement that was found, in words."""

from __future__ import annotations

import math

from .advice import FRAGILE, Advice
from .figures import metres

FRAGILE_NATS = 0.05
"""A mean that rises by no more than this is within what voxels and mounting errors leave open."""
SURE = 2.0
"""... nor is one that rises by no more than so many standard errors."""


def fragile(
    rise: float, stderr: float, position: float, angle: float, tolerant: bool
) -> tuple[Advice, ...]:
    """Tell of a placement whose entropy rises much under mounting errors.

    Parameters
    ----------
    rise, stderr : float
        Of the mean over the errors, and its standard error [nats].
    position, angle : float
        1 sigma of the errors [m, rad].
    tolerant : bool
        Whether it was searched for under such errors.
    """
    if rise <= max(FRAGILE_NATS, SURE * stderr):
        return ()
    advice = "" if tolerant else "; a search with a tolerance looks for one that is less fragile"
    text = f"{off_by(position, angle)} (1 sigma) it is {rise:.2f} nats worse on average{advice}"
    return (Advice(None, FRAGILE, text),)


def off_by(position: float, angle: float) -> str:
    """Return mounting errors as "mounted 1 cm and 0.3 deg off"."""
    turned = f"{math.degrees(angle):.2g} deg"
    moved = f"{1000.0 * position:.2g} mm" if position < 0.00995 else metres(position)
    named = [*[moved] * (position > 0.0), *[turned] * (angle > 0.0)]
    return f"mounted {' and '.join(named)} off"
