"""``python -m benchmarks --against REV [ROW ...]``: time this tree against an older commit.

The older commit is checked out into a folder of its own, with an environment of its own. Each row
is timed here and there in alternation, each time in a process of its own, so that a machine that
slows down slows both. Times are those of the processor, whatever clock a row reads, so that others
on the machine are not in them; a row that waits for other processes is timed by the clock. A row's
ratio is the median of the ratios of its pairs; the interval holds the middle half of them. Rows
that the older commit lacks are left out.
"""

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PAIRS = 5
BY_THE_CLOCK = ("candidates_in_processes", "answer_to_a_move", "mesh_sent", "search_in_traffic")
"""Rows whose work is done by other processes."""
RUN = """
import sys
import time
if sys.argv[2] == "processor":
    time.perf_counter = time.process_time
from benchmarks.__main__ import main
from pe_core.base.threads import keep_freed_memory
keep_freed_memory()
main([sys.argv[1]])
"""
"""Runs a row in a checkout of any commit. It keeps freed memory, as the processes of users do:
otherwise the size of an array that is freed early decides how fast later ones are had."""
SLOWER = 1.1
"""A row whose ratio is above this is named at the end, and the exit status is 1."""


@dataclass(frozen=True, slots=True)
class RatioRow:
    """A row timed on two commits. `ratios`: new time by old time, pair by pair."""

    name: str
    work: str
    ratios: tuple[float, ...]

    @property
    def ratio(self) -> float:
        """The median of the ratios."""
        return float(np.median(self.ratios))

    @property
    def text(self) -> str:
        """The row of the table: ratio, its middle half, and the work."""
        low, high = np.quantile(self.ratios, (0.25, 0.75))
        return f"{self.ratio:5.2f}  ({low:.2f} to {high:.2f})  {self.name}: {self.work}"


def compare(rev: str, names: Sequence[str]) -> int:
    """Print each row's ratio; return 1 if one is slower than `SLOWER`."""
    slower = []
    with _checkout(rev) as old:
        for name in names:
            row = _timed(old, name)
            if row is None:
                print(f"    -  {name}: not in {rev}", flush=True)
                continue
            print(row.text, flush=True)
            if row.ratio > SLOWER:
                slower.append(row.name)
    if slower:
        print(f"slower than {SLOWER:g}: {', '.join(slower)}")
    return int(bool(slower))


@contextmanager
def _checkout(rev: str) -> Iterator[Path]:
    """Yield a folder with a commit and its environment; it is removed at the end."""
    with tempfile.TemporaryDirectory(prefix="pe-against-") as scratch:
        folder = Path(scratch) / "old"
        git = ("git", "-C", str(ROOT), "worktree")
        subprocess.run([*git, "add", "--quiet", "--detach", folder, rev], check=True)
        try:
            subprocess.run(["make", "--quiet", "-C", folder, ".venv/dev.stamp"], check=True)
            yield folder
        finally:
            subprocess.run([*git, "remove", "--force", folder], check=True)


def _timed(old: Path, name: str) -> RatioRow | None:
    """Time a row on both commits in alternation; None where the older one lacks it."""
    ratios = []
    work = ""
    for _ in range(PAIRS):
        before = _seconds(old, old / ".venv" / "bin" / "python", name)
        if before is None:
            return None
        after = _seconds(ROOT, Path(sys.executable), name)
        if after is None:
            raise SystemExit(f"{name} ends with an error: run `python -m benchmarks {name}`")
        work = after["work"]
        ratios.append(after["ours_s"] / before["ours_s"])
    return RatioRow(name, work, tuple(ratios))


def _seconds(folder: Path, python: Path, name: str) -> dict | None:
    """Run a row in a checkout; return what it prints, or None where it ends with an error."""
    clock = "wall" if name in BY_THE_CLOCK else "processor"
    command = [python, "-c", RUN, name, clock]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return json.loads(done.stdout) if done.returncode == 0 else None
