"""The executor of a Dask cluster: its workers get the payload once, and keep freed memory.

A payload that tasks depend on would be sent many times: every two seconds Dask's memory manager
drops all copies but one. A plugin brings it to each worker once, to those that join later, too.

Dask starts its workers with ``MALLOC_TRIM_THRESHOLD_=65536``. With that, glibc also gives back
every array of 128 kB and more when it is freed. The system then makes and zeroes the pages of the
next one, which takes twice as long as the evaluation itself.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from contextlib import suppress
from typing import Any, TypeVar

from pe_core.base.plugins import optional_package
from pe_core.search.payload import receive
from pe_core.search.processes import keep_freed_memory

T = TypeVar("T")


def with_kept_memory(function: Callable[..., T], *args: Any, **kwargs: Any) -> T:
    """Call a function in a worker that keeps freed memory."""
    keep_freed_memory()
    return function(*args, **kwargs)


def payload_plugin(key: str, data: bytes) -> Any:
    """Return a plugin that brings a payload to each worker of a cluster."""
    distributed = optional_package("distributed")
    assert distributed is not None, "a client of Dask asks for it"

    class PayloadPlugin(distributed.WorkerPlugin):  # type: ignore[name-defined,misc]
        """Has a worker keep a payload."""

        def setup(self, worker: Any) -> None:
            """Keep it: called in each worker, before its first task if it joins later."""
            receive(key, data)

    return PayloadPlugin()


class ClusterExecutor(Executor):
    """The executor of a Dask client.

    Parameters
    ----------
    executor : distributed.cfexecutor.ClientExecutor
    """

    def __init__(self, executor: Any) -> None:
        self._executor, self._client = executor, executor._client
        self._plugin = ""

    def start_with(self, key: str, data: bytes) -> None:
        """Have all workers keep a payload, those that join later, too."""
        self._plugin = f"payload of {self._client.id}"  # of this name the newest alone stays
        self._client.register_plugin(payload_plugin(key, data), self._plugin)

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Call a function in a worker."""
        future: Future[T] = self._executor.submit(with_kept_memory, fn, *args, **kwargs)
        return future

    def withdraw(self) -> None:
        """Have the scheduler forget the payload; the workers of today keep it."""
        if self._plugin and self._client.status == "running":
            with suppress(Exception):  # a scheduler that ends meanwhile has nothing to forget
                self._client.unregister_worker_plugin(self._plugin)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End; the cluster goes on."""
        self._executor.shutdown(wait)
