"""What tests of the engine and of the tools share."""

import os
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.example_plugin import EXAMPLE_PLUGIN, PLUGIN_SITE
from tests.few_errors import few_errors

__all__ = ["EXAMPLE_PLUGIN", "few_errors"]


@pytest.fixture
def failing_call(monkeypatch):
    """A function that has a system call fail from its n-th call on, and counts how often it did.

    With `once` only that call fails, as where another file could be removed to make room.
    """

    def fail(name, number, first=1, once=False):
        real, count = getattr(os, name), SimpleNamespace(calls=0, fired=0)

        def call(*args, **options):
            count.calls += 1
            if count.calls < first or (once and count.fired):
                return real(*args, **options)
            count.fired += 1
            raise OSError(number, os.strerror(number))

        monkeypatch.setattr(os, name, call)
        return count

    return fail


CHECKOUT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def example_plugin():
    """Return the folder that installs `examples/plugin`, as the session has it."""
    return PLUGIN_SITE
