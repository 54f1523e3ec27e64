"""The command in this process, or in its own and watched line by line: signals at known places."""

import contextlib
import io
import subprocess
import sys
import threading
import warnings
from pathlib import Path
from types import SimpleNamespace

import pe_core
from pe_tools.cli.verbs import main
from tests.limits import HANG_S

ROOT = Path(pe_core.__file__).parent.parent
FEW_ERRORS = (
    "import dataclasses, importlib\n"
    "found = importlib.import_module('pe_core.search.tolerance')\n"
    "found.WORKSHOP = dataclasses.replace(found.WORKSHOP, draws=2)\n"
)
"""A search ends with the robustness of its result, which takes longer than a short search."""
TELL_ALL = (
    "from pe_tools.cli import progress_line\n"
    "progress_line.REPORT_EVERY_S = {True: 0.0, False: 0.0}\n"
)
"""Every step of a job is told, so that a test knows where it is."""
HANG = """
from pe_core.scoring.evaluator import Evaluator
import threading
plain, calls = Evaluator.score, []
def score(self, rig, **options):
    calls.append(rig)
    if len(calls) == {nth}:
        threading.Event().wait()
    return plain(self, rig, **options)
Evaluator.score = score
"""
"""The n-th full score never ends."""
ANALYSE = (
    "",
    (
        "import threading\n"
        "from pe_tools.jobs import optimize_job\n"
        "optimize_job.robustness = lambda *_, **__: threading.Event().wait()\n"
    ),
)
"""Whether the analysis of a search never ends."""
RUN = "from pe_tools.__main__ import main; main()"


def pe(arguments):
    """Run the command in this process: what it would print, warnings too, and its status."""
    out = io.StringIO()
    err = io.StringIO()
    streams = contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)
    with streams[0], streams[1], warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("default")
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as ended:  # wrong usage
            status = ended.code
    said = "".join(f"{each.category.__name__}: {each.message}\n" for each in warned)
    return SimpleNamespace(returncode=status, stdout=out.getvalue(), stderr=err.getvalue() + said)


def finished(job):
    """Drive a job to its end; return its outcome."""
    for _ in job:
        pass
    return job.outcome


class Command:
    """A running ``pe``; its stderr is read as it comes."""

    def __init__(self, arguments, hang_in_score=0, hangs=False, **options):
        script = FEW_ERRORS + TELL_ALL + HANG.format(nth=hang_in_score) + ANALYSE[hangs] + RUN
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
        self.process = subprocess.Popen(
            [sys.executable, "-c", script, *map(str, arguments)], cwd=ROOT, text=True, **options
        )
        self.lines: list[str] = []
        self._more = threading.Condition()
        self._ended = False
        if self.process.stderr is not None:
            threading.Thread(target=self._read, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def _read(self):
        for line in self.process.stderr:
            with self._more:
                self.lines.append(line)
                self._more.notify_all()
        with self._more:
            self._ended = True
            self._more.notify_all()

    def wait_for(self, is_it):
        """Wait for a line of stderr, and return it."""
        with self._more:
            found = self._more.wait_for(
                lambda: next(filter(is_it, self.lines), None) or self._ended, HANG_S
            )
        assert isinstance(found, str), "".join(self.lines)
        return found

    def wait_for_stage(self, stage):
        """Wait until a stage has begun."""
        return self.wait_for(lambda line: line.startswith(stage))

    def wait_for_better(self):
        """Wait until the search has found something better than the start."""
        start = self.wait_for_stage("optimizing").split()[-1]
        return self.wait_for(lambda line: "optimizing" in line and line.split()[-1] != start)

    def send(self, signum):
        """Send a signal."""
        self.process.send_signal(signum)

    def end(self):
        """Wait for the end; return the exit status."""
        status = self.process.wait(HANG_S)
        with self._more:
            self._more.wait_for(lambda: self._ended or self.process.stderr is None, HANG_S)
        return status

    @property
    def complaints(self):
        """What it said beside its progress."""
        return [line for line in self.lines if line.startswith("pe: ")]
