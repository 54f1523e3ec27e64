"""``python -m benchmarks.requirement_searches``: does a search end with all requirements met?

A shuttle with a LiDAR at each of its four corners and a camera on each side, 12 design variables
and nine presets, of which the start breaks some. Each seed is a whole `OptimizeJob` with
``requirements = true`` in a process of its own, and leaves a JSON file of its own; what is there
already is not run again, so it may be broken off at any time. Then come the table (in
benchmarks/README.md, by `make bench`) and what docs/requirements.md says.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import pe_core as pe
import pe_tools as pt
from pe_core.study import requirement_file

from .requirement_rows import NINE as BENCHED

ROOT = Path(__file__).resolve().parent.parent
RUNS = ROOT / "build" / "requirement_searches"
SUMMARY = Path(__file__).with_name("requirement_searches.json")
SEEDS = 10
EVALUATIONS = 200
SAMPLES = 4096
NINE = (*BENCHED[:-1], "park_aid_rear")
"""Those of `requirement_rows`, with a park aid instead of blind ground all round."""
LIMIT_S = 90.0
"""Processor time in which a search is to be done, start and result on all voxels included: the
clock depends on what else runs."""
CORNERS = {
    "front_left": (1, 1),
    "front_right": (1, -1),
    "rear_left": (-1, 1),
    "rear_right": (-1, -1),
}
"""Signs of x and y of the LiDARs."""
PITCH_DEG = (-5.0, 60.0)
HEIGHTS_M = (0.4, 2.4)
"""Bounds of all sensors."""
SIDES = {"ahead": (1, 0), "left": (0, 1), "behind": (-1, 0), "right": (0, -1)}
"""Directions in which the cameras look."""

Json = dict[str, Any]


def shuttle() -> pe.Study:
    """The four-corner shuttle: its LiDARs and cameras are level, which breaks requirements."""
    body = pe.load_study(ROOT / "blend_assets" / "examples" / "four_corners" / "study.toml")
    assert body.vehicle is not None
    _, (x, y, _) = (w.tolist() for w in body.vehicle.bounds)
    lidar = pe.catalog.load("Velodyne VLP-16 Puck")
    camera = pe.catalog.load("Camera 120 deg")
    sensors = []
    for name, (ahead, left) in CORNERS.items():
        place = (x + 0.06) * ahead, (y + 0.06) * left, 2.2
        sensors.append(pe.Sensor(name, lidar, pe.Pose(place)))
    for name, (ahead, left) in SIDES.items():
        place = (x + 0.03) * ahead, (y + 0.03) * left, 2.2
        yaw = math.degrees(math.atan2(left, ahead))
        sensors.append(pe.Sensor(name, camera, pe.Pose.from_degrees(place, (0, 0, yaw))))
    free = dict.fromkeys(CORNERS, ("z",)) | dict.fromkeys(SIDES, ("z", "pitch"))
    low, high = (math.radians(v) for v in PITCH_DEG)
    limits = {name: {"z": HEIGHTS_M} for name in CORNERS}
    limits |= {name: {"z": HEIGHTS_M, "pitch": (low, high)} for name in SIDES}
    presets = requirement_file.presets()
    return pe.Study(
        pe.Rig(sensors),
        body.vehicle,
        body.space,
        body.prior,
        requirements=[presets[name].requirement() for name in NINE],
        search=pe.Search(free=free, limits=limits, samples=SAMPLES, evaluations=EVALUATIONS),
        limits=pe.Limits(requirements=True),
    )


def run(seed: int) -> Json:
    """Search from the start with a seed; return what was found, and what it took."""
    study = shuttle()
    began = time.monotonic()
    used = _processor_s()
    job = pt.OptimizeJob(replace(study, search=replace(study.search, seed=seed)))
    first = None
    for _ in job:
        if first is None and job.history and job.history[-1].value.is_feasible:
            first = job.history[-1].evaluation
    outcome = job.outcome
    return {
        "seed": seed,
        "broken_at_start": [v.name for v in study.verdicts() if not v.met],
        "broken": [v.name for v in outcome.verdicts if not v.met],
        "feasible_from": first,
        "evaluations": outcome.evaluations,
        "entropy": outcome.after.entropy,
        "wall_s": time.monotonic() - began,
        "processor_s": _processor_s() - used,
        "placements": pt.result_dict(outcome)["placements"]["after"],
    }


def _processor_s() -> float:
    """Processor time of this process and of its workers that have ended [s]."""
    own, others = (
        resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return own.ru_utime + own.ru_stime + others.ru_utime + others.ru_stime


def main(arguments: list[str]) -> int:
    """Run what is missing, then put all together."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.requirement_searches")
    parser.add_argument("--seeds", type=int, default=SEEDS, help=f"searches ({SEEDS})")
    parser.add_argument("--runs", type=Path, default=RUNS, help="folder of the runs' files")
    parser.add_argument("--one", type=int, metavar="SEED", help="run one seed, print JSON")
    args = parser.parse_args(arguments)
    if args.one is not None:
        print(json.dumps(run(args.one)))
        return 0
    args.runs.mkdir(parents=True, exist_ok=True)
    shown: list[Json] = []
    for seed in range(args.seeds):
        found = _kept(args.runs / f"{seed}.json", seed)
        shown.append({k: v for k, v in found.items() if k != "placements"})
        SUMMARY.write_text("[\n" + ",\n".join(map(json.dumps, shown)) + "\n]\n", "utf-8")
    print("\n".join(table(shown)))
    return 0 if all(is_kept(each) for each in shown) else 1


def _kept(path: Path, seed: int) -> Json:
    """Return a run from its file; run it in a process of its own first where there is none."""
    if not path.exists():
        command = [sys.executable, "-m", __spec__.name, "--one", str(seed)]
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
        scratch = path.with_suffix(".part")
        scratch.write_text(done.stdout, "utf-8")
        os.replace(scratch, path)
    found: Json = json.loads(path.read_text("utf-8"))
    return found


def is_kept(found: Json) -> bool:
    """Whether a search met all requirements in time."""
    return not found["broken"] and found["processor_s"] <= LIMIT_S


def table_lines() -> list[str]:
    """Return the table of the runs that are kept with the project; none: nothing."""
    return table(json.loads(SUMMARY.read_text("utf-8"))) if SUMMARY.exists() else []


def table(runs: list[Json]) -> list[str]:
    """Return in words and numbers how the searches ended."""
    kept = sum(map(is_kept, runs))
    start = {len(each["broken_at_start"]) for each in runs}
    lines = [
        "Searches of a four-corner shuttle with nine requirements",
        "(`python -m benchmarks.requirement_searches`): a whole `pe optimize`, processor time.",
        "",
        "| seeds | broken at the start | all met within 90 s | first met at placement | of "
        "| longest | median | entropy on the grid |",
        f"|{' --- |' * 8}",
    ]
    firsts = [each["feasible_from"] for each in runs if each["feasible_from"] is not None]
    ends = [each["entropy"] for each in runs]
    cells = [
        str(len(runs)),
        ", ".join(map(str, sorted(start))),
        f"{kept} of {len(runs)}",
        f"{min(firsts)} to {max(firsts)}" if firsts else "never",
        str(max(each["evaluations"] for each in runs)),
        f"{max(each['processor_s'] for each in runs):.0f} s",
        f"{median(each['processor_s'] for each in runs):.0f} s",
        f"{min(ends):.3f} to {max(ends):.3f}",
    ]
    return [*lines, f"| {' | '.join(cells)} |"]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
