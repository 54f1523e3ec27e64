"""What the runs of `searches` say: a summary, and a page of tables."""

from __future__ import annotations

import json
import math
from operator import itemgetter
from pathlib import Path
from statistics import mean, median
from typing import Any

import pe_core as pe

from .run_files import summarise
from .search_problems import BUDGETS, PROBLEMS
from .yardstick_searches import YARDSTICKS

TABLE = Path(__file__).with_name("searches.md")
OPTIMUM = Path(__file__).with_name("slot_optimum.json")
NAMES = {
    "cma": "CMA-ES",
    "lq-cma": "lq-CMA-ES",
    "ngioh": "NgIohTuned",
    "lengler": "DiscreteLengler",
    "bobyqa": "Py-BOBYQA",
    "gp": "Optuna GP",
}
ABOUT = """\
Entropy on the grid [nats], lower is better: median of the seeds, and in brackets the worst one. All
methods have the same start, the same evaluator and the same number of evaluations; the result is
scored on all voxels. `python -m benchmarks.searches` writes this from its run files, searches.json;
search_problems.py says what each problem is.

- portfolio: the default search here. Its first level evaluates fewer voxels.
- CMA-ES, lq-CMA-ES: pycma, steps of 0.2 of each range, restarts from anywhere with twice the
  population; slots are integers. lq-CMA-ES has a linear or quadratic model of the values.
- NgIohTuned, DiscreteLengler (DiscreteLenglerOnePlusOne): Nevergrad; slots are integers. NgIohTuned
  chooses methods without chance; its variables are mirrored and in another order by the seed, as
  else all seeds would search alike.
- Py-BOBYQA: with its own restarts, then from anywhere. Its first directions are random, as else
  all seeds would search alike.
- Optuna GP, where it ran: a Gaussian process, at most two minutes of processor time a run; slots
  are categories.

Constraints: a placement that breaks a rule is not evaluated and counts nothing. CMA-ES draws it
anew; the others are told a penalty, the worst entropy so far plus the number of broken rules.

A cell has five seeds, or says how many. With fewer than three nothing is best and nothing is
ranked. The mean rank is among the methods that have three seeds of a problem; the number of
problems is in brackets.

## The plan of these runs, written before them

One core had about 75 minutes, so the plan was cut before its first run: seven of the fifteen
problems with the small budget, one of them also with the default one; five seeds; 2,048 voxels. Two
of the seven had a part in the choice of settings and are asked about by name (*two free*, *car and
pairs*), one more had such a part (*eight free*), three were kept apart, one is new. They are the
cheaper half of the problems: large bodies and long searches are missing. Seeds come one after the
other over all problems and methods, so runs that are broken off are balanced. Left out: the random
search, which [experiments](README.md) compare, and Optuna's Gaussian process, whose two minutes a
run would take twice the time of all other methods together. A method wins a problem by its median;
the engine's search counts as one of the methods, and its losses are listed.

Cut a second time, after 14 runs of the first seed and before any of the second: other programs left
a quarter of a core, so there are three seeds rather than five, and *sedan of four* is left out. And
a third time, still before any run of the second seed: *eight free* stays as it is with one seed, as
Nevergrad's methods take most of its time (74 s and 34 s a run), and the default budget is tried
last.

Taken further later, after the figures of those 113 runs and before any of these: seeds 3 and 4 of
the five problems that had three, then seeds 1 to 4 of *eight free*; then the default budget of *six
in slots*, *slots and ranges* and *car and pairs*, seeds 0 to 2; then the small budget of the nine
problems that were left out, a seed over all of them before the next one, in this order: *three on
roof*, *cameras around*, *corners in pairs*, *tilted ring*, *corners and rack*, *traffic*, *sedan of
four*, *shuttle of eight*, *sixteen free*. 2,048 voxels, as before. What is not done when the time
ends stays undone, and is named.

And once more, after the runs with the default budget and before any of these: Optuna's Gaussian
process with the small budget, seeds 0 to 2 of *six in slots*, *slots and ranges*, *two free*,
*objects of five* and *car and pairs*, at most two minutes of processor time a run, on a second
processor and once the nine problems have run. It is ranked among the methods where it has three
seeds.

Changed after the first figures: NgIohTuned showed one number for two seeds of *two free*. Its
variables are mirrored and ordered by the seed since, and its runs were made again, but for *eight
free*."""
SEEDS = 3
ALL_SEEDS = 5
"""Of a cell: those from which on it is ranked, and those that were planned."""
DEFAULT = "portfolio"
"""The engine's default search."""

