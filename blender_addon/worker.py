"""Work beside the window: a thread a worker, the latest request of each topic, results by a timer.

All that is computed beside the window is asked for here, jobs included.

Work is requested by topic. A request that has not begun when the next one of its topic comes is
dropped: nothing queues up behind the mouse. Results are delivered by a timer, on the main thread,
where Blender's data may be read and written. Without a window, work is done at once: there is no
timer then.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from typing import Any

import bpy

POLL_S = 0.005
"""How often the timer looks for results, while one is awaited."""
JOIN_TIMEOUT_S = 5.0
"""How long unregistering waits for work in progress."""

WorkerTask = Callable[[], Any]
Deliver = Callable[[Any], None]
Fail = Callable[[Exception], None]


class Worker:
    """One thread: started at the first request, ended by `stop`."""

    def __init__(self) -> None:
        self._pending: dict[str, tuple[WorkerTask, Deliver, Fail]] = {}
        self._done: list[tuple[str, Callable[[], None]]] = []
        self._generation: dict[str, int] = {}
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None
        self._in_progress: str | None = None
        self._end = threading.Event()
        self._timer = self._deliver_all  # one object: Blender knows timers by it

    def ask(self, topic: str, work: WorkerTask, deliver: Deliver, fail: Fail) -> None:
        """Run `work` on the thread, and deliver its result on the main thread.

        A request of the same topic that has not begun is dropped; the result of one in progress is
        delivered all the same: it is the latest there is. `fail` takes what `work` raised.
        """
        if bpy.app.background:
            _run_task(work, deliver, fail)()
            return
        with self._changed:
            self._pending.pop(topic, None)  # the latest goes last: other topics have waited longer
            self._pending[topic] = work, deliver, fail
            self._start()
            self._changed.notify()
        if not bpy.app.timers.is_registered(self._timer):
            bpy.app.timers.register(self._timer, first_interval=POLL_S, persistent=True)

    def drop(self, topic: str) -> None:
        """Drop the request of a topic; a result in progress is not delivered any more."""
        with self._changed:
            self._pending.pop(topic, None)
            self._generation[topic] = self._generation.get(topic, 0) + 1
            self._done = [each for each in self._done if each[0] != topic]

    def busy(self, topic: str | None = None) -> bool:
        """Whether a result is awaited, of a topic or of any."""
        with self._changed:
            topics = {*self._pending, *(t for t, _ in self._done), self._in_progress} - {None}
        return bool(topics) if topic is None else topic in topics

    def awaits(self, beginning: str) -> bool:
        """Whether a result is awaited of a topic that begins so."""
        with self._changed:
            topics = (*self._pending, *(topic for topic, _ in self._done), self._in_progress or "")
            return any(topic.startswith(beginning) for topic in topics)

    def stop(self) -> None:
        """Drop all requests and results, and end the thread after the work in progress."""
        with self._changed:
            self._pending.clear()
            self._done.clear()
            self._end.set()
            self._changed.notify()
        if self._thread is not None:
            self._thread.join(JOIN_TIMEOUT_S)  # a longer one ends later, without effect
        self._thread, self._in_progress = None, None
        if bpy.app.timers.is_registered(self._timer):
            bpy.app.timers.unregister(self._timer)

    def _start(self) -> None:
        if self._thread is None:
            self._end = threading.Event()
            self._thread = threading.Thread(target=self._run, args=(self._end,), daemon=True)
            self._thread.start()

    def _run(self, end: threading.Event) -> None:
        """Run requests, the topic that has waited longest first, until `stop`."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._pending or end.is_set())
                if end.is_set():
                    return
                topic = self._in_progress = next(iter(self._pending))
                work, deliver, fail = self._pending.pop(topic)
                number = self._generation.get(topic, 0)
            result = _run_task(work, deliver, fail)
            with self._changed:
                if end.is_set():
                    return
                self._in_progress = None
                if number == self._generation.get(topic, 0):
                    self._done.append((topic, result))

    def _deliver_all(self) -> float | None:
        """Deliver results; the timer ends when none is awaited."""
        with self._changed:
            results, self._done = self._done, []
        for _, deliver in results:
            deliver()
        return POLL_S if self.busy() else None


def _run_task(work: WorkerTask, deliver: Deliver, fail: Fail) -> Callable[[], None]:
    """Run a task; return the function that delivers its result."""
    try:
        result = work()
    except Exception as error:  # whatever it is, `fail` has to know
        return functools.partial(fail, error)
    return lambda: deliver(result)


background_worker = Worker()
"""For what may take long; all parts of the add-on share it, and take turns."""
interactive_worker = Worker()
"""For what follows the mouse and takes a few hundredths of a second: it never waits."""
job_worker = Worker()
"""For jobs that a button starts, one at a time."""


def unregister() -> None:
    """End all threads."""
    for each in (job_worker, interactive_worker, background_worker):
        each.stop()
