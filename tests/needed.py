"""What a test needs of the machine: without it, it is skipped; with CI=true it fails."""

import os

import pytest


def unavailable(reason: str):
    """Skip, or fail where everything is meant to be there: nobody reads the skips of a CI run."""
    if os.environ.get("CI") == "true":
        pytest.fail(f"CI=true, and {reason}", pytrace=False)
    pytest.skip(reason)
