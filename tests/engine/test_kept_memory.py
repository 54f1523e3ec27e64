"""Workers keep freed memory, those of Dask, too."""

import os
import platform
import subprocess
import sys

import pytest

from pe_core.search.payload import keep_freed_memory
from tests.engine.processes import ROOT

DASK = {"MALLOC_TRIM_THRESHOLD_": "65536"}
"""The environment in which Dask starts its workers."""
FAULTS = """
import resource, sys
import numpy as np
from pe_core.search.payload import keep_freed_memory
assert "keep" not in sys.argv or keep_freed_memory()
def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
np.ones(1 << 17).sum()
before = faults()
for _ in range(100):
    np.ones(1 << 17).sum()
print(faults() - before)
"""
"""Prints how many pages the system makes for a hundred arrays of 1 MB, one after the other."""


def page_faults(*arguments):
    command = [sys.executable, "-c", FAULTS, *arguments]
    env = {**os.environ, **DASK}
    done = subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True, check=True)
    return int(done.stdout)


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="settings of glibc")
def test_arrays_of_a_worker_of_dask_are_not_paged_in_anew():
    assert page_faults() > 100 * 100
    assert page_faults("keep") < 1000


def test_another_c_library_is_no_error(monkeypatch):
    def no_library(_):
        raise OSError("no such library")

    keep_freed_memory.cache_clear()
    monkeypatch.setattr("ctypes.CDLL", no_library)
    assert not keep_freed_memory()
    keep_freed_memory.cache_clear()
