"""Runs tests on mutants: a copy of the project, and a process that forks a pytest for each mutant.

NumPy and pytest are imported once and not for each mutant. The tests are recorded once without a
mutant: which functions each of them calls. A mutant of a function then needs those tests alone.
"""

import ast
import compileall
import contextlib
import hashlib
import importlib
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import defaultdict
from pathlib import Path
from py_compile import PycInvalidationMode

ROOT = Path(__file__).resolve().parent.parent
COPIED = (
    "pe_core",
    "pe_tools",
    "blend_assets",
    "benchmarks",
    "tests",
    "docs",
    "tools",
    "examples/plugin",
)
PRODUCTION = ("pe_core", "pe_tools")
PRELOADED = ("numpy", "numpy.testing", "pytest", "xdist.scheduler", "concurrent.futures.process")

MEMORY_BYTES = 6 << 30
"""What a mutant may ask for: some ask for all there is."""
MIN_CPU_S = 20.0
CPU_FACTOR = 4.0
"""A mutant that computes this many times as long as no mutant, and this at least, does not end."""
WALL_FACTOR = 15.0
MIN_WALL_S = 240.0
"""A mutant that waits for ever computes nothing; a busy machine must not look like that."""
BASELINE_CPU_S = 900.0

Reached = dict[str, tuple[float, frozenset[str]]]
"""By test: its duration [s] and the functions that it calls, ``file::qualified.name`` each."""


class Bench:
    """A copy of the project in which mutants are tried, one after the other."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in COPIED:
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("*.pyc"))
        shutil.copy(ROOT / "pyproject.toml", folder)
        # Compiled files are checked by content: a mutant may be as old and as long as its file.
        mode = PycInvalidationMode.CHECKED_HASH
        for name in PRODUCTION:
            compileall.compile_dir(folder / name, quiet=1, invalidation_mode=mode)
        environment = os.environ | {
            "PYTHONPATH": str(folder),
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
            "CI": "1",  # Hypothesis then draws the same examples every time
        }
        self._server = subprocess.Popen(
            [sys.executable, __file__],
            cwd=folder,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def close(self) -> None:
        """End the process that runs the tests."""
        self._server.stdin.close()
        self._server.wait()

    @contextlib.contextmanager
    def mutated(self, file: str, code: str):
        """Have another text in a file for a while."""
        path = self.folder / file
        original = path.read_bytes()
        path.write_text(code, "utf-8")
        try:
            yield
        finally:
            path.write_bytes(original)

    def run(self, tests: list[str], expected_s: float) -> int | None:
        """Exit status of pytest; None when the tests do not end."""
        return self._request(tests, max(MIN_CPU_S, CPU_FACTOR * expected_s), None)

    def record(self, file: str) -> Reached:
        """Run a file of tests on no mutant; what each test calls.

        Raises
        ------
        SystemExit
            When a test fails: it could judge no mutant.
        """
        path = self.folder / "reached.json"
        if self._request([file], BASELINE_CPU_S, str(path)) not in (0, 5):
            tail = (self.folder / "output.txt").read_text("utf-8", "replace")[-3000:]
            raise SystemExit(f"{tail}\n{file} fails without any mutant")
        return reached_from_json(json.loads(path.read_text("utf-8")))

    def _request(self, tests: list[str], cpu_s: float, reached: str | None) -> int | None:
        request = {"tests": tests, "cpu_s": cpu_s, "reached": reached}
        print(json.dumps(request), file=self._server.stdin, flush=True)
        return json.loads(self._server.stdout.readline())


def reached_from_json(table: dict) -> Reached:
    """Turn lists into sets."""
    return {test: (seconds, frozenset(called)) for test, (seconds, called) in table.items()}


def recorded(bench: Bench, files: list[str], stored: Path | None) -> Reached:
    """Record files of tests; those that are stored and have not changed are not run again."""
    known = _stored(stored)
    reached: Reached = {}
    for file in files:
        digest = hashlib.sha256((ROOT / file).read_bytes()).hexdigest()
        if known.get(file, [None])[0] != digest:
            started = time.monotonic()
            tests = bench.record(file)
            known[file] = [digest, {t: [s, sorted(called)] for t, (s, called) in tests.items()}]
            print(f"recorded {file}: {time.monotonic() - started:.1f} s", file=sys.stderr)
            if stored:  # another run may have added to it
                write_whole(stored, json.dumps(_stored(stored) | {file: known[file]}))
        reached |= reached_from_json(known[file][1])
    return reached


def _stored(path: Path | None) -> dict:
    return json.loads(path.read_text("utf-8")) if path and path.exists() else {}


def write_whole(path: Path, text: str) -> None:
    """Write a file that is there as a whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}.part")
    part.write_text(text, "utf-8")
    part.replace(path)


