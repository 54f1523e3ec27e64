"""Detection by a radar: RCS of classes at 77 to 79 GHz, SNR of a target, and its probability.

Powers are ratios, not dB, unless a name ends in `_db`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...base.arrays import Floats
from ...base.errors import InputError, shown
from ...base.values import A_NAME, Number, listed

MIN_PD = 0.1  # A resolution cell that is detected more rarely than this does not count
DBSM = Number(-60.0, 80.0, unit="dBsm")
ASPECT_DEG = Number(0.0, 180.0, unit="degrees", noun="angle")
MEDIAN_DBSM = {
    "pedestrian": -11.1,
    "bicycle": -5.0,
    "cyclist": -5.0,
    "motorcycle": 0.0,
    "car": 7.0,
    "bus": 12.0,
    "truck": 15.0,
}
"""Medians of measurements at 77 to 79 GHz [dBsm], as surveys quote them. A cyclist is taken as the
bicycle."""
SPREAD_DB = 9.6
"""How far below its median the RCS is that 95 % of the measurements exceed: a pedestrian's is
within -20.7 to -4.8 dBsm in 90 % of them. Of other classes no spread was found: this is taken."""
LOW_DBSM = {name: round(level - SPREAD_DB, 1) for name, level in MEDIAN_DBSM.items()}
"""What 95 % of the measurements exceed [dBsm]."""
UNKNOWN_DBSM = MEDIAN_DBSM["pedestrian"]
"""Of a class without a figure: the weakest of the table, on the safe side."""
NO_ECHO = -math.inf  # Of a class without a figure to a requirement [dBsm]


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

    `rcs`: Radar cross section sigma of what is in one resolution cell [m2].
    `distance`: R [m].
    `reach`: R0 in the direction of the target: there a target of the reference RCS has SNR0 [m].
        The antenna's gain is in it: Bosch states R0 by azimuth times a scale by elevation.
    `anchor` (float, float): SNR0, and the reference RCS sigma0 [m2].
    `attenuation_db_km`: gamma [dB/km].
    """
    snr0, sigma0 = anchor
    far = np.asarray(distance, dtype=float)
    share = np.asarray(reach, dtype=float) / far
    squared = share * share
    snr = snr0 / sigma0 * np.asarray(rcs, dtype=float) * squared * squared
    if attenuation_db_km:
        snr = snr * np.exp(-math.log(10.0) * 2.0 * attenuation_db_km / 10_000.0 * far)
    return np.asarray(snr)


@dataclass(frozen=True)
class Reflectivity:
    """RCS of one class by aspect.

    `dbsm`: RCS [dBsm].
    `aspects`: Angle between the object's heading and the direction from the object to the radar,
        ascending, 0 to 180 degrees: 0 is its front [rad]. One angle for all aspects.
    """

    dbsm: tuple[float, ...]
    aspects: tuple[float, ...] = (0.0,)

    def square_metres(self, aspect: Floats) -> Floats:
        """Return the RCS [m2] at aspects (N,) [rad]; dB are interpolated."""
        if len(self.dbsm) == 1:
            return np.full(len(aspect), 10.0 ** (self.dbsm[0] / 10.0))
        return np.asarray(10.0 ** (np.interp(aspect, self.aspects, self.dbsm) / 10.0))


def reflectivity_of(name: str, own: Mapping[str, Reflectivity]) -> Reflectivity:
    """Return the RCS of a class: the sensor's own figure, that of the table, or the weakest."""
    return own.get(name) or Reflectivity((MEDIAN_DBSM.get(name, UNKNOWN_DBSM),))


def cautious_reflectivity(name: str, own: Mapping[str, Reflectivity]) -> Reflectivity:
    """Return the RCS of a class to a requirement: what 95 % of the measurements exceed, or the
    sensor's own figure where that is less. A class that is not in the table has the sensor's own
    figure. Without one it sends no echo: nobody knows its RCS."""
    most = LOW_DBSM.get(name, math.inf)
    found = own.get(name) or Reflectivity((LOW_DBSM.get(name, NO_ECHO),))
    return Reflectivity(tuple(min(level, most) for level in found.dbsm), found.aspects)


def read_reflectivity(source: str, tables: Any) -> dict[str, Reflectivity]:
    """Return RCS by class from ``rcs_dbsm = { car = 7, van = { aspect_deg = [], dbsm = [] } }``.
    `InputError` when it is no table, or angles do not ascend."""
    if not isinstance(tables, Mapping):
        raise InputError(source, "rcs_dbsm", "a table of classes", shown(tables))
    return {
        A_NAME.checked(source, "rcs_dbsm", name): _read_one(source, f"rcs_dbsm.{name}", value)
        for name, value in tables.items()
    }


def _read_one(source: str, field: str, value: Any) -> Reflectivity:
    if not isinstance(value, Mapping):
        return Reflectivity((DBSM.checked(source, field, value),))
    if set(value) != {"aspect_deg", "dbsm"}:
        raise InputError(source, field, "a number, or aspect_deg and dbsm", shown(dict(value)))
    angles, levels = (_listed(source, f"{field}.{k}", value[k]) for k in ("aspect_deg", "dbsm"))
    degrees = [ASPECT_DEG.checked(source, f"{field}.aspect_deg", a) for a in angles]
    if sorted(set(degrees)) != degrees or len(degrees) != len(levels):
        expected = f"{len(levels)} ascending angles, one for each of dbsm"
        raise InputError(source, f"{field}.aspect_deg", expected, shown(angles))
    dbsm = tuple(DBSM.checked(source, f"{field}.dbsm", v) for v in levels)
    return Reflectivity(dbsm, tuple(math.radians(d) for d in degrees))


def _listed(source: str, field: str, value: Any) -> list[Any]:
    if not (values := listed(value)):
        raise InputError(source, field, "a list of numbers", shown(value))
    return values


def write_reflectivity(own: Mapping[str, Reflectivity]) -> dict[str, Any]:
    """Return the table that `read_reflectivity` reads."""
    return {
        name: each.dbsm[0]
        if len(each.dbsm) == 1
        else {
            "aspect_deg": [round(math.degrees(a), 9) for a in each.aspects],
            "dbsm": list(each.dbsm),
        }
        for name, each in own.items()
    }
