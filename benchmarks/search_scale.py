"""``python -m benchmarks.search_scale``: one search of sixteen sensors on more and more workers.

The search is the default one, with eight LiDARs and eight cameras of the catalogue round the
example's sedan, on the usual grid and number of voxels: with this process alone, with processes,
and with a Dask cluster, its scheduler and its workers on the loopback. All end at the same bits, or
this says so and fails. Measured are evaluations per second, processor time, how many times the mesh
was unpickled, and the bytes that went over the loopback; computed are the bytes of the pickled
payload and of a candidate, and the rate with as many free processors as workers. The figures are
kept in search_scale.json, and the table in search_scale.md.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import platform
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import pe_core as pe
from pe_core.search import Payload, Processes, evaluate_all, send_payload

from .scale_counting import (
    BatchNotes,
    CountedFigure,
    ideal_speedup,
    loopback_bytes,
    processor_s,
    unpickled_by,
)
from .search_problems import SEDAN, sixteen_free

SUMMARY = Path(__file__).with_name("search_scale.json")
TABLE = SUMMARY.with_suffix(".md")
HEAD = (
    "workers",
    "evaluations per second",
    "of the best in this process",
    "with free processors, computed",
    "processor ms a candidate, here",
    "in workers",
    "loopback bytes a candidate",
    "meshes unpickled by each",
    "per second in a batch",
    "load",
)
MODELS = ("Velodyne VLP-16 Puck", "Hesai PandarXT-32 / XT32", "Camera 60 deg", "Camera 120 deg")
"""The first eight sensors take the first two in turn, the others the last two."""
SAMPLES = 65_536
"""Voxels of a candidate on the last level: as by default."""
WARM = 16
"""Candidates that are evaluated on each level before the clock starts."""
BATCH = 32
"""Candidates of one batch, whose rate is measured apart from the search's."""
MAX_LOAD = 4.5
NOT_QUIET = "not told"
"""With a higher load at the end something else ran beside it: rates are not told, the rest is."""
IDLE_S = 2.0
"""The loopback is listened to for so long while a cluster is idle."""

Json = dict[str, Any]


def main(arguments: Sequence[str]) -> int:
    """Search with each kind of workers; print the table, and write it with the figures."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.search_scale", description=__doc__)
    parser.add_argument("--evaluations", type=int, default=400, help="placements a search (400)")
    parser.add_argument("--runs", type=int, default=3, help="searches of each kind of workers (3)")
    parser.add_argument("--only", nargs="+", choices=WORKERS, help="measure these rows again")
    args = parser.parse_args(arguments)
    study = _study()
    known = json.loads(SUMMARY.read_text("utf-8")) if args.only else {"rows": []}
    rows = {row["workers"]: row for row in known["rows"]}
    for name in args.only or WORKERS:
        with WORKERS[name]() as executor:
            rows[name] = {"workers": name, **_measured(study, args, executor)}
        print(json.dumps(rows[name]), flush=True)
    found = {
        "evaluations": args.evaluations,
        **_sizes(study),
        "machine": f"{os.cpu_count()} processors, Python {platform.python_version()}",
        "rows": [rows[name] for name in WORKERS if name in rows],
    }
    lines = table(found)
    print("\n".join(lines))
    SUMMARY.write_text(json.dumps(found, indent=1) + "\n", "utf-8")
    TABLE.write_text("\n".join(lines) + "\n", "utf-8")
    return len({digest for row in found["rows"] for digest in row["digests"]}) - 1


def _study() -> pe.Study:
    """Return the problem of sixteen sensors with the sedan's mesh, models of the catalogue."""
    study = sixteen_free()
    models = [pe.catalog.load(name) for name in MODELS]
    rig = pe.Rig(
        [
            pe.Sensor(sensor.name, models[k % 2 if k < 8 else 2 + k % 2], sensor.pose)
            for k, sensor in enumerate(study.rig)
        ]
    )
    search = replace(study.search, samples=SAMPLES)
    vehicle = pe.load_study(SEDAN).vehicle
    return replace(study, rig=rig, vehicle=vehicle, space=pe.PerceptionSpace(), search=search)


