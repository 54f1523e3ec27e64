"""The camera curve: AP = a ln m + b, fitted to the family of one rig and judged on the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache

import numpy as np

import pe_core as pe
from pe_core.base import Floats, Ints
from pe_core.metric import RTM3D
from pe_core.sensors.camera import CAMERA

from ..detectors.scan_curves import A_BOUNDS, B_BOUNDS, BeamCounts, counts_of, fitted_curve
from ..ranks import SAME, bca_limits
from ..results_file import Json
from .published_rigs import FAMILY, JUDGED, PublishedRigs, positions_of
from .scores import CLASS_OF, CURVES, CameraEffort
from .statements import HOLDS, REFUTED, UNDECIDED, beside

SPAN = (0.05, 0.95)
"""Quantiles of m, over the family's objects, between which a curve is trusted."""
OPPOSITE = {HOLDS: REFUTED, REFUTED: HOLDS, UNDECIDED: UNDECIDED}
PAPER = "paper"
MEAN = "mean"


def camera_curves(rigs: PublishedRigs, pixels: Mapping[str, Json], effort: CameraEffort) -> Json:
    """Return by class the fitted curve, its errors beside its rivals', and the verdicts.

    `pixels` has m and weights of the objects that are seen, by rig and outcome.
    """
    found: Json = {}
    for outcome in CURVES:
        rows = [by_outcome[outcome] for by_outcome in pixels.values()]
        counts = counts_of([(np.array(r["m"]), np.array(r["weights"])) for r in rows])
        found[outcome] = _of_class(counts, rigs.ap(outcome), CLASS_OF[outcome], effort)
    return found


def centred_rmse(errors: Floats) -> Floats:
    """Return the RMSE (...) of errors (..., R) after their mean is taken off."""
    off = errors - errors.mean(axis=-1, keepdims=True)
    return np.asarray(np.sqrt((off**2).mean(axis=-1)))


def _of_class(counts: BeamCounts, ap: Floats, name: str, effort: CameraEffort) -> Json:
    family, judged = (positions_of(part) for part in (FAMILY, JUDGED))
    of_family = counts.subset(np.array(family))
    exact = fitted_curve(of_family, ap[family])
    fitted = pe.ApCurve(round(exact.a, 4), round(exact.b, 4))
    shipped = CAMERA.object_curves[name]
    of_judged = counts.subset(np.array(judged))
    expected = {
        "fitted": of_judged.expected_ap(fitted),
        PAPER: of_judged.expected_ap(shipped),
        MEAN: np.full(len(judged), ap[family].mean()),
    }
    errors = {key: values - ap[judged] for key, values in expected.items()}
    row: Json = {
        "a": fitted.a,
        "b": fitted.b,
        "paper": {"a": shipped.a, "b": shipped.b},
        "m": spanned(of_family),
        **_slope(of_family, ap[family], exact, effort),
        "rmse": {key: round(float(centred_rmse(own)), 4) for key, own in errors.items()},
        "plain_rmse": {
            key: round(float(np.sqrt((own**2).mean())), 4) for key, own in errors.items()
        },
    }
    for rival in (PAPER, MEAN):
        less, limits = difference_of(errors["fitted"], errors[rival], effort)
        row[f"minus_{rival}"] = {"difference": round(less, 4), "interval": _rounded(limits)}
    row["verdicts"] = {
        "7": OPPOSITE[beside(row["minus_paper"]["interval"], 0.0)],
        "8": OPPOSITE[beside(row["minus_mean"]["interval"], 0.0)],
        "9": beside(row["a_interval"], RTM3D.a),
    }
    return row


def difference_of(
    errors: Floats, others: Floats, effort: CameraEffort
) -> tuple[float, Sequence[float]]:
    """Return the centred RMSE of errors (R,) minus that of others, and its BCa interval."""

    def less(index: Ints) -> Floats:
        return centred_rmse(errors[index]) - centred_rmse(others[index])

    return _with_limits(less, len(errors), effort)


def _with_limits(
    statistic: Callable[[Ints], Floats], count: int, effort: CameraEffort
) -> tuple[float, Sequence[float]]:
    """Return a statistic of rigs, given by index (..., R), and its BCa interval over the rigs."""
    every = np.arange(count)
    drawn = np.random.default_rng([effort.seed, 5]).integers(0, count, (effort.resamples, count))
    value = float(statistic(every))
    left_out = np.array([float(statistic(np.delete(every, k))) for k in every])
    return value, bca_limits(value, statistic(drawn), left_out)


def _slope(counts: BeamCounts, ap: Floats, fitted: pe.ApCurve, effort: CameraEffort) -> Json:
    """Return the interval of a, and how many bootstraps end at a bound of the fit."""
    at_bound: list[bool] = []

    @cache
    def of(chosen: tuple[int, ...]) -> pe.ApCurve:
        index = np.array(chosen)
        return fitted_curve(BeamCounts(counts.m, counts.shares[index]), ap[index], fitted)

    def slopes(index: Ints) -> Floats:
        if index.ndim == 1:
            return np.asarray(of(tuple(index.tolist())).a)
        curves = [of(tuple(sorted(own))) for own in index.tolist()]  # 462 differ
        at_bound.extend(is_at_bound(curve) for curve in curves)
        return np.array([curve.a for curve in curves])

    _, limits = _with_limits(slopes, len(ap), effort)
    return {"a_interval": _rounded(limits), "at_bound": sum(at_bound)}


def is_at_bound(curve: pe.ApCurve) -> bool:
    """Whether a fit has ended at one of its bounds."""
    ends = [(curve.a, end) for end in A_BOUNDS] + [(curve.b, end) for end in B_BOUNDS]
    return any(abs(value - end) <= SAME for value, end in ends)


def spanned(counts: BeamCounts) -> list[float]:
    """Return the quantiles `SPAN` of m over the objects of all rigs together."""
    cumulated = np.cumsum(counts.shares.mean(axis=0))
    last = len(counts.m) - 1
    return [round(float(counts.m[min(int(k), last)]), 1) for k in np.searchsorted(cumulated, SPAN)]


def _rounded(values: Sequence[float]) -> list[float]:
    return [round(float(value), 4) for value in values]
