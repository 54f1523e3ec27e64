"""Workers of Dask keep freed memory: without it, each array of a candidate is paged in anew.

Dask starts its workers with ``MALLOC_TRIM_THRESHOLD_=65536``. With that, glibc also gives back
every array of 128 kB and more when it is freed. The system then makes and zeroes the pages of the
next one, which takes twice as long as the evaluation itself.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any, TypeVar

from pe_core.search.processes import keep_freed_memory

T = TypeVar("T")


def with_kept_memory(function: Callable[..., T], *args: Any, **kwargs: Any) -> T:
    """Call a function in a worker that keeps freed memory."""
    keep_freed_memory()
    return function(*args, **kwargs)


class KeptMemory(Executor):
    """An executor of Dask whose workers keep freed memory.

    Parameters
    ----------
    executor : distributed.cfexecutor.ClientExecutor
    """

    def __init__(self, executor: Any) -> None:
        self._executor = executor
        self._client = executor._client  # by which a search sends its payload

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Call a function in a worker."""
        future: Future[T] = self._executor.submit(with_kept_memory, fn, *args, **kwargs)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End; the cluster goes on."""
        self._executor.shutdown(wait)
