"""``python -m benchmarks.search_scale``: one search of sixteen sensors on more and more workers.

The search is the default one, round the example's sedan: with this process alone, with two and
four processes, and with a Dask cluster of four workers and its scheduler on the loopback. All end
at the same bits, or this says so and fails. Told are evaluations per second, the bytes that go out
once to each worker (mesh, space, prior, models), and the bytes of each candidate.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pe_core as pe
from pe_core.search import Payload, Processes, evaluate_all

from .search_problems import SEDAN, sixteen_free

HEAD = ["workers", "evaluations per second", "of one process", "steps"]
BATCH = 48
"""Candidates of one batch, whose rate is measured apart from the search's."""


def main(arguments: Sequence[str]) -> int:
    """Search with each kind of workers; print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.search_scale", description=__doc__)
    parser.add_argument("--evaluations", type=int, default=400, help="placements a search (400)")
    args = parser.parse_args(arguments)
    study, rows, first = _study(), [], 0.0
    print(_bytes_line(study), flush=True)
    for name, workers in WORKERS.items():
        with workers() as executor:
            rate, digest = _rate(study, args.evaluations, executor)
            batch = _batch_rate(study, executor)
        first = first or rate
        rows.append((name, f"{rate:.1f}", f"{rate / first:.2f}", digest, f"{batch:.1f}"))
        print(f"{name}: {rate:.1f}/s in the search, {batch:.1f}/s in a batch, {digest}", flush=True)
    print("\n".join(_table(rows)))
    return len({digest for _, _, _, digest, _ in rows}) - 1


def _study() -> pe.Study:
    """Return the problem of sixteen sensors, with the mesh of the example's sedan."""
    return replace(sixteen_free(), vehicle=pe.load_study(SEDAN).vehicle)


def _rate(study: pe.Study, evaluations: int, executor: Executor | None) -> tuple[float, str]:
    """Search; return the evaluations per second, and a digest of all steps."""
    levels = pe.METHODS[study.search.method].samples(study.search.samples)
    objectives = [study.evaluator(samples) for samples in levels]
    evaluate_all(objectives[-1], [study.rig], executor=executor)  # workers have it all now
    evaluate_all(objectives[0], [study.rig], executor=executor)
    digest, begun = hashlib.sha256(), time.perf_counter()
    space, count = study.search_space(), 0
    for step in pe.optimize(
        objectives, study.rig, space, evaluations=evaluations, executor=executor
    ):
        poses = [(s.name, s.pose.position, s.pose.rpy) for s in step.best]
        digest.update(repr((step.entropy, step.evaluations, poses)).encode())
        count = step.evaluations
    return count / (time.perf_counter() - begun), digest.hexdigest()[:12]


def _batch_rate(study: pe.Study, executor: Executor | None) -> float:
    """Return how many candidates of one batch are evaluated per second, all sensors moved."""
    evaluator = study.evaluator(study.search.samples)
    rigs = [
        study.rig.with_poses(
            [pe.Pose((x + 0.01 * k, y, z), s.pose.rpy) for s in study.rig for x, y, z in _at(s)]
        )
        for k in range(BATCH)
    ]
    evaluate_all(evaluator, rigs[:4], executor=executor)
    begun = time.perf_counter()
    evaluate_all(evaluator, rigs, executor=executor)
    return BATCH / (time.perf_counter() - begun)


def _at(sensor: pe.Sensor) -> list[tuple[float, float, float]]:
    return [sensor.pose.position]


def _bytes_line(study: pe.Study) -> str:
    """Return what is sent once to each worker, and with each candidate."""
    evaluator = study.evaluator(study.search.samples)
    payload = Payload((evaluator, *(sensor.model for sensor in study.rig)))
    once, each = len(payload.packed.data), len(payload.pickled((evaluator, study.rig)))
    return f"{once:,} bytes once to each worker; {each:,} bytes with each candidate"


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
    from distributed import Client, LocalCluster

    options: dict[str, Any] = {"host": "127.0.0.1", "dashboard_address": None}
    with (
        LocalCluster(n_workers=count, threads_per_worker=1, processes=True, **options) as cluster,
        Client(cluster) as client,
    ):
        client.wait_for_workers(count)
        yield client.get_executor()


WORKERS: dict[str, Callable[[], Any]] = {
    "this process": _none,
    "2 processes": lambda: _processes(2),
    "4 processes": lambda: _processes(4),
    "Dask, 4 workers": lambda: _cluster(4),
}


def _table(rows: Sequence[tuple[str, ...]]) -> list[str]:
    lines = ["", f"| {' | '.join((*HEAD, 'per second in a batch'))} |", f"|{' --- |' * 5}"]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    return [*lines, "", f"On {os.cpu_count()} processors."]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
