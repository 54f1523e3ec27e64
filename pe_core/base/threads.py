"""What a process has that computes: threads, locks, and the memory that it keeps.

Imported by `lazy_threads` alone.
"""

import ctypes
from concurrent.futures import ThreadPoolExecutor as ThreadPoolExecutor
from contextlib import suppress
from functools import cache
from threading import RLock as RLock
from threading import Thread as Thread
from threading import local as local

KEPT_BYTES = {-1: 1 << 28, -3: 1 << 25}
"""glibc's M_TRIM_THRESHOLD and M_MMAP_THRESHOLD of a worker: the pages of each array are not made
anew, which takes a tenth of a search's time; with the thresholds that Dask sets, half [bytes]."""


@cache
def keep_freed_memory() -> bool:
    """Have this process keep freed memory; False where its C library is not glibc."""
    with suppress(AttributeError, OSError, TypeError):
        mallopt = ctypes.CDLL(None).mallopt
        return all([mallopt(parameter, size) == 1 for parameter, size in KEPT_BYTES.items()])
    return False
