"""Workers of Dask keep freed memory, and take calls as before."""

import os
import platform
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from pe_core.search.processes import keep_freed_memory
from pe_tools.cli.cluster_executor import ClusterExecutor
from tests.engine.processes import ROOT

DASK = {"MALLOC_TRIM_THRESHOLD_": "65536"}
"""The environment in which Dask starts its workers."""
FAULTS = """
import resource, sys
import numpy as np
from pe_core.search.processes import keep_freed_memory
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


class Inner(ThreadPoolExecutor):
    """Stands for the executor of a Dask client."""

    _client = "the client"


def test_calls_their_results_and_errors_go_through():
    with ClusterExecutor(Inner(1)) as executor:
        assert executor._client == "the client"
        assert executor.submit(divmod, 17, 5).result() == (3, 2)
        assert executor.submit(int, "11", base=2).result() == 3
        with pytest.raises(ZeroDivisionError):
            executor.submit(divmod, 1, 0).result()


def test_another_c_library_is_no_error(monkeypatch):
    def no_library(_):
        raise OSError("no such library")

    keep_freed_memory.cache_clear()
    monkeypatch.setattr("ctypes.CDLL", no_library)
    assert not keep_freed_memory()
    keep_freed_memory.cache_clear()