def _measured(study: pe.Study, args: argparse.Namespace, executor: Executor | None) -> Json:
    """Return the figures of several searches with the same workers, and of a batch."""
    idle = _idle_bytes_per_s() if executor is not None else 0.0
    with tempfile.TemporaryDirectory() as folder:
        objectives = [pe.Objective(CountedFigure(folder, each)) for each in _evaluators(study)]
        began = loopback_bytes()
        _send(study, objectives, executor)
        sent = loopback_bytes() - began
        runs = [_run(study, objectives, args.evaluations, executor) for _ in range(args.runs)]
        meshes = [count // len(objectives) for count in unpickled_by(Path(folder))]
        batch = _batch_rate(study, objectives[-1], executor)
    wire = [(run["loopback"] - idle * run["seconds"]) / args.evaluations for run in runs]
    return {
        "rates": [round(args.evaluations / run["seconds"], 2) for run in runs],
        "batch_rate": round(batch, 2),
        "processor_ms_here": [_ms(run["processor"][0], args.evaluations) for run in runs],
        "processor_ms_workers": [_ms(run["processor"][1], args.evaluations) for run in runs],
        "loopback_bytes": [round(each) for each in wire],
        "loopback_bytes_once": sent,
        "loopback_idle_bytes_per_s": round(idle),
        "meshes_by_process": meshes,
        "digests": [run["digest"] for run in runs],
        "batches": runs[0]["batches"],
        "load": round(os.getloadavg()[0], 1),
    }


def _ms(seconds: float, evaluations: int) -> float:
    return round(1e3 * seconds / evaluations, 2)


def _evaluators(study: pe.Study) -> list[pe.Evaluator]:
    return [study.evaluator(samples, 1) for samples in study.level_samples]


def _send(study: pe.Study, objectives: Sequence[Any], executor: Executor | None) -> None:
    """Send the payload, as a job does before its search, and have all workers started."""
    if executor is not None:
        parts = (part for objective in objectives for part in objective.shared_parts())
        send_payload(executor, (*parts, *(sensor.model for sensor in study.rig)))
    for objective in objectives:
        evaluate_all(objective, _moved(study.rig, WARM), executor=executor)


def _run(
    study: pe.Study, objectives: Sequence[Any], evaluations: int, executor: Executor | None
) -> Json:
    """Search once; return its time, what it took, and a digest of all steps."""
    noted = BatchNotes()
    digest = hashlib.sha256()
    before = loopback_bytes()
    used = processor_s()
    begun = time.perf_counter()
    space = study.search_space()
    options: Any = {"evaluations": evaluations, "executor": executor, "journal": noted}
    for step in pe.optimize(objectives, study.rig, space, **options):
        poses = [(s.name, s.pose.position, s.pose.rpy) for s in step.best]
        digest.update(repr((step.entropy, step.evaluations, poses)).encode())
    return {
        "seconds": time.perf_counter() - begun,
        "loopback": loopback_bytes() - before,
        "processor": [after - then for after, then in zip(processor_s(), used, strict=True)],
        "digest": digest.hexdigest()[:12],
        "batches": {str(n): noted.sizes.count(n) for n in sorted(set(noted.sizes))},
    }


def _idle_bytes_per_s() -> float:
    before = loopback_bytes()
    time.sleep(IDLE_S)
    return (loopback_bytes() - before) / IDLE_S


def _batch_rate(study: pe.Study, objective: Any, executor: Executor | None) -> float:
    """Return how many candidates of one batch are evaluated per second, all sensors moved."""
    rigs = _moved(study.rig, BATCH)
    begun = time.perf_counter()
    evaluate_all(objective, rigs, executor=executor)
    return BATCH / (time.perf_counter() - begun)


def _moved(rig: pe.Rig, count: int) -> list[pe.Rig]:
    """Return rigs of which each has all sensors 1 cm farther ahead than the one before."""
    places = [(sensor.pose.position, sensor.pose.rpy) for sensor in rig]
    return [
        rig.with_poses([pe.Pose((x + 0.01 * k, y, z), rpy) for (x, y, z), rpy in places])
        for k in range(count)
    ]


def _sizes(study: pe.Study) -> Json:
    """Return the pickled bytes that are sent once to each worker, and with each candidate."""
    objectives = _evaluators(study)
    payload = Payload((*objectives, *(sensor.model for sensor in study.rig)))
    return {
        "bytes_once": len(payload.packed.data),
        "bytes_each": len(payload.pickled((objectives[-1], study.rig))),
        "bytes_answer": len(Payload((1.0,)).packed.data),
    }


@contextmanager
def _none() -> Iterator[None]:
    yield None


@contextmanager
def _processes(count: int) -> Iterator[Executor]:
    pool = Processes(count)
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


@contextmanager
def _cluster(count: int) -> Iterator[Executor]:
    """Yield a cluster's executor."""
    from distributed import Client, LocalCluster

    options: dict[str, Any] = {"host": "127.0.0.1", "dashboard_address": None}
    with (
        LocalCluster(n_workers=count, threads_per_worker=1, processes=True, **options) as cluster,
        Client(cluster) as client,
    ):
        client.wait_for_workers(count)
        yield client.get_executor(pure=False)


WORKERS: dict[str, Callable[[], Any]] = {
    "this process": _none,
    "1 process": lambda: _processes(1),
    "2 processes": lambda: _processes(2),
    "4 processes": lambda: _processes(4),
    "Dask, 1 worker": lambda: _cluster(1),
    "Dask, 2 workers": lambda: _cluster(2),
    "Dask, 4 workers": lambda: _cluster(4),
}


def table(found: Json) -> list[str]:
    """Return the table of a summary, with what its columns mean."""
    first = max(found["rows"][0]["rates"])
    same = len({digest for row in found["rows"] for digest in row["digests"]}) == 1
    lines = [
        "# One search of sixteen sensors on more and more workers",
        "",
        f"The default search, {found['evaluations']} placements, eight LiDARs and eight cameras",
        f"round the example's sedan; medians of {len(found['rows'][0]['rates'])} searches.",
        "`python -m benchmarks.search_scale` writes this, and search_scale.json.",
        "",
        f"| {' | '.join(HEAD)} |",
        f"|{' --- |' * len(HEAD)}",
    ]
    lines += [f"| {' | '.join(_cells(row, first))} |" for row in found["rows"]]
    return [
        *lines,
        "",
        f"Steps: {'the same bits in all searches' if same else 'NOT the same in all searches'}.",
        "",
        f"Pickled: {found['bytes_once']:,} bytes once to each worker (mesh, space, prior, voxels,",
        f"models), {found['bytes_each']:,} bytes with each candidate, {found['bytes_answer']} with",
        "its answer. In a batch all sixteen sensors of each candidate have moved.",
        "",
        f"The search asked for {_asked(found['rows'][-1]['batches'])} candidates at once, in the",
        f"mean. With a load above {MAX_LOAD:g} something else ran beside: no rates by the clock.",
        f'On {found["machine"]}: four workers share two of them. "Computed" is no measurement.',
    ]


def _asked(batches: dict[str, int]) -> str:
    """Return the mean size of a batch."""
    count = sum(batches.values())
    return f"{sum(int(size) * times for size, times in batches.items()) / count:.1f}"


def _cells(row: Json, first: float) -> list[str]:
    rate = median(row["rates"])
    name = row["workers"]
    here = median(row["processor_ms_here"])
    there = median(row["processor_ms_workers"])
    meshes = ", ".join(map(str, row["meshes_by_process"]))
    quiet = row["load"] <= MAX_LOAD
    return [
        name,
        f"{rate:.1f} ({min(row['rates']):.1f} to {max(row['rates']):.1f})" if quiet else NOT_QUIET,
        f"{rate / first:.2f}" if quiet else "",
        f"{_computed_rate(row):.1f}" if there else "",
        f"{here:.1f}",
        f"{there:.1f}" if there else "",
        f"{median(row['loopback_bytes']):,.0f}" if "Dask" in name else "",
        meshes,
        f"{row['batch_rate']:.1f}" if quiet else "",
        f"{row['load']:g}",
    ]


def _computed_rate(row: Json) -> float:
    """Return the evaluations per second if each worker had a processor of its own: computed.

    The time of a candidate is the processor time here, and that of the workers divided by how much
    sooner batches of the search's sizes end with so many.
    """
    count = int(next(word for word in row["workers"].split() if word.isdigit()))
    sizes = [int(size) for size, times in row["batches"].items() for _ in range(times)]
    here = median(row["processor_ms_here"])
    there = median(row["processor_ms_workers"])
    return 1e3 / (here + there / ideal_speedup(sizes, count))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
