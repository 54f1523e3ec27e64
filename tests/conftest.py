"""Which tests share a processor when `make test` gives them several, and what each may take."""

import os

import pytest
from xdist.scheduler import LoadScopeScheduling

from tests.limits import (
    heeded_signals,
    pytest_runtest_call,
    pytest_runtest_setup,
    pytest_runtest_teardown,
)

__all__ = [
    "heeded_signals",
    "pytest_runtest_call",
    "pytest_runtest_setup",
    "pytest_runtest_teardown",
]

WINDOWS = "tests/blender/"
"""The folder whose tests open a real Blender's window: one at a time, and begun first."""
ORDER = (WINDOWS, "tests/review/", "tests/studies/", "tests/addon/", "tests/engine/")
"""Folders whose files take long come first; the many short files at the end level the load."""


class Together(LoadScopeScheduling):
    """Keeps the tests of a file on one processor, and all those that open windows.

    When a process dies, xdist 3.8 gives away all that the process was ever given: finished files,
    which no process can finish again, and the test that ended it. Then xdist waits for ever
    (pytest-dev/pytest-xdist, issues 1327 and 1378). Here one test fails and the others go on.
    """

    def _split_scope(self, nodeid):
        file = nodeid.partition("::")[0]
        return WINDOWS if nodeid.startswith(WINDOWS) else file

    def remove_node(self, node):
        work = self.assigned_work.pop(node)
        crashed = next((test for tests in work.values() for test in tests if not tests[test]), None)
        for file, tests in reversed(work.items()):
            left = {test: False for test in tests if not tests[test] and test != crashed}
            if left:
                self.workqueue[file] = left
                self.workqueue.move_to_end(file, last=False)
        for other in self.assigned_work:
            self._reschedule(other)
        return crashed

    def _reschedule(self, node):
        # A process keeps its last test waiting for another one: a file of one test is too few.
        while not node.shutting_down and self._pending_of(self.assigned_work[node]) <= 2:
            if not self.workqueue:
                node.shutdown()
                return
            self._assign_work_unit(node)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Hand tests out so."""
    return Together(config, log)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config):
    """One more than there are processors: tests with windows mostly wait for Blender to draw."""
    return min(os.cpu_count() or 1, 4) + 1


def pytest_collection_modifyitems(items):
    """Begin with those that open windows: they take longest. Those that spend one are the last."""
    rank = {folder: place for place, folder in enumerate(ORDER)}

    def place(item):
        folder = "/".join(item.nodeid.split("/")[:2]) + "/"
        return rank.get(folder, len(rank)), "spent_stage" in getattr(item, "fixturenames", ())

    items.sort(key=place)
