"""In the engine's process: runs requests, the latest of each topic, and sends back results.
Requests of one lane run one after the other, those of different lanes side by side: what follows
the mouse never waits for a map. The process ends when the other side is gone."""

import pickle
import threading
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import Connection
from typing import Any

from pe_core.base.lazy_threads import threads
from pe_core.base.spawning import belong_to_parent, end_process

from .messages import CANCEL, FAILED, FORGET, Request, packed, received, steps_of, unpacked


@dataclass(slots=True)
class _RunningRequest:
    """A request as it is run: a job can be cancelled, before it begins as well. `numbers` are those
    of the shared objects of the request, by their `id`."""

    number: int
    topic: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    numbers: dict[int, int]
    running: Any = None
    cancels: list[bool] = field(default_factory=list)

    def cancel(self, drop: bool) -> None:
        """Have a job end at its next step, with what it has found unless it is dropped."""
        self.cancels.append(drop)
        if hasattr(self.running, "cancel"):
            self.running.cancel(drop)

    def steps(self) -> Iterator[tuple[str, Any]]:
        """Run it; yield the steps of a job, and the result."""
        self.running = self.function(*self.arguments)
        for drop in self.cancels if hasattr(self.running, "cancel") else ():
            self.running.cancel(drop)
        for step in steps_of(self.running):
            yield step
            if True in self.cancels and not hasattr(self.running, "cancel"):
                return  # dropped: nobody waits for the rest


class _Lane(threading.Thread):
    """Runs the calls of a lane; of each topic the latest, the one that waits longest first."""

    def __init__(self, send: Callable[[_RunningRequest, str, Any], None]) -> None:
        super().__init__(daemon=True)
        self._send = send
        self._changed = threading.Condition()
        self._waiting: dict[str, _RunningRequest] = {}
        self._running: _RunningRequest | None = None

    def put(self, call: _RunningRequest) -> None:
        """Take a call; one of its topic that has not begun is dropped."""
        with self._changed:
            self._waiting.pop(call.topic, None)
            self._waiting[call.topic] = call
            self._changed.notify()

    def cancel(self, topic: str, drop: bool) -> None:
        """Have a topic's calls end at their next step; with `drop`, one that waits never begins."""
        with self._changed:
            if drop:
                self._waiting.pop(topic, None)
            for call in (self._waiting.get(topic), self._running):
                if call is not None and call.topic == topic:
                    call.cancel(drop)

    def run(self) -> None:
        """Run calls until the process ends."""
        while True:
            with self._changed:
                self._running = None
                self._changed.wait_for(lambda: self._waiting)
                call = self._running = self._waiting.pop(next(iter(self._waiting)))
            try:
                for kind, content in call.steps():
                    self._send(call, kind, content)
            except BaseException as error:  # the other side has to know, whatever it is
                self._send(call, FAILED, error)


class _Server:
    """This side of the connections: requests come by one, answers go by the other."""

    def __init__(self, requests: Connection, answers: Connection) -> None:
        self._requests = requests
        self._answers = answers
        self._sending = threading.Lock()
        self._shared: dict[int, Any] = {}
        self._inside: dict[int, dict[int, int]] = {}
        """The numbers of the shared objects in a shared object, by their `id`."""
        self._lanes: dict[str, _Lane] = {}

    def serve(self) -> None:
        """Take messages until the other side is gone."""
        while True:
            try:
                message = received(self._requests)
            except (EOFError, OSError):
                return
            if isinstance(message, Request):
                self._begin(message)
                continue
            kind, content = message
            if kind == CANCEL:
                for lane in self._lanes.values():
                    lane.cancel(*content)
            elif kind == FORGET:
                for number in content:
                    self._shared.pop(number, None)
                    self._inside.pop(number, None)
            else:
                function, arguments = content
                try:
                    function(*arguments)
                except Exception:  # requests that need it tell what is missing
                    traceback.print_exc()

    def _begin(self, request: Request) -> None:
        call = _RunningRequest(request.number, request.topic, tuple, arguments=(), numbers={})
        try:
            for number, (data, arrays) in request.shared.items():
                own = self._inside[number] = {}
                self._shared[number] = unpacked(data, partial(self._object, own), arrays)
            named = unpacked(request.call, partial(self._object, call.numbers))
            call.function, call.arguments = named
        except Exception as error:  # a class that is not known here, too little memory
            self._send(call, FAILED, error)
            return
        if request.lane not in self._lanes:
            self._lanes[request.lane] = _Lane(self._send)
            self._lanes[request.lane].start()
        self._lanes[request.lane].put(call)

    def _object(self, used: dict[int, int], number: int) -> Any:
        """Return a shared object, and note it and those in it as used."""
        used |= {id(self._shared[number]): number, **self._inside[number]}
        return self._shared[number]

    def _send(self, call: _RunningRequest, kind: str, content: Any) -> None:
        """Send an answer; objects that came with the request go back as their numbers."""
        if kind == FAILED:
            content.add_note("".join(traceback.format_exception(content)))
        try:
            data = packed(content, lambda part: call.numbers.get(id(part)))
        except Exception as error:  # an error or a result that cannot be pickled
            kind = FAILED
            data = packed(RuntimeError(f"{content!r}: {error}"), lambda _: None)
        header = pickle.dumps((call.number, call.topic, kind))
        try:
            with self._sending:
                self._answers.send_bytes(header)
                self._answers.send_bytes(data)
        except OSError:
            end_process()


def serve(requests: Connection, answers: Connection) -> None:
    """Serve the other side of two connections; the process ends when that is gone."""
    belong_to_parent()
    threads().keep_freed_memory()
    _Server(requests, answers).serve()
    end_process()
