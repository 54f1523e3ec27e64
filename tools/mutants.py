#!/usr/bin/env python3
"""Mutation testing: changes a line of the engine at a time and asks whether a test fails.

usage: tools/mutants.py [ROOM ...] [--most N] [--workers N] [--resume FOLDER] [--list]

tests/mutants.toml has the rooms, the tests that judge each, and how many mutants are drawn; Cosmic
Ray makes them. The same sources give the same mutants. Prints survivors and a table, and ends with
1 when fewer are killed in any room than the file asks for. docs/testing.md has more.
"""

import argparse
import ast
import hashlib
import json
import os
import queue
import signal
import sys
import tempfile
import threading
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names
from mutant_bench import ROOT, Bench, Reached, by_function, function_at, recorded, write_whole

SETTINGS = ROOT / "tests" / "mutants.toml"

KILLED = "killed"
SURVIVED = "survived"
TIMED_OUT = "timed out"
SAME = "equivalent"
QUICK_FILES = 2
UNKNOWN_TEST = (4, 5)
"""Pytest's exit statuses when it does not find a test by its name."""
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
    function: str | None
    """Name of the function that is changed; None for what runs at an import."""

    @property
    def key(self) -> str:
        """A name under which its result is stored."""
        return hashlib.sha256(f"{self.file}:{self.code}".encode()).hexdigest()[:24]

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
    nodes = list(ast_nodes(get_ast(source)))
    lines = source.splitlines()
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

    They are annotations, which nobody evaluates; protocols, which nobody runs; ``slots=``, which
    saves memory; and ``strict=`` of zips whose parts are of one length.
    """
    found: list[ast.AST | None] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            found.append(node.returns)
        elif isinstance(node, (ast.arg, ast.AnnAssign)):
            found.append(node.annotation)
        elif isinstance(node, ast.keyword) and node.arg in ("slots", "strict"):
            found.append(node.value)
        elif isinstance(node, ast.ClassDef) and "Protocol" in map(ast.unparse, node.bases):
            found += node.body
    spans = [n for n in found if n is not None]
    return [
        ((_first_line(n), n.col_offset - isinstance(n, ast.stmt)), (n.end_lineno, n.end_col_offset))
        for n in spans
    ]


def _first_line(node: ast.AST) -> int:
    return min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))])


def _made(room: str, way: Way) -> Mutant:
    source = (ROOT / way.file).read_text("utf-8")
    code = mutate_code(source, get_operator(way.operator)(), way.occurrence)
    old = source.splitlines()
    new = code.splitlines()
    becomes = new[way.number - 1].strip() if len(old) == len(new) else REMOVED
    function = function_at(source, way.number)
    return Mutant(
        room,
        way.file,
        way.number,
        old[way.number - 1].strip(),
        becomes=becomes,
        code=code,
        function=function,
    )


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
            function = function_at(source, number)
            found.append(Mutant(entry["room"], entry["file"], number, *told, code, function))
    return found


class Judge:
    """Runs the tests of a room that a mutant can make fail."""

    def __init__(self, room: Room, reached: Reached) -> None:
        self._reached = {t: r for t, r in reached.items() if _is_wanted(t, room.tests)}
        self._callers = by_function(self._reached)

    def stages(self, mutant: Mutant) -> list[list[str]]:
        """Tests to run one group after the other.

        First those that call the function that is changed, or anything in the file where it is no
        function. Then, as results are cached between tests, all others of these files; those of the
        whole room where no function is changed or none of the tests was seen to call it.
        """
        if mutant.function:
            first = set(self._callers.get(f"{mutant.file}::{mutant.function}", ()))
            files = {_file_of(test) for test in first}
            rest = {test for test in self._reached if not first or _file_of(test) in files}
        else:
            inside = f"{mutant.file}::"
            first = {t for f, own in self._callers.items() if f.startswith(inside) for t in own}
            rest = set(self._reached)
        quick = self._quickest(first)
        return [self._ordered(part) for part in (quick, first - quick, rest - first) if part]

    def _quickest(self, tests: set[str]) -> set[str]:
        """Tests of the quickest two files: most mutants need no other file to be collected."""
        files = list(dict.fromkeys(map(_file_of, self._ordered(tests))))[:QUICK_FILES]
        return {test for test in tests if _file_of(test) in files}

    def _ordered(self, tests: set[str]) -> list[str]:
        """Quick files first, each file's tests together."""
        seconds: dict[str, float] = defaultdict(float)
        for test in tests:
            seconds[_file_of(test)] += self._reached[test][0]
        places = {test: place for place, test in enumerate(self._reached)}
        return sorted(tests, key=lambda t: (seconds[_file_of(t)], _file_of(t), places[t]))

    def run(self, bench: Bench, tests: list[str]) -> str:
        """Run tests until one fails."""
        status = bench.run(tests, sum(self._reached[test][0] for test in tests))
        if status in UNKNOWN_TEST:  # a parameter of a test may have the mutant's value in its name
            status = bench.run(list(dict.fromkeys(map(_file_of, tests))), 60.0)
        return TIMED_OUT if status is None else SURVIVED if status == 0 else KILLED

    def try_out(self, bench: Bench, mutant: Mutant) -> str:
        """Return what becomes of a mutant."""
        result = SURVIVED
        with bench.mutated(mutant.file, mutant.code):
            for tests in self.stages(mutant):
                if result == SURVIVED:
                    result = self.run(bench, tests)
        return result


