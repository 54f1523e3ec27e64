#!/usr/bin/env python3
"""Mutation testing: changes a line of the engine at a time and asks whether a test fails.

usage: tools/mutants.py [ROOM ...] [--most N] [--workers N] [--list]

tests/mutants.toml has the rooms, the tests that judge each, and how many mutants are drawn; Cosmic
Ray makes them. The same sources give the same mutants. Prints survivors and a table, and ends with
1 when fewer are killed in any room than the file asks for. docs/testing.md has more.
"""

import argparse
import ast
import compileall
import hashlib
import os
import queue
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from py_compile import PycInvalidationMode

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names

ROOT = Path(__file__).resolve().parent.parent
SETTINGS = ROOT / "tests" / "mutants.toml"
COPIED = ("pe_core", "pe_tools", "blend_assets", "tests", "docs/objects")

KILLED, SURVIVED, TIMED_OUT = "killed", "survived", "timed out"
MIN_TIMEOUT_S, TIMEOUT_FACTOR = 20.0, 4.0
"""A mutant that takes this many times as long as no mutant, and this at least, does not end."""
MEMORY_BYTES = 6 << 30
"""What a mutant may ask for: some ask for all there is."""
REMOVED = "(removed)"

Span = tuple[tuple[int, int], tuple[int, int]]
"""Line from 1 and column from 0, of the beginning and the end."""


@dataclass(frozen=True, slots=True)
class Room:
    """Files that are changed, how often, and the tests that are to notice, quick ones first."""

    name: str
    files: tuple[str, ...]
    tests: tuple[str, ...]
    mutants: int


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change: a line as it is and as it becomes; `code` is the whole file with it."""

    room: str
    file: str
    number: int
    line: str
    becomes: str
    code: str

    def __str__(self) -> str:
        return f"{self.file}:{self.number}: {self.line}\n    -> {self.becomes}"


@dataclass(frozen=True, slots=True, order=True)
class Way:
    """One of the ways in which Cosmic Ray changes a file: which of an operator's, and its line."""

    file: str
    number: int
    operator: str
    occurrence: int


class Drawing:
    """Draws mutants by a hash of the line they change: other lines do not change the draw."""

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def of(self, room: Room) -> list[Mutant]:
        """Draw a room's mutants, one a place at most."""
        places: dict[str, list[Way]] = defaultdict(list)
        for file in room.files:
            for key, way in _places(file):
                places[key].append(way)
        drawn = []
        for key in sorted(places, key=self._rank):
            if len(drawn) == room.mutants:
                break
            ways = [
                (self._rank(f"{key}{way.operator}{k}"), way) for k, way in enumerate(places[key])
            ]
            drawn.append(_made(room.name, min(ways)[1]))
        return drawn

    def _rank(self, key: str) -> bytes:
        return hashlib.sha256(f"{self._seed}:{key}".encode()).digest()


def _places(file: str) -> Iterator[tuple[str, Way]]:
    """Yield all that could be changed in a file, by a name of the place."""
    source = (ROOT / file).read_text("utf-8")
    nodes, lines = list(ast_nodes(get_ast(source))), source.splitlines()
    unread = _unread(source)
    for name in sorted(operator_names()):
        operator = get_operator(name)
        if operator.arguments():
            continue
        spans = (span for node in nodes for span in operator().mutation_positions(node))
        for occurrence, (start, end) in enumerate(spans):
            if not any(low <= start and end <= high for low, high in unread):
                text = lines[start[0] - 1]
                again = lines[: start[0]].count(text)
                yield f"{file}:{text}:{again}:{start[1]}", Way(file, start[0], name, occurrence)


def _unread(source: str) -> list[Span]:
    """Spans that make no difference.

    They are annotations, which nobody evaluates; ``slots=``, which saves memory; and ``strict=`` of
    zips whose parts are of one length.
    """
    found: list[ast.AST | None] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            found.append(node.returns)
        elif isinstance(node, (ast.arg, ast.AnnAssign)):
            found.append(node.annotation)
        elif isinstance(node, ast.keyword) and node.arg in ("slots", "strict"):
            found.append(node.value)
    spans = [n for n in found if isinstance(n, ast.expr)]
    return [((n.lineno, n.col_offset), (n.end_lineno, n.end_col_offset)) for n in spans]


