"""Work beside the window: a thread, the latest wish of each topic, answers in Blender's own turn.

Whoever draws or shows asks for work by topic. A wish that has not begun when the next one of its
topic comes is forgotten: nothing queues up behind the mouse. Answers are handed over by a timer,
where data of Blender may be touched. Without a window, work is done at once: there is no timer
then, and nobody drags.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import bpy

POLL_S = 0.005
"""How often it is asked whether an answer is there, while one is awaited."""
PATIENCE_S = 5.0
"""How long the end of the add-on waits for work that is under way."""

Errand = Callable[[], Any]
Deliver = Callable[[Any], None]
Fail = Callable[[Exception], None]


class Worker:
    """One thread, made when first asked for something, ended by `stop`."""

    def __init__(self) -> None:
        self._wanted: dict[str, tuple[Errand, Deliver, Fail]] = {}
        self._done: list[tuple[str, Callable[[], None]]] = []
        self._round: dict[str, int] = {}
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None
        self._under_way: str | None = None
        self._end = threading.Event()
        self._timer = self._hand_over  # one object: Blender knows timers by it

    def ask(self, topic: str, work: Errand, deliver: Deliver, fail: Fail) -> None:
        """Have `work` done off the main thread, and its answer delivered on it.

        What was asked on the same topic and has not begun is forgotten; of what is under way the
        answer is delivered all the same: the newest there is. `fail` takes what `work` raised.
        """
        if bpy.app.background:
            _answer(work, deliver, fail)()
            return
        with self._changed:
            self._wanted.pop(topic, None)  # the newest comes last: other topics have waited longer
            self._wanted[topic] = work, deliver, fail
            self._start()
            self._changed.notify()
        if not bpy.app.timers.is_registered(self._timer):
            bpy.app.timers.register(self._timer, first_interval=POLL_S, persistent=True)

    def drop(self, topic: str) -> None:
        """Forget what was asked on a topic; an answer under way is not delivered any more."""
        with self._changed:
            self._wanted.pop(topic, None)
            self._round[topic] = self._round.get(topic, 0) + 1
            self._done = [each for each in self._done if each[0] != topic]

    def busy(self, topic: str | None = None) -> bool:
        """Whether an answer is awaited, on a topic or on any."""
        with self._changed:
            topics = {*self._wanted, *(t for t, _ in self._done), self._under_way} - {None}
        return bool(topics) if topic is None else topic in topics

    def awaits(self, beginning: str) -> bool:
        """Whether an answer is awaited on a topic that begins so."""
        with self._changed:
            topics = (*self._wanted, *(topic for topic, _ in self._done), self._under_way or "")
            return any(topic.startswith(beginning) for topic in topics)

    def stop(self) -> None:
        """Forget all wishes and answers, and end the thread, after what it has under way."""
        with self._changed:
            self._wanted.clear()
            self._done.clear()
            self._end.set()
            self._changed.notify()
        if self._thread is not None:
            self._thread.join(PATIENCE_S)  # one that takes longer ends by itself, unheard
        self._thread, self._under_way = None, None
        if bpy.app.timers.is_registered(self._timer):
            bpy.app.timers.unregister(self._timer)

    def _start(self) -> None:
        if self._thread is None:
            self._end = threading.Event()
            self._thread = threading.Thread(target=self._run, args=(self._end,), daemon=True)
            self._thread.start()

    def _run(self, end: threading.Event) -> None:
        """Work off wishes, the oldest topic first, until the end is asked for."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._wanted or end.is_set())
                if end.is_set():
                    return
                topic = self._under_way = next(iter(self._wanted))
                work, deliver, fail = self._wanted.pop(topic)
                number = self._round.get(topic, 0)
            answer = _answer(work, deliver, fail)
            with self._changed:
                if end.is_set():
                    return
                self._under_way = None
                if number == self._round.get(topic, 0):
                    self._done.append((topic, answer))

    def _hand_over(self) -> float | None:
        """Deliver answers; the timer ends when none is awaited."""
        with self._changed:
            answers, self._done = self._done, []
        for _, deliver in answers:
            deliver()
        return POLL_S if self.busy() else None


def _answer(work: Errand, deliver: Deliver, fail: Fail) -> Callable[[], None]:
    """Do the work; return how its answer is handed over."""
    try:
        found = work()
    except Exception as error:  # whatever it is, the one who asked has to know
        return lambda problem=error: fail(problem)
    return lambda: deliver(found)


desk = Worker()
"""The one that all parts of the add-on share: so that they take turns, and one thread ends."""
hand = Worker()
"""For what follows the hand, and is done in a few hundredths of a second: it is not kept waiting by
what takes longer."""


def unregister() -> None:
    """Leave nothing running."""
    hand.stop()
    desk.stop()
