"""What the runs of `searches` say: a summary, a table, and a plot of the best so far."""

from __future__ import annotations

from pathlib import Path
from statistics import median
from typing import Any

import pe_core as pe

from .run_files import summarise
from .search_curves import draw_curve, save_with_legend
from .search_problems import PROBLEMS
from .yardstick_searches import YARDSTICKS

ROOT = Path(__file__).resolve().parent.parent
PLOT = ROOT / "docs" / "images" / "search_problems.png"
TABLE = Path(__file__).with_name("searches.md")
NAMES = {"ngopt": "Nevergrad NGOpt", "pycma": "pycma, restarts"}
COLUMNS = 4

Json = dict[str, Any]


def write_summary(runs: Path, path: Path) -> None:
    """Put all runs of a folder into one file, one a line; write the table and the plot."""
    found = summarise(runs, path)
    lines = table(found)
    print("\n".join(lines))
    TABLE.write_text("\n".join(lines) + "\n", "utf-8")
    plot(found, PLOT)


def methods_of(runs: list[Json]) -> list[str]:
    """Return the methods that have runs, the engine's first."""
    return [m for m in (*pe.METHODS, *YARDSTICKS) if any(run["method"] == m for run in runs)]


def table(runs: list[Json]) -> list[str]:
    """Return the table: median of the seeds, and lowest to highest."""
    methods = methods_of(runs)
    lines = [
        "# Methods of search on fifteen problems",
        "",
        "Entropy on the grid [nats], lower is better: the median of the seeds, and lowest to",
        "highest. All methods have the same evaluator and the same number of evaluations. Shares",
        "and counts of race and images were chosen on experiment 4; that the race replaces other",
        "descents also for small budgets, on the first twelve; fewer images for those, on all.",
        "Of large budgets, of which none is here: on seeds 8 and 10 to 19 of experiment 4.",
        "`python -m benchmarks.searches` writes this; search_problems.py says what each is.",
        "",
        f"| problem | evaluations | {' | '.join(NAMES.get(m, m) for m in methods)} |",
        f"|{' --- |' * (len(methods) + 2)}",
    ]
    for name, problem in PROBLEMS.items():
        ends = {m: entropies(runs, name, m) for m in methods}
        best = min((median(values) for values in ends.values() if values), default=0.0)
        cells = [_cell(ends[m], best) for m in methods]
        title = f"{name} ({problem.mark})" if problem.mark else name
        lines.append(f"| {title} | {problem.evaluations} | {' | '.join(cells)} |")
    counts = [max(len(entropies(runs, name, m)) for name in PROBLEMS) for m in methods]
    lines.append(f"| seeds, at most | | {' | '.join(map(str, counts))} |")
    seconds = [f"{sum(r['seconds'] for r in runs if r['method'] == m):.0f} s" for m in methods]
    lines.append(f"| processor time of all runs | | {' | '.join(seconds)} |")
    return lines


def entropies(runs: list[Json], problem: str, method: str) -> list[float]:
    """Return the entropies on the grid that a method found on a problem [nats]."""
    return [r["entropy"] for r in runs if (r["problem"], r["method"]) == (problem, method)]


def _cell(values: list[float], best: float) -> str:
    if not values:
        return "-"
    middle = f"{median(values):.3f}"
    middle = f"**{middle}**" if median(values) == best else middle
    return f"{middle} ({min(values):.3f} to {max(values):.3f})"


def plot(runs: list[Json], path: Path) -> None:
    """Draw the best so far against processor time: a panel for each problem."""
    from studies import plotting

    methods = methods_of(runs)
    looks = dict(zip(methods, plotting.PALETTE, strict=False))

    @plotting.styled
    def draw() -> None:
        rows = -(-len(PROBLEMS) // COLUMNS)
        figure, grid = plotting.pyplot().subplots(rows, COLUMNS, figsize=(10.4, 2.3 * rows))
        for axis, (name, problem) in zip(grid.flat, PROBLEMS.items(), strict=False):
            for method in methods:
                some = [r for r in runs if (r["problem"], r["method"]) == (name, method)]
                if some:
                    draw_curve(axis, some, looks[method], NAMES.get(method, method))
            axis.set(xscale="log", title=name + (f" ({problem.mark})" if problem.mark else ""))
            plotting.remove_frame(axis)
        for axis in grid.flat[len(PROBLEMS) :]:
            axis.set_axis_off()
        for axis in grid[-1]:
            axis.set_xlabel("processor time [s]")
        for axis in grid[:, 0]:
            axis.set_ylabel("entropy [nats]")
        save_with_legend(figure, path, 0.05)

    draw()
