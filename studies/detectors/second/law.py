"""``python -m studies.detectors.second.law``: does AP depend on m, or on rows and columns?

``AP = a ln m_w + b`` with ``m_w = rows^(2 w) columns^(2 (1 - w))`` and columns = m / rows is the
paper's curve for w = 0.5. w is fitted to published figures alone; then curves are fitted to the
first plan's design *fixed* and forecast its design *across*.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

import pe_core as pe
from pe_core.base import Floats, Ints, dump_json, write_bytes
from pe_core.sensors.kernels import ObjectView
from pe_core.sensors.lidar.definition import first_of_scene
from pe_core.sensors.lidar.kernel_objects import LidarObjects
from pe_core.sensors.lidar.model import lidar_of
from pe_tools.cli import DONE, Answer, Parser

from ...command import main
from ...results_file import Json, print_progress
from ..analysis import HOLDS, REFUTED, UNDECIDED, mean_ap_of, of_runs, plain_design
from ..placements import Placement, vehicle
from ..plan import ACROSS, EQUAL_M, FIXED, SECOND, Plan, full_plan, full_second_plan
from ..runs import RunFiles, parts_of, runs
from ..scan_curves import BeamCounts, counts_of, fitted_curve
from ..scores import scored_objects

OWN = "docs/validity/own"
PUBLISHED = {
    "trained on it, AP 3D": (0.7015, 0.6696, 0.5987, 0.5524),
    "trained on it, AP BEV": (0.8222, 0.7947, 0.7432, 0.7043),
    "direct transfer, AP 3D": (0.6591, 0.5777, 0.4748, 0.3875),
    "direct transfer, AP BEV": (0.7981, 0.7356, 0.6491, 0.5632),
}
"""PointPillars on KITTI, cars, moderate: 32 rows, 32 with half of the columns, 16, 16 with half.
LiDAR-Distillation (arXiv 2203.14956), weiyithu/LiDAR-Distillation@1c222ca, README."""
PIXELS_TIMES = 4.0
PIXELS_AP = (0.378, 0.404)
"""PETR, V2-99: mAP with 800 x 320 and 1600 x 640 pixels; megvii-research/PETR@052a287, README."""
CAMERAS_BY_RANGE = {
    "GUPNet": (0.2478, 0.0484, 0.0022),
    "DEVIANT": (0.2685, 0.0513, 0.0018),
    "MonoRCNN++": (0.2795, 0.0407, 0.0042),
}
"""AP of vehicles on Waymo val, LEVEL_1, one camera, IoU 0.5: to 30 m, to 50 m, beyond. From logs of
the authors; the third from WACV 2023, table 3."""
RANGES_M = (19.0, 40.0, 61.0)
"""Distances that stand for these rings."""
ROWS_HALVED = (0, 0, 1, 1)
COLUMNS_HALVED = (0, 1, 0, 1)
RMSE_DIGITS = 6
"""Of a fit to four published AP of four digits. Its RMSE is ``|AP0 - AP1 - AP2 + AP3| / 4``, a
multiple of 0.000025: fewer digits would round a tie, 0.00585, as the machine happens to."""
CHOSEN = "trained on it, AP 3D"
"""Our detectors, too, are trained with the rig that they are tested with."""
PAPER_W = 0.5
LABELS = ("paper", "m_w")
LOG_STEP = 0.01
"""ln m_w is rounded to this: the counts of many placements share one axis."""


def published_law(ap: Sequence[float]) -> dict[str, float]:
    """Return w and a of ``AP = a ln m_w + b`` over the four scans, by least squares."""
    halved = np.stack([ROWS_HALVED, COLUMNS_HALVED], axis=1) * -np.log(2.0)
    design = np.column_stack([halved, np.ones(4)])
    (rows, columns, b), *_ = np.linalg.lstsq(design, np.array(ap), rcond=None)
    error = design @ [rows, columns, b] - np.array(ap)
    return {
        "w": round(float(rows / (rows + columns)), 3),
        "a": round(float((rows + columns) / 2.0), 4),
        "rmse": round(float(np.sqrt((error**2).mean())), RMSE_DIGITS),
    }


def camera_law() -> Json:
    """Return a of pixels, and c of range by camera: ``AP = a ln m - c ln R + b``, m ~ 1 / R^2.

    c is of the near two rings: in the far one all are at the floor.
    """
    a = (PIXELS_AP[1] - PIXELS_AP[0]) / np.log(PIXELS_TIMES)
    span = np.log(RANGES_M[1] / RANGES_M[0])
    slopes = {name: (ap[0] - ap[1]) / span for name, ap in CAMERAS_BY_RANGE.items()}
    c = {name: round(float(slope - 2.0 * a), 3) for name, slope in slopes.items()}
    return {"a": round(float(a), 4), "c": c}


def rows_and_beams(rig: pe.Rig, view: ObjectView) -> tuple[Floats, Floats]:
    """Return rows (N,) and beams (N,) that end on objects in traffic, over all LiDARs.

    Rows are channels with a beam on the object; those of two LiDARs are two.
    """
    kernel = LidarObjects(view)
    count = len(view.objects)
    rows = np.zeros(count)
    beams = np.zeros(count)
    for sensor in rig:
        hits = first_of_scene(kernel.crossings(sensor), view.objects.scenes)
        lidar = lidar_of(sensor)
        kept = hits.enter >= lidar.min_range
        channel = hits.beam[kept] // len(lidar.azimuth_steps)
        box = hits.box[kept]
        beams += np.bincount(box, minlength=count)
        pairs = np.unique(box * len(lidar.elevations) + channel)
        rows += np.bincount(pairs // len(lidar.elevations), minlength=count)
    return rows, beams


def weighted(rows: Floats, beams: Floats, w: float) -> Floats:
    """Return m_w (N,); 0 where no beam ends."""
    seen = beams > 0
    m = np.zeros(len(beams))
    log = 2.0 * w * np.log(rows[seen]) + 2.0 * (1.0 - w) * np.log(beams[seen] / rows[seen])
    m[seen] = np.exp(np.round(log / LOG_STEP) * LOG_STEP)
    return m


def weighted_counts(
    plan: Plan, chosen: Sequence[Placement], ws: Sequence[float]
) -> list[dict[str, BeamCounts]]:
    """Return for each w the m_w on the objects of the shipped score's scenes, by class."""
    found: list[dict[str, list[tuple[Floats, Floats]]]] = [{} for _ in ws]
    for number, placement in enumerate(chosen, 1):
        drawn = scored_objects(placement.vehicle, True, plan.statistics.scenes).drawn
        view = ObjectView(drawn.objects, vehicle(placement.vehicle), True)
        rows, beams = rows_and_beams(placement.rig(), view)
        for own, w in zip(found, ws, strict=True):
            m = weighted(rows, beams, w)
            for label, name in enumerate(drawn.objects.class_names):
                of_class = drawn.objects.labels == label
                own.setdefault(name, []).append((m[of_class], drawn.weights[of_class]))
        print_progress(f"[{number}/{len(chosen)}] {placement.name}")
    return [{name: counts_of(rows) for name, rows in own.items()} for own in found]