def function_at(source: str, line: int) -> str | None:
    """Qualified name of the function whose body has a line; None for what an import runs."""
    innermost = None
    stack = [(node, "") for node in ast.parse(source).body]
    while stack:
        node, prefix = stack.pop()
        inside = prefix
        if isinstance(node, ast.ClassDef):
            inside = f"{prefix}{node.name}."
        elif isinstance(node, ast.FunctionDef):
            if node.body[0].lineno <= line <= node.end_lineno:
                innermost = f"{prefix}{node.name}"
            inside = f"{prefix}{node.name}.<locals>."
        stack += [(child, inside) for child in ast.iter_child_nodes(node)]
    return innermost


class Recorder:
    """A plugin of pytest: the functions of the project that each test calls."""

    def __init__(self, folder: Path) -> None:
        self._prefix = f"{folder}/"
        self._codes: dict[int, object] = {}
        self.tests: dict[str, tuple[float, list[str]]] = {}

    def pytest_runtest_logstart(self, nodeid, location):
        """Begin with a test."""
        self._codes = {}
        self._started = time.process_time()
        threading.settrace(self._trace)
        sys.settrace(self._trace)

    def pytest_runtest_logfinish(self, nodeid, location):
        """Store what was called."""
        sys.settrace(None)
        threading.settrace(None)
        names = {self._name(code) for code in list(self._codes.values())} - {None}
        self.tests[nodeid] = (time.process_time() - self._started, sorted(names))

    def _trace(self, frame, event, argument):
        self._codes[id(frame.f_code)] = frame.f_code

    def _name(self, code) -> str | None:
        path = code.co_filename
        if not path.startswith(tuple(self._prefix + name for name in PRODUCTION)):
            return None
        parts = code.co_qualname.split(".<locals>.")
        while len(parts) > 1 and parts[-1].startswith("<"):
            parts.pop()
        return f"{path.removeprefix(self._prefix)}::{'.<locals>.'.join(parts)}"


def _serve() -> None:
    """Answer requests, a line of JSON each, with exit statuses, until the input ends."""
    sys.path[0] = os.getcwd()
    for name in PRELOADED:
        importlib.import_module(name)
    for line in sys.stdin:
        print(json.dumps(_forked(json.loads(line))), flush=True)


def _forked(request: dict) -> int | None:
    pid = os.fork()
    if pid == 0:
        status = 3
        try:
            status = _child(request)
        finally:
            os._exit(status)
    deadline = time.monotonic() + max(MIN_WALL_S, WALL_FACTOR * request["cpu_s"])
    try:
        while time.monotonic() < deadline:
            ended, status = os.waitpid(pid, os.WNOHANG)
            if ended:
                pid = ended
                code = os.waitstatus_to_exitcode(status)
                return None if code == -signal.SIGXCPU else code
            time.sleep(0.02)
        return None
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(pid, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):
            os.waitpid(pid, 0)


def _child(request: dict) -> int:
    """Run pytest in a process of its own."""
    import pytest

    os.setsid()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    cpu_s = int(request["cpu_s"]) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 5))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    output = os.open("output.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for number in (1, 2):
        os.dup2(output, number)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    recorder = Recorder(Path.cwd())
    plugins = [recorder] if request["reached"] else []
    every = ("-m", "not trains_detectors")  # those of `make test-all` too
    arguments = ["-x", "-q", "-p", "no:cacheprovider", *every, *request["tests"]]
    status = int(pytest.main(arguments, plugins=plugins))
    if request["reached"]:
        write_whole(Path(request["reached"]), json.dumps(recorder.tests))
    return status


def by_function(reached: Reached) -> dict[str, list[str]]:
    """Tests by the function that they call."""
    tests: dict[str, list[str]] = defaultdict(list)
    for test, (_, called) in reached.items():
        for name in called:
            tests[name].append(test)
    return tests


if __name__ == "__main__":
    _serve()
