"""AP curves of whole objects, fitted to our own detector: `[ap] model = "scans"`.

The plan: a and b of each class are fitted so that expected AP in traffic has the AP of the
placements with odd numbers of the fixed design; the error is judged on those with even numbers.
"""

from __future__ import annotations

import datetime
import itertools
import os
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pe_core as pe
from pe_core import InputError
from pe_core.base import Floats, Ints, decode_text, dumps, read_bytes, require_new, write_bytes
from pe_core.metric import AP_MAX, AP_MIN, average_precision
from pe_core.metric.fusion import early_fusion
from pe_core.sensors import ObjectMeasurementCache
from pe_core.sensors.lidar import LIDAR

from ..ranks import PlacementSamples, resamples
from ..results_file import Json
from .analysis import Results, mean_ap_of, plain_design
from .placements import Placement, vehicle
from .plan import FIXED, Plan
from .scores import scored_objects

A_BOUNDS = (0.001, 1.0)
B_BOUNDS = (-4.0, 1.5)
"""Bounds of the fit. A curve at a bound is reported as such by its figures."""
STARTS = 25
"""Values of a and of b that are tried before the descent."""
MAX_STEPS = 200
DAMPING = 1e-6
SMALLEST = 1e-6
"""Of the descent: steps, damping at first, and a step that ends it; figures have four decimals."""
TINY = 1e-12
"""Keeps the equations of a step solvable where no object changes its AP."""
MAX_RESAMPLES = 1000
"""Bootstraps of the intervals: each one is a fit."""
MIN_HALF = 4
"""Fewer placements in a half give no figures."""
SOURCE = "docs/validity/own: the study's detector at the odd placements of its fixed design"
HEAD = """\
# AP curves of LiDARs' objects for `[ap] model = "scans"`: AP = a ln m + b, m the number of beams.
# Written by `python -m studies.detectors --page-only --curves FILE`; do not edit it.

"""


@dataclass(frozen=True, eq=False)
class BeamCounts:
    """How many beams end on the objects of a class at each of several placements, in traffic.

    `m` (K,) are the numbers of beams of all LiDARs that occur, `shares` (P, K) the share of the
    class's objects with each, by placement; each row sums to 1.
    """

    m: Floats
    shares: Floats

    def expected_ap(self, curve: pe.ApCurve) -> Floats:
        """Return the expected AP (P,) of the class at each placement."""
        return np.asarray(self.shares @ average_precision(self.m, curve))

    def subset(self, index: Ints) -> BeamCounts:
        """Return some of the placements, without numbers of beams that none of them has."""
        shares = self.shares[index]
        kept = shares.any(axis=0)
        return BeamCounts(self.m[kept], shares[:, kept])


def beam_counts(plan: Plan, chosen: Sequence[Placement]) -> dict[str, BeamCounts]:
    """Return how many beams end on the objects of the shipped score's scenes, by class."""
    found: dict[str, list[tuple[Floats, Floats]]] = {}
    for name in plan.vehicles:
        drawn = scored_objects(name, True, plan.statistics.scenes).drawn
        cache = ObjectMeasurementCache(drawn.objects, vehicle(name), True)
        for placement in (p for p in chosen if p.vehicle == name):
            m = early_fusion(list(cache.measure(placement.rig()).values()))
            for label, of_class in enumerate(drawn.objects.class_names):
                rows = drawn.objects.labels == label
                found.setdefault(of_class, []).append((m[rows], drawn.weights[rows]))
    order = [k for name in plan.vehicles for k, p in enumerate(chosen) if p.vehicle == name]
    back = np.argsort(order)
    return {name: counts_of([rows[k] for k in back]) for name, rows in found.items()}


def counts_of(by_placement: Sequence[tuple[Floats, Floats]]) -> BeamCounts:
    m = np.unique(np.concatenate([each for each, _ in by_placement]))
    shares = [
        np.bincount(np.searchsorted(m, each), weights, len(m)) / weights.sum()
        for each, weights in by_placement
    ]
    return BeamCounts(m, np.array(shares))


def fitted_curve(beams: BeamCounts, ap: Floats, start: pe.ApCurve | None = None) -> pe.ApCurve:
    """Return the curve whose expected AP is nearest to the AP found: least squares.

    A coarse grid gives the start; damped Gauss-Newton steps descend from there within `A_BOUNDS`
    and `B_BOUNDS` (Levenberg and Marquardt), until a step is below `SMALLEST`, or until only one
    of a and b can be told. `ap` is the AP found at each placement (P,); `start` takes the place of
    the grid.
    """
    grid = itertools.product(np.geomspace(0.005, 0.4, STARTS), np.linspace(-1.5, 1.0, STARTS))
    start = start or min(
        (pe.ApCurve(float(a), float(b)) for a, b in grid), key=lambda c: _square(beams, ap, c)
    )
    at = np.array([start.a, start.b])
    damping = DAMPING
    logs = np.log(np.maximum(beams.m, 1.0))
    error = _square(beams, ap, start)
    for _ in range(MAX_STEPS):
        curve = pe.ApCurve(*at)
        of_m = average_precision(beams.m, curve)
        free = ((of_m > AP_MIN) & (of_m < AP_MAX)).astype(float)
        slopes = np.stack([beams.shares @ (free * logs), beams.shares @ free], axis=1)
        square = slopes.T @ slopes
        damped = square + damping * (np.diag(np.diag(square)) + TINY * np.eye(2))
        try:
            step = np.linalg.solve(damped, slopes.T @ (ap - beams.shares @ of_m))
        except np.linalg.LinAlgError:  # objects of one m alone, and no damping left
            break
        there = np.clip(at + step, *np.transpose([A_BOUNDS, B_BOUNDS]))
        if np.abs(there - at).max() < SMALLEST:
            break
        now = _square(beams, ap, pe.ApCurve(*there))
        better = now < error
        damping = damping / 10.0 if better else damping * 10.0
        if better:
            at = there
            error = now
    return pe.ApCurve(*map(float, at))