def _file_of(test: str) -> str:
    return test.partition("::")[0]


def _is_wanted(test: str, wanted: tuple[str, ...]) -> bool:
    return any(test == own or test.startswith((f"{own}::", f"{own}[")) for own in wanted)


class Results:
    """What became of mutants, by the text that they make of a file; stored after each of them.

    A survivor is tried again when the tests have changed, whatever is killed is not.
    """

    def __init__(self, path: Path | None, tests: str) -> None:
        self._path = path
        self._tests = tests
        self._lock = threading.Lock()
        self._stored = json.loads(path.read_text("utf-8")) if path and path.exists() else {}

    def get(self, mutant: Mutant) -> str | None:
        """Return a stored result."""
        result, tests = self._stored.get(mutant.key, (None, None))
        return None if result == SURVIVED and tests != self._tests else result

    def store(self, mutant: Mutant, result: str) -> None:
        """Store a result."""
        with self._lock:
            self._stored[mutant.key] = (result, self._tests)
            if self._path:
                write_whole(self._path, json.dumps(self._stored, indent=0))


def tried(mutants: list[Mutant], rooms: list[Room], workers: int, store: Path | None) -> list[str]:
    """Try all mutants, several at a time; what became of each."""
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        benches = [Bench(Path(folder) / str(number)) for number in range(workers)]
        free: queue.Queue[Bench] = queue.Queue()
        for bench in benches:
            free.put(bench)
        tell = _teller(len(mutants))
        judges: dict[str, tuple[Judge, Results]] = {}
        for room in rooms:
            files = list(dict.fromkeys(map(_file_of, room.tests)))
            reached = recorded(benches[0], files, store and store / "reached.json")
            results = Results(store and store / f"{room.name}.json", _digest(files))
            judges[room.name] = Judge(room, reached), results

        def work(mutant: Mutant) -> str:
            judge, results = judges[mutant.room]
            result = results.get(mutant)
            if result is None:
                bench = free.get()
                try:
                    result = judge.try_out(bench, mutant)
                finally:
                    free.put(bench)
                results.store(mutant, result)
            tell(mutant, result)
            return result

        try:
            with ThreadPoolExecutor(workers) as pool:
                return list(pool.map(work, mutants))
        finally:
            for bench in benches:
                bench.close()


def _digest(files: list[str]) -> str:
    return hashlib.sha256(b"".join((ROOT / file).read_bytes() for file in files)).hexdigest()[:16]


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
    """Print survivors and the table; the share killed by room, of those that are not equivalent."""
    fates: dict[str, Counter[str]] = {room.name: Counter() for room in rooms}
    for mutant, result in zip(mutants, results, strict=True):
        fate = result
        if result == SURVIVED:
            fate = SAME if (mutant.file, mutant.line, mutant.becomes) in known else SURVIVED
            print(f"{'equivalent' if fate == SAME else 'SURVIVED'}: {mutant}")
        fates[mutant.room][fate] += 1
    print(
        "\n| room | mutants | killed | of them timed out | equivalent | survived | share killed |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- |")
    shares = {}
    for name, fate in fates.items():
        killed = fate[KILLED] + fate[TIMED_OUT]
        shares[name] = killed / max(1, killed + fate[SURVIVED])
        counts = (fate.total(), killed, fate[TIMED_OUT], fate[SAME], fate[SURVIVED])
        print(f"| {name} | {' | '.join(map(str, counts))} | {shares[name]:.1%} |")
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
    parser.add_argument("--resume", type=Path, metavar="FOLDER", help="keep results there, go on")
    args = parser.parse_args()
    settings = tomllib.loads(SETTINGS.read_text("utf-8"))
    rooms = _rooms(settings["room"], args.rooms)
    drawing = Drawing(settings["seed"])
    mutants = [m for room in rooms for m in drawing.of(room)[: args.most]]
    mutants += slips(settings["slip"], rooms)
    if args.list:
        print("\n".join(map(str, mutants)))
        return 0
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # leave no test running
    started = time.monotonic()
    results = tried(mutants, rooms, args.workers, args.resume)
    known = {(e["file"], e["line"], e["becomes"]) for e in settings["same"]}
    shares = report(mutants, results, rooms, known)
    print(f"\n{len(mutants)} mutants in {(time.monotonic() - started) / 60.0:.1f} minutes")
    return int(min(shares.values()) < settings["least_share"])


if __name__ == "__main__":
    sys.exit(main())