Json = dict[str, Any]


def write_summary(runs: Path, path: Path) -> None:
    """Put all runs of a folder into one file, one a line; write the page."""
    found = summarise(runs, path)
    lines = table(found)
    print("\n".join(lines))
    TABLE.write_text("\n".join(lines) + "\n", "utf-8")


def methods_of(runs: list[Json]) -> list[str]:
    """Return the methods that have runs, the engine's first."""
    return [m for m in (*pe.METHODS, *YARDSTICKS) if any(run["method"] == m for run in runs)]


def table(runs: list[Json]) -> list[str]:
    """Return the page: a table for each budget, the counted optimum, and notes on the runs."""
    lines = ["# Methods of search on fifteen problems", "", *ABOUT.splitlines()]
    for budget in dict.fromkeys(run["budget"] for run in runs):
        lines += ["", *_of_budget([run for run in runs if run["budget"] == budget], budget)]
    return [*lines, "", *_losses(runs), *_optimum_lines(runs), *_notes(runs)]


def _of_budget(runs: list[Json], budget: str) -> list[str]:
    """Return the table of one budget: problems that have runs."""
    methods = methods_of(runs)
    lines = [
        f"## {budget.capitalize()} budget",
        "",
        f"| problem | evaluations | voxels | {' | '.join(NAMES.get(m, m) for m in methods)} |",
        f"|{' --- |' * (len(methods) + 3)}",
    ]
    for name, problem in PROBLEMS.items():
        own = [run for run in runs if run["problem"] == name]
        if not own:
            continue
        ends = {m: entropies(own, name, m) for m in methods}
        best = min(median(values) for values in ends.values() if values)
        title = f"{name} ({problem.mark})" if problem.mark else name
        head = f"| {title} | {own[0]['asked']:,} | {own[0]['samples']:,} "
        lines.append(f"{head}| {' | '.join(_cell(ends[m], best) for m in methods)} |")
    ranks = [_mean_rank(runs, m, methods) for m in methods]
    lines.append(f"| mean rank (problems) | | | {' | '.join(ranks)} |")
    seconds = [_seconds(runs, m) for m in methods]
    lines.append(f"| processor time of a run, median | | | {' | '.join(seconds)} |")
    broken = [_broken(runs, m) for m in methods]
    lines.append(f"| broken placements for each evaluated one | | | {' | '.join(broken)} |")
    return lines


def entropies(runs: list[Json], problem: str, method: str, figure: str = "entropy") -> list[float]:
    """Return the entropies that a method found on a problem, on the grid or "own_sample" [nats]."""
    return [r[figure] for r in runs if (r["problem"], r["method"]) == (problem, method)]


def _cell(values: list[float], best: float) -> str:
    if not values:
        return "-"
    middle = f"{median(values):.3f}"
    middle = f"**{middle}**" if median(values) == best and len(values) >= SEEDS else middle
    count = "" if len(values) == ALL_SEEDS else f", {len(values)} seed{'s' * (len(values) > 1)}"
    return f"{middle} ({max(values):.3f}{count})"


def _mean_rank(runs: list[Json], method: str, methods: list[str]) -> str:
    """Return the mean rank of a method's median among those of all methods, and over how many
    problems; a method counts where it has enough seeds."""
    ranks = []
    for name in PROBLEMS:
        ends = {m: entropies(runs, name, m) for m in methods}
        middles = {m: median(values) for m, values in ends.items() if len(values) >= SEEDS}
        if method in middles and len(middles) > 1:
            ranks.append(1 + sum(value < middles[method] for value in middles.values()))
    return f"{mean(ranks):.1f} ({len(ranks)})" if ranks else "-"