def forecast(plan: Plan, folder: Path, w: float) -> Json:
    """Return the RMSE of the AP of *across*, forecast by curves that are fitted to *fixed*."""
    results = RunFiles(folder, plan, runs(plan)).read()
    whole = plain_design(plan, [FIXED, ACROSS], results)
    is_across = np.array([p.design == ACROSS for p in whole.chosen])
    fixed = np.flatnonzero(~is_across)
    across = np.flatnonzero(is_across)
    by_w = weighted_counts(plan, whole.chosen, (PAPER_W, w))
    aps = {
        name: plain_design(plan, [FIXED, ACROSS], results, mean_ap_of(name)).samples.ap
        for name in by_w[0]
    }
    data: Json = {"fitted": len(fixed), "judged": len(across)}
    data["classes"] = by_class(by_w, aps, fixed, across)
    data["placements"] = [whole.chosen[k].name for k in across]
    return {**data, "mean": of_mean_ap(data["classes"], plan)}


def arms(plan: Plan, folder: Path, w: float) -> Json | None:
    """Return the forecast of the arms of part 2 from those with the fewest rows; None while open.

    m_w is better when its RMSE of AP by class is lower for each of the other arms, and refuted when
    it is higher for each.
    """
    wanted = parts_of(plan)[EQUAL_M]
    results = RunFiles(folder, plan, wanted).read()
    if len(results) < len(wanted):
        return None
    chosen = of_runs(EQUAL_M, wanted, results).chosen
    by_w = weighted_counts(plan, chosen, (PAPER_W, w))
    aps = {name: of_runs(EQUAL_M, wanted, results, mean_ap_of(name)).samples.ap for name in by_w[0]}
    return judged_arms(plan, chosen, by_w, aps)


