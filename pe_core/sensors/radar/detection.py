"""Detection by a radar: SNR of a target, and the probability that it is detected.

All functions are element-wise. Powers are ratios, not dB, unless a name ends in `_db`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ...base.arrays import Floats

MIN_PD = 0.1
"""A resolution cell that is detected more rarely than this does not count."""


def ratio_of_db(db: float) -> float:
    """Return 10^(dB / 10)."""
    return float(10.0 ** (db / 10.0))


def snr_for(pd: float, pfa: float) -> float:
    """Return the mean SNR at which a Swerling 1 target is detected with probability `pd`.

    ``SNR = ln Pfa / ln Pd - 1``: 21.1 dB for 0.9 at 1e-6. Source: Swerling, "Probability of
    detection for fluctuating targets", RAND RM-1217 (1954), case 1, one pulse; also Skolnik,
    Introduction to Radar Systems, section 2.8.
    """
    return math.log(pfa) / math.log(pd) - 1.0


def detection_probability(snr: ArrayLike, pfa: float) -> Floats:
    """Return ``Pd = Pfa^(1 / (1 + SNR))``: Swerling 1, one pulse (sources as in `snr_for`)."""
    return np.exp(math.log(pfa) / (1.0 + np.asarray(snr, dtype=float)))


def counted(pd: Floats) -> Floats:
    """Return probabilities of detection, 0 below `MIN_PD`."""
    return np.where(pd >= MIN_PD, pd, 0.0)


def signal_to_noise(
    rcs: ArrayLike,
    distance: ArrayLike,
    reach: ArrayLike,
    anchor: tuple[float, float],
    attenuation_db_km: float = 0.0,
) -> Floats:
    """Return the mean SNR of a target.

    ``SNR = SNR0 (sigma / sigma0) (R0 / R)^4 10^(-2 gamma R / 10000)``: the radar equation relative
    to an anchor (Skolnik, Introduction to Radar Systems, section 1.2), with the attenuation gamma
    of the air both ways (ITU-R P.838-3 for rain).

    Parameters
    ----------
    rcs : float
        Radar cross section sigma of what is in one resolution cell [m2].
    distance : float
        R [m].
    reach : float
        R0 in the direction of the target: there a target of the reference RCS has SNR0 [m]. The
        antenna's gain is in it: Bosch states R0 by azimuth times a scale by elevation.
    anchor : (float, float)
        SNR0, and the reference RCS sigma0 [m2].
    attenuation_db_km : float
        gamma [dB/km].
    """
    snr0, sigma0 = anchor
    far = np.asarray(distance, dtype=float)
    share = np.asarray(reach, dtype=float) / far
    squared = share * share
    snr = snr0 / sigma0 * np.asarray(rcs, dtype=float) * squared * squared
    if attenuation_db_km:
        snr = snr * np.exp(-math.log(10.0) * 2.0 * attenuation_db_km / 10_000.0 * far)
    return np.asarray(snr)
