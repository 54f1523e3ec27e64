"""Which tests share a processor, when `make test` gives them several."""

import pytest

WINDOWS = "blender"
"""The folder whose tests open a real Blender's window: one at a time, and begun first."""


@pytest.hookimpl(tryfirst=True)  # before those who hand the tests out look for groups
def pytest_collection_modifyitems(items):
    """Keep the tests of a file together, and all those that open windows."""
    items.sort(key=lambda item: item.path.parent.name != WINDOWS)
    for item in items:
        folder = item.path.parent.name
        item.add_marker(pytest.mark.xdist_group(folder if folder == WINDOWS else str(item.path)))