def judged_arms(
    plan: Plan,
    chosen: Sequence[Placement],
    by_w: Sequence[Mapping[str, BeamCounts]],
    aps: Mapping[str, Floats],
) -> Json:
    """Return RMSE of AP by class of each forecast arm with the paper's m and with m_w, the verdict.

    `by_w` has the counts with both, `aps` (P,) the AP found, by class.
    """
    first, *others = plan.second.equal_m.rows
    arm = np.array([0 if p.lidar is None else len(p.lidar.elevations) for p in chosen])
    found: Json = {"rows": {}}
    for rows in others:
        parts = by_class(by_w, aps, np.flatnonzero(arm == first), np.flatnonzero(arm == rows))
        errors = {
            label: [e for c in parts.values() for e in c[label]["errors"]] for label in LABELS
        }
        rmse = {k: round(float(np.sqrt(np.mean(np.square(v)))), 4) for k, v in errors.items()}
        found["rows"][str(rows)] = {"rmse": rmse, "classes": parts}
    lower = [row["rmse"]["m_w"] < row["rmse"]["paper"] for row in found["rows"].values()]
    found["verdict"] = HOLDS if all(lower) else UNDECIDED if any(lower) else REFUTED
    return found


def by_class(
    by_w: Sequence[Mapping[str, BeamCounts]], aps: Mapping[str, Floats], fitted: Ints, judged: Ints
) -> Json:
    """Return by class the curves that are fitted to some placements, and the errors at others."""
    found: Json = {}
    for name, ap in aps.items():
        found[name] = {}
        for label, counts in zip(LABELS, by_w, strict=True):
            curve = fitted_curve(counts[name].subset(fitted), ap[fitted])
            error = counts[name].subset(judged).expected_ap(curve) - ap[judged]
            found[name][label] = {
                "a": round(curve.a, 4),
                "b": round(curve.b, 4),
                "rmse": round(float(np.sqrt((error**2).mean())), 4),
                "errors": [round(float(e), 4) for e in error],
            }
    return found


def of_mean_ap(classes: Json, plan: Plan) -> Json:
    """Return the RMSE of mean AP by paper and m_w, and their difference with its interval.

    Percentiles of bootstraps over the placements, 95 %.
    """
    errors = np.array(
        [np.mean([c[label]["errors"] for c in classes.values()], axis=0) for label in LABELS]
    )
    rng = np.random.default_rng(plan.seed)
    count = errors.shape[1]
    drawn = errors[:, rng.integers(0, count, (plan.statistics.resamples, count))]
    less = np.diff(np.sqrt((drawn**2).mean(axis=2)), axis=0)[0]
    rmse = np.sqrt((errors**2).mean(axis=1))
    return {
        "rmse": dict(zip(LABELS, rmse.round(4).tolist(), strict=True)),
        "difference": round(float(rmse[1] - rmse[0]), 4),
        "interval": np.percentile(less, (2.5, 97.5)).round(4).tolist(),
    }


def law(args: argparse.Namespace, folder: Path) -> Answer:
    """Fit w, forecast, write the figures."""
    published = {name: published_law(ap) for name, ap in PUBLISHED.items()}
    w = published[CHOSEN]["w"]
    found = {
        "published": published,
        "w": w,
        "cameras": camera_law(),
        "across": forecast(full_plan(), Path(OWN), w),
        "arms": arms(full_second_plan(), Path(OWN) / SECOND, w),
    }
    write_bytes(folder / "law.json", dump_json(found).encode())
    return dump_json(found), DONE


if __name__ == "__main__":
    parser = Parser(prog="python -m studies.detectors.second.law", description=__doc__)
    parser.add_argument("-o", "--output", metavar="DIR", help="folder for law.json")
    parser.set_defaults(default_folders=(f"{OWN}/second",), quick=False)
    main(parser, law)
