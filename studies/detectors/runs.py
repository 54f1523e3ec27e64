"""The runs of the plans in their order, and their results: a file each, so none is done twice."""

from __future__ import annotations

import argparse
import hashlib
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from pe_core import InputError
from pe_core.base import Number, Table, dump_json, write_bytes
from pe_tools.cli import noted_when_interrupted, whole

from ..results_file import Json, print_progress, read_json
from .placements import Placement, arm_placements, frames_placements, good_placements, placements
from .plan import ACROSS, EQUAL_M, FIXED, GOOD, GRID, LAYOUTS, MIXED, PLAIN, SEARCHES, Plan

if TYPE_CHECKING:
    from .scenes import Layouts

FIXED_IN_TURN = 2
"""Placements of the fixed design after each one across hardware, within a seed."""
RUNS = "runs"
"""Folder of the results."""
MAX_RUNS = 10_000
SCHEMA = 1
CODE = ("pe_core", "studies.detectors")
"""Packages of which a run is made; they have the prior, the catalogue and the plans, too."""
SHARE = Number(0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Run:
    """A detector trained with a seed, for one placement or (placement None) for many."""

    placement: Placement | None
    seed: int
    world: str = PLAIN
    detector: str = GRID

    @property
    def name(self) -> str:
        """Its name, which is that of its file."""
        what = self.placement.name if self.placement else MIXED
        step = (self.world, self.detector)
        return f"{'' if step == (PLAIN, GRID) else '-'.join(step) + '-'}{what}-s{self.seed}"

    @property
    def design(self) -> str:
        """Design of the placement."""
        return self.placement.design if self.placement else MIXED


def runs(plan: Plan) -> list[Run]:
    """Return all runs of the plan of LiDARs: the designs seed by seed, then the steps.

    So an early stop leaves whole seeds.
    """
    drawn = placements(plan)
    ordered = [*_in_turn(drawn, plan.vehicles), None]
    main = [Run(placement, seed) for seed in plan.training.seeds for placement in ordered]
    chosen = _step_placements(plan, drawn)
    return main + [
        Run(placement, seed, step.world, step.detector)
        for step in plan.steps.runs
        for seed in step.seeds
        for placement in chosen
    ]


def seed_by_seed(plan: Plan, drawn: Sequence[Placement]) -> list[Run]:
    """Return the runs of placements with the seeds of a plan."""
    return [Run(placement, seed) for seed in plan.training.seeds for placement in drawn]


def frames_runs(plan: Plan) -> list[Run]:
    """Return the runs of frames, seed by seed; each has both arms."""
    return seed_by_seed(plan, frames_placements(plan))


def parts_of(plan: Plan, searched: Sequence[Placement] = ()) -> dict[str, list[Run]]:
    """Return the runs of each part of the second plan, vehicles by turns, in their order.

    Part 2 comes first, then part 1; those of part 4 are of the placements that were searched.
    """
    good = sorted(good_placements(plan), key=lambda p: p.name[-2:])
    own = plan.second
    return {
        EQUAL_M: [Run(p, seed) for seed in own.equal_m.seeds for p in arm_placements(plan)],
        GOOD: [Run(p, seed) for seed in own.good.seeds for p in good],
        LAYOUTS: [Run(None, seed, LAYOUTS) for seed in plan.layout_seeds],
        SEARCHES: [Run(p, seed) for seed in plan.searched_seeds for p in searched],
    }


def _in_turn(drawn: Sequence[Placement], vehicles: Sequence[str]) -> Iterator[Placement]:
    """Yield placements of both designs by turns, and of all vehicles by turns."""
    across, fixed = (
        _by_turns([[p for p in drawn if p.design == d and p.vehicle == v] for v in vehicles])
        for d in (ACROSS, FIXED)
    )
    while across or fixed:
        yield from across[:1] + fixed[:FIXED_IN_TURN]
        del across[:1], fixed[:FIXED_IN_TURN]


def _by_turns(groups: Sequence[Sequence[Placement]]) -> list[Placement]:
    turns = itertools.zip_longest(*groups)
    return [placement for turn in turns for placement in turn if placement is not None]


def _step_placements(plan: Plan, drawn: Sequence[Placement]) -> list[Placement]:
    """Return the placements of the steps towards reality."""
    all_round = [p for p in drawn if p.design == FIXED and p.all_round]
    fixed = [[p for p in all_round if p.vehicle == v][: plan.steps.fixed] for v in plan.vehicles]
    across = [p for p in drawn if p.design == ACROSS and p.vehicle in plan.steps.across]
    return [*_by_turns(fixed), *across]


class RunFiles:
    """The results of the runs of a plan, in their order, in the folder of its study."""

    def __init__(self, folder: Path, plan: Plan, planned: Sequence[Run]) -> None:
        self.folder = folder
        self.plan = plan
        self.all = list(planned)

    def path(self, run: Run) -> Path:
        """Return the file of a run."""
        return self.folder / RUNS / f"{run.name}.json"

    def missing(self) -> list[Run]:
        """Return the runs without a file, in their order."""
        return [run for run in self.all if not self.path(run).exists()]

    def write(self, run: Run, data: Json) -> None:
        """Write a run's results atomically."""
        self.path(run).parent.mkdir(parents=True, exist_ok=True)
        head = {"schema": SCHEMA, "plan": self.plan.digest, "run": run.name}
        write_bytes(self.path(run), dump_json({**head, **data}).encode())

    def read(self) -> dict[str, Json]:
        """Return the results that are there, by the name of the run, in the order of the plan.

        A file that is damaged, or of another plan or run, is an `InputError`.
        """
        return {run.name: self._checked(run) for run in self.all if self.path(run).exists()}

    def _checked(self, run: Run) -> Json:
        path = self.path(run)
        data = read_json(path)
        table = Table(data, str(path))
        head = (("schema", SCHEMA), ("plan", self.plan.digest), ("run", run.name))
        for key, expected in head:
            if table.raw(key) != expected:
                raise InputError(path, key, str(expected), table.raw(key))
        parts = table.at("placements", {}) if run.placement is None else None
        for part in [table] if parts is None else [parts.at(k) for k in parts.table]:
            part.number("ap", rule=SHARE)
        return data


def add_run_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `do_runs` to the parser of a study."""
    parser.add_argument("--resume", action="store_true", help="go on where the folder's runs end")
    about = "do at most so many runs now"
    parser.add_argument("--runs", type=whole(MAX_RUNS), metavar="N", help=about)


def do_runs(args: argparse.Namespace, files: RunFiles, layouts: Layouts | None = None) -> None:
    """Do the missing runs of a plan, at most `args.runs` of them; `layouts` as in `result_of`.

    Results that are there without `args.resume` are an `InputError`.
    """
    files.read()  # complains now, not after hours
    missing = files.missing()
    total = len(files.all)
    done = total - len(missing)
    if args.page_only or args.runs == 0 or not missing:
        return
    if done and not args.resume:
        found = f"{done} of {total} runs; pass --resume to go on"
        raise InputError(files.folder, "folder", "a folder without results", found)
    from .training import result_of  # TensorFlow is loaded when a run is missing

    note = f"{files.folder} keeps the finished runs; --resume goes on from them"
    with noted_when_interrupted(note):
        for run in missing[: args.runs]:
            data = result_of(files.plan, run, layouts)
            files.write(run, data)
            done = total - len(files.missing())
            print_progress(f"[{done}/{total}] {run.name}  {_brief(data)}")


def _brief(data: Mapping[str, Json]) -> str:
    ap = f"AP {data['ap']:.3f}, " if "ap" in data else ""
    return f"{ap}{data['training']['epochs']} epochs, {data['seconds']:.0f} s"


def run_digest(plan: str, versions: Mapping[str, str]) -> str:
    """Return the digest of what makes a run: plan, code with prior and catalogue, and versions.

    `plan` is the digest of the plan, `versions` are those of Python and the libraries.
    """
    code = sorted(
        (f"{package}/{path.relative_to(root).as_posix()}", path)
        for package in CODE
        for root in [Path(str(resources.files(package)))]
        for path in root.rglob("*")
        if path.suffix in (".py", ".toml")
    )
    parts = [("plan", plan.encode()), ("versions", dump_json(dict(versions)).encode())]
    return _digest_of(itertools.chain(parts, ((name, path.read_bytes()) for name, path in code)))


def _digest_of(parts: Iterable[tuple[str, bytes]]) -> str:
    total = hashlib.sha256()
    for name, content in parts:
        total.update(f"{name} {len(content)}\n".encode() + content)
    return total.hexdigest()[:16]