def _made(room: str, way: Way) -> Mutant:
    source = (ROOT / way.file).read_text("utf-8")
    code = mutate_code(source, get_operator(way.operator)(), way.occurrence)
    old, new = source.splitlines(), code.splitlines()
    becomes = new[way.number - 1].strip() if len(old) == len(new) else REMOVED
    return Mutant(room, way.file, way.number, old[way.number - 1].strip(), becomes, code)


def slips(table: list[dict[str, str]], rooms: list[Room]) -> list[Mutant]:
    """Make the mutants that the settings write out: a wrong thought rather than a wrong sign."""
    found = []
    for entry in table:
        source = (ROOT / entry["file"]).read_text("utf-8")
        if source.count(entry["line"]) != 1:
            raise SystemExit(f"{SETTINGS.name}: {entry['file']} has no one line {entry['line']!r}")
        number = source[: source.index(entry["line"])].count("\n") + 1
        code = source.replace(entry["line"], entry["becomes"])
        if entry["room"] in [r.name for r in rooms]:
            told = [entry[k].strip() for k in ("line", "becomes")]
            found.append(Mutant(entry["room"], entry["file"], number, *told, code))
    return found


class Bench:
    """A copy of the project in which mutants are tried, one after the other."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in COPIED:
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("*.pyc"))
        shutil.copy(ROOT / "pyproject.toml", folder)
        # Compiled files are checked by content: a mutant may be as old and as long as its file.
        mode = PycInvalidationMode.CHECKED_HASH
        compileall.compile_dir(folder / "pe_core", quiet=1, invalidation_mode=mode)

    def try_out(self, mutant: Mutant, room: Room, timeout_s: float) -> str:
        """Run a room's tests on a mutant until one fails."""
        path = self.folder / mutant.file
        kept = path.read_bytes()
        path.write_text(mutant.code, "utf-8")
        try:
            status = self.run(room.tests, timeout_s)
        finally:
            path.write_bytes(kept)
        return TIMED_OUT if status is None else SURVIVED if status == 0 else KILLED

    def run(self, tests: tuple[str, ...], timeout_s: float, **more: str) -> int | None:
        """Exit status of pytest, None when the time is over."""
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
        environment = os.environ | {
            "PYTHONPATH": str(self.folder),
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
            "OMP_NUM_THREADS": "1",
            "CI": "1",  # Hypothesis then draws the same examples every time
            **more,
        }
        process = subprocess.Popen(
            command,
            cwd=self.folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            preexec_fn=_limit_memory,
        )
        try:
            return process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            return None
        finally:
            _end_group(process)

    def baseline(self, room: Room) -> float:
        """Time that a room's tests take on no mutant [s]."""
        started = time.monotonic()
        if self.run(room.tests, 600.0, PYTHONDONTWRITEBYTECODE="") != 0:
            raise SystemExit(f"the tests of {room.name} fail without any mutant")
        return time.monotonic() - started


def _limit_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))