def _square(beams: BeamCounts, ap: Floats, curve: pe.ApCurve) -> float:
    return float(((beams.expected_ap(curve) - ap) ** 2).sum())


def scan_curves(plan: Plan, results: Results) -> Json:
    """Return the curves of all classes with their errors, as JSON data."""
    whole = plain_design(plan, [FIXED], results)
    chosen = whole.chosen
    numbers = np.array([int(p.name.rsplit("-", 1)[1]) for p in chosen], np.int64)
    odd, even = (np.flatnonzero(numbers % 2 == rest) for rest in (1, 0))
    found: Json = {"done": whole.done, "planned": whole.planned}
    found |= {"fitted": len(odd), "judged": len(even), "classes": {}}
    if min(len(odd), len(even)) < MIN_HALF:
        return found
    found["seeds"] = whole.samples.aps.shape[1]
    classes = {}
    for name, beams in beam_counts(plan, chosen).items():
        samples = plain_design(plan, [FIXED], results, mean_ap_of(name)).samples
        classes[name] = _of_class(plan, name, beams, samples, odd=odd, even=even)
    return {**found, "placements": [chosen[k].name for k in even], "classes": classes}


def _of_class(
    plan: Plan, name: str, beams: BeamCounts, samples: PlacementSamples, odd: Ints, even: Ints
) -> Json:
    shipped = LIDAR.object_curves[name]
    fitted = beams.subset(odd)
    judged = beams.subset(even)
    of_odd = samples.ap[odd]
    of_even = samples.ap[even]
    exact = fitted_curve(fitted, of_odd)  # errors are those of what a file has
    own = pe.ApCurve(round(exact.a, 4), round(exact.b, 4))
    before = judged.expected_ap(shipped)
    after = judged.expected_ap(own)
    return {
        **_written(own),
        **_intervals(plan, fitted, judged, samples, odd=odd, even=even, own=own),
        "shipped": _written(shipped),
        "rmse": {
            "fitted": [_rmse(fitted.expected_ap(c), of_odd) for c in (shipped, own)],
            "judged": [_rmse(expected, of_even) for expected in (before, after)],
            "judged_by_mean": _rmse(np.full(len(even), of_odd.mean()), of_even),
        },
        "found": _rows(of_even),
        "expected": {"shipped": _rows(before), "scans": _rows(after)},
    }


def _intervals(
    plan: Plan,
    fitted: BeamCounts,
    judged: BeamCounts,
    samples: PlacementSamples,
    odd: Ints,
    even: Ints,
    own: pe.ApCurve,
) -> Json:
    """Return intervals of a, b and the error judged: placements and seeds are drawn again."""
    curves = list[tuple[float, float]]()
    errors = list[float]()
    rule = plan.statistics.but(resamples=min(plan.statistics.resamples, MAX_RESAMPLES))
    parts = (resamples(samples.subset(half), rule, plan.seed) for half in (odd, even))
    for of_odd, of_even in zip(*parts, strict=True):
        draws = zip(of_odd.index, of_odd.ap, of_even.index, of_even.ap, strict=True)
        for index, ap, other, other_ap in draws:
            curve = fitted_curve(BeamCounts(fitted.m, fitted.shares[index]), ap, own)
            curves.append((curve.a, curve.b))
            errors.append(_rmse(judged.expected_ap(curve)[other], other_ap))
    a, b = np.percentile(np.array(curves), [2.5, 97.5], axis=0).T
    error = np.percentile(errors, [2.5, 97.5])
    return {"a_interval": _rows(a), "b_interval": _rows(b), "rmse_interval": _rows(error)}


def _rmse(expected: Floats, found: Floats) -> float:
    return round(float(np.sqrt(((expected - found) ** 2).mean())), 4)


def _rows(values: Floats) -> list[float]:
    return [round(float(v), 4) for v in values]


def _written(curve: pe.ApCurve) -> Json:
    return {"a": round(curve.a, 4), "b": round(curve.b, 4)}


def curves_text(found: Json, date: str) -> str:
    """Return the file, TOML, from the results of `scan_curves` and the day of the fit."""
    head = {
        "source": SOURCE,
        "date": date,
        "runs": found["done"],
        "planned": found["planned"],
        "complete": found["done"] == found["planned"],
    }
    curves = {n: {"a": row["a"], "b": row["b"]} for n, row in found["classes"].items()}
    return HEAD + dumps({**head, "curves": {LIDAR.name: curves}})


def write_curves(path: Path, found: Json) -> None:
    """Write the file; its date stays where nothing else has changed.

    Too few runs for a fit, or another file at the path, are an `InputError`.
    """
    if not found["classes"]:
        state = f"{found['done']} of {found['planned']}"
        raise InputError(path, "curves", "enough runs of the fixed design for a fit", state)
    if os.path.lexists(path):
        before = decode_text(read_bytes(path))
        if not before.startswith(HEAD):
            require_new(path, replace=False)
        if before == curves_text(found, date_of(before)):
            return
    write_bytes(path, curves_text(found, datetime.date.today().isoformat()).encode())


def date_of(text: str) -> str:
    """Return the date of a file of curves."""
    return str(tomllib.loads(text)["date"])