def _seconds(runs: list[Json], method: str) -> str:
    return f"{median(r['seconds'] for r in runs if r['method'] == method):.1f} s"


def _broken(runs: list[Json], method: str) -> str:
    own = [r for r in runs if r["method"] == method and r["broken"] is not None]
    evaluated = sum(r["evaluations"] for r in own)
    return f"{sum(r['broken'] for r in own) / evaluated:.2f}" if own else "not counted"


def _losses(runs: list[Json]) -> list[str]:
    """Return where another method's median is below that of the engine's default search, and what
    both had on the voxels that the methods evaluated."""
    lines = ["## Where another method wins", ""]
    for budget, name in dict.fromkeys((r["budget"], r["problem"]) for r in runs):
        own = [r for r in runs if (r["budget"], r["problem"]) == (budget, name)]
        middles = {m: median(entropies(own, name, m)) for m in methods_of(own)}
        ours = middles.pop(DEFAULT, math.inf)
        better = {NAMES.get(m, m): v for m, v in middles.items() if v < ours}
        if better:
            text = ", ".join(f"{m} {v:.3f}" for m, v in sorted(better.items(), key=itemgetter(1)))
            first, sampled = (
                f"{NAMES.get(m, m)} {median(entropies(own, name, m, 'own_sample')):.3f}"
                for m in (min(middles, key=middles.__getitem__), DEFAULT)
            )
            lines += [
                f"- *{name}*, {budget} budget: {text}; {DEFAULT} {ours:.3f}. On the voxels that "
                f"were searched: {first}, {sampled}."
            ]
    return [*(lines if len(lines) > 2 else [*lines, "Nowhere."]), ""]


def _optimum_lines(runs: list[Json]) -> list[str]:
    """Return what counting all placements in slots found, beside the searches."""
    if not OPTIMUM.exists():
        return []
    found = json.loads(OPTIMUM.read_text("utf-8"))
    name = found["problem"]
    own = entropies(runs, name, "portfolio")
    lines = [
        "## The best known placement in slots",
        "",
        f"*{name}*: all {found['counted']:,} different placements were counted, on a sample of "
        f"{found['voxels']:,} voxels (`python -m benchmarks.slot_optimum`). The "
        f"{found['finalists']} best there were scored on the grid, and the best of them has "
        f"**{found['entropy']:.3f}**: "
        "the best known, not proven to be the best on the grid, where the other placements were "
        "not scored.",
    ]
    if own:
        lines[-1] += f" The portfolio found {min(own):.3f} to {max(own):.3f}."
    return [*lines, ""]


def _notes(runs: list[Json]) -> list[str]:
    """Return what the files say of themselves: seeds that searched alike, missing runs, load."""
    lines = ["## What is to be said of the runs", ""]
    keys = dict.fromkeys((r["problem"], r["method"], r["budget"]) for r in runs)
    alike = []
    for key in keys:
        own = [r for r in runs if (r["problem"], r["method"], r["budget"]) == key]
        if len({r["path"] for r in own}) < len(own):
            alike.append(f"{key[0]} by {NAMES.get(key[1], key[1])}")
    text = ", ".join(alike) if alike else "none"
    about = "digest of the best placements one after the other"
    lines.append(f"- Seeds of a method that searched alike ({about}): {text}.")
    whole = sum(1 for r in keys if sum((x["problem"], x["method"], x["budget"]) == r for x in runs))
    lines.append(f"- {len(runs)} runs, of {whole} pairs of problem and method.")
    missing = [n for n in PROBLEMS if not any(r["problem"] == n for r in runs)]
    if missing:
        lines.append(f"- No run in the time there was: {', '.join(missing)}.")
    lines += [
        f"- No run with the {b} budget." for b in BUDGETS if all(r["budget"] != b for r in runs)
    ]
    chosen = sorted({r["chosen"] for r in runs if r["method"] == "ngioh"})
    if chosen:
        lines.append(f"- NgIohTuned chose: {', '.join(chosen)}.")
    loads = [r["load"] for r in runs]
    lines.append(f"- Load of the two processors: {min(loads):.0f} to {max(loads):.0f}.")
    return lines