def _end_group(process: subprocess.Popen[bytes]) -> None:
    """End a test run and whatever it started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        return
    process.wait()


def tried(mutants: list[Mutant], rooms: list[Room], workers: int) -> list[str]:
    """Try all mutants, several at a time; what became of each."""
    by_name = {room.name: room for room in rooms}
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        benches: queue.Queue[Bench] = queue.Queue()
        for number in range(workers):
            benches.put(Bench(Path(folder) / str(number)))
        with ThreadPoolExecutor(workers) as pool:
            tell = _teller(len(mutants))
            first = benches.queue[0]
            timeouts = {r.name: _timeout(first.baseline(r)) for r in rooms}

            def work(mutant: Mutant) -> str:
                bench = benches.get()
                try:
                    result = bench.try_out(mutant, by_name[mutant.room], timeouts[mutant.room])
                finally:
                    benches.put(bench)
                tell(mutant, result)
                return result

            return list(pool.map(work, mutants))


def _timeout(baseline_s: float) -> float:
    return max(MIN_TIMEOUT_S, TIMEOUT_FACTOR * baseline_s)


def _teller(total: int) -> Callable[[Mutant, str], None]:
    done = Counter[str]()

    def tell(mutant: Mutant, result: str) -> None:
        done[result] += 1
        told = mutant if result == SURVIVED else f"{mutant.file}:{mutant.number}"
        print(f"[{done.total()}/{total}] {result:9} {told}", file=sys.stderr, flush=True)

    return tell


def report(
    mutants: list[Mutant], results: list[str], rooms: list[Room], known: set[tuple[str, ...]]
) -> dict[str, float]:
    """Print survivors and the table; the share killed by room."""
    survivors = [m for m, r in zip(mutants, results, strict=True) if r == SURVIVED]
    for mutant in survivors:
        named = (mutant.file, mutant.line, mutant.becomes) in known
        print(f"{'named' if named else 'SURVIVED'}: {mutant}")
    print("\n| room | mutants | killed | of them timed out | survived | share killed |")
    print("| --- | --- | --- | --- | --- | --- |")
    shares = {}
    for room in rooms:
        own = [r for m, r in zip(mutants, results, strict=True) if m.room == room.name]
        lived, late = own.count(SURVIVED), own.count(TIMED_OUT)
        shares[room.name] = 1.0 - lived / max(1, len(own))
        figures = (len(own), len(own) - lived, late, lived, f"{shares[room.name]:.1%}")
        print(f"| {room.name} | {' | '.join(map(str, figures))} |")
    return shares


def _rooms(table: dict[str, dict[str, object]], wanted: list[str]) -> list[Room]:
    rooms = []
    for name, own in table.items():
        files = [file for pattern in own["files"] for file in _files_of(pattern)]
        tests = tuple(_path_of(test) for test in own["tests"])
        rooms.append(Room(name, tuple(dict.fromkeys(files)), tests, own["mutants"]))
    unknown = set(wanted) - {room.name for room in rooms}
    if unknown:
        raise SystemExit(f"no room {unknown.pop()!r}; there are {', '.join(table)}")
    return [room for room in rooms if not wanted or room.name in wanted]


def _files_of(pattern: str) -> list[str]:
    found = sorted(str(path.relative_to(ROOT)) for path in ROOT.glob(pattern))
    if not found:
        raise SystemExit(f"{SETTINGS.name}: there is no file {pattern}")
    return found


def _path_of(test: str) -> str:
    """``test_x`` or ``test_x::test_that`` as pytest has it."""
    file, *name = test.split("::")
    return "::".join([f"tests/engine/{file}.py", *name])


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help="rooms (default: all)")
    parser.add_argument("--most", type=int, help="try the first N of each room")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="tried at a time")
    parser.add_argument("--list", action="store_true", help="print the mutants, try none")
    args = parser.parse_args()
    settings = tomllib.loads(SETTINGS.read_text("utf-8"))
    rooms, drawing = _rooms(settings["room"], args.rooms), Drawing(settings["seed"])
    mutants = [m for room in rooms for m in drawing.of(room)[: args.most]]
    mutants += slips(settings["slip"], rooms)
    if args.list:
        print("\n".join(map(str, mutants)))
        return 0
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # leave no test running
    started = time.monotonic()
    results = tried(mutants, rooms, args.workers)
    known = {(e["file"], e["line"], e["becomes"]) for e in settings["same"]}
    shares = report(mutants, results, rooms, known)
    print(f"\n{len(mutants)} mutants in {(time.monotonic() - started) / 60.0:.1f} minutes")
    return int(min(shares.values()) < settings["least_share"])


if __name__ == "__main__":
    sys.exit(main())
