"""Which tests share a processor, when `make test` gives them several."""

import pytest
from xdist.scheduler import LoadScopeScheduling

WINDOWS = "tests/blender/"
"""The folder whose tests open a real Blender's window: one at a time, and begun first."""


class Together(LoadScopeScheduling):
    """Keeps the tests of a file on one processor, and all those that open windows."""

    def _split_scope(self, nodeid):
        return WINDOWS if nodeid.startswith(WINDOWS) else nodeid.partition("::")[0]


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Hand tests out so."""
    return Together(config, log)


def pytest_collection_modifyitems(items):
    """Begin with those that open windows: they take longest."""
    items.sort(key=lambda item: not item.nodeid.startswith(WINDOWS))
