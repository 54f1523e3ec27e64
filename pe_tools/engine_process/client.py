"""The engine's process as the window's side sees it: no call waits for the engine. The process
starts at the first request. Where it is killed it is started anew, and what it was asked is asked
once more."""

import multiprocessing
import pickle
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pickle import PickleBuffer
from typing import Any, NamedTuple

from pe_core.base.errors import InputError
from pe_core.base.files import reason_of
from pe_core.base.spawning import (
    beginning,
    packages_around,
    pipe_errors,
    starting_processes,
    without_main,
)

from .messages import (
    CANCEL,
    FAILED,
    FORGET,
    SET_UP,
    STEP,
    PackedObject,
    Request,
    Writer,
    packed,
    steps_of,
    unpacked,
)

FOLLOWS_MOUSE = "mouse"
BEHIND = "behind"
"""Lanes: one that never waits for what takes long, and one for all else."""
END_S = 1.0
"""A process that has not ended by itself after this time is killed; one that begins, at once."""
SEND_S = 0.002
"""How long a large request may keep the caller busy each time that results are asked for [s]."""
Take = Callable[[Any], None]
EngineCall = tuple[Callable[..., Any], tuple[Any, ...]]


class EngineEnded(InputError):
    """The engine's process ended twice in the middle of the same request, or none can start."""

    def __init__(self, found: str) -> None:
        super().__init__("engine", "process", "one that runs until it answers", found)


@dataclass(slots=True, eq=False)
class _Awaited:
    """A request without an answer, and what becomes of the answer."""

    number: int
    lane: str
    call: EngineCall
    deliver: Take
    fail: Take
    step: Take | None
    shared: dict[int, object] = field(default_factory=dict)
    again: bool = False
    cancels: int = 0


class _Sent(NamedTuple):
    """An object that the engine has: held, so that no other gets its `id`; and those in it."""

    number: int
    part: object
    inside: dict[int, object]


class _SharedObjects:
    """The objects that the engine has, by number; of each type those that were used last."""

    def __init__(self, most: Mapping[type, int]) -> None:
        self._most = most
        self._last = 0
        self._known: dict[type, dict[int, _Sent]] = {kind: {} for kind in most}

    def call(self, each: _Awaited) -> tuple[bytes, dict[int, PackedObject]]:
        """Return a call, pickled, and the shared objects in it that the engine does not have.
        Raises whatever its function and arguments raise where they cannot be pickled."""
        new: dict[int, PackedObject] = {}

        def number_of(part: object, noted: dict[int, object], inside: object = None) -> int | None:
            known = self._known.get(type(part))
            if known is None or part is inside:
                return None
            sent = known.pop(id(part), None)
            if sent is None:
                self._last += 1
                sent = _Sent(self._last, part, {})
                own = sent.inside
                arrays = list[PickleBuffer]()
                data = packed(part, lambda inner: number_of(inner, own, part), arrays)
                new[sent.number] = PackedObject(data, arrays)
            known[id(part)] = sent
            noted |= {sent.number: part, **sent.inside}
            return sent.number

        try:
            data = packed(each.call, lambda part: number_of(part, each.shared))
        except Exception:
            for known in self._known.values():  # the engine never got them
                for key in [key for key, sent in known.items() if sent.number in new]:
                    del known[key]
            raise
        return data, dict(sorted(new.items(), reverse=True))  # what is inside comes first

    def forgotten(self) -> list[int]:
        """Forget what was used longest ago; return its numbers."""
        numbers = []
        for kind, known in self._known.items():
            for key in list(known)[: -self._most[kind]]:
                numbers.append(known.pop(key).number)
        return numbers


class EngineProcess:
    """The engine's process: the latest request of each topic. `shared`: returns types of objects
    that are sent once, and how many of each the engine keeps. Such an object must not change. It is
    called when the process starts. `setup`: returns a function and its arguments, which the engine
    calls before a request where they are others than before the last one. `packages`: packages of
    the caller whose first lines the engine must not run."""

    def __init__(
        self,
        shared: Callable[[], Mapping[type, int]],
        setup: Callable[[], EngineCall] = lambda: (tuple, ()),
        packages: Sequence[str] = (),
    ) -> None:
        self._shared_types = shared
        self._setup = setup
        self._packages = packages
        self._set_up: EngineCall | None = None
        self._process: Any = None
        self._answers: Any = None
        self._writer: Any = None
        self._awaited: dict[str, list[_Awaited]] = {}
        self._come: list[tuple[int, str, str, bytes]] = []
        """Number, topic, kind and content of answers that are not delivered yet."""
        self._number = 0
        self._is_up = False
        self._shared = _SharedObjects({})

    def ask(
        self,
        topic: str,
        function: Callable[..., Any],
        arguments: tuple[Any, ...],
        deliver: Take,
        fail: Take,
        *,
        step: Take | None = None,
        lane: str = BEHIND,
    ) -> None:
        """Have the engine call a function of a module; `deliver` takes its result. A request of the
        topic that has not begun is dropped; the result of one in progress is delivered all the
        same: it is the latest there is. `fail` takes what the function raised. A function that
        returns an iterator is a job: `step` takes what it yields, `deliver` what it returns."""
        self._number += 1
        each = _Awaited(self._number, lane, (function, arguments), deliver, fail=fail, step=step)
        self._awaited.setdefault(topic, []).append(each)
        self._send_request(topic, each)

    def begin(self) -> None:
        """Start the process where there is none, and have it take what `setup` returns.
        `EngineEnded` where none can be started: too little memory, too many open files."""
        if self._process is None:
            try:
                self._start()
            except OSError as error:
                raise EngineEnded(f"none could be started: {reason_of(error)}") from error
        if self._set_up != (wanted := self._setup()):
            self._set_up = wanted
            self._send((SET_UP, wanted))

    def cancel(self, topic: str) -> None:
        """Call `cancel` of a topic's job; its result is delivered all the same."""
        for each in self._awaited.get(topic, ()):
            each.cancels += 1
        if topic in self._awaited:
            self._send((CANCEL, (topic, False)))

    def drop(self, topic: str) -> None:
        """Drop the requests of a topic: nothing of them is delivered any more."""
        if self._awaited.pop(topic, None):
            self._send((CANCEL, (topic, True)))

    def busy(self, beginning: str = "") -> bool:
        """Whether a result is awaited, of a topic that begins so."""
        return any(topic.startswith(beginning) for topic in self._awaited)

    @property
    def pid(self) -> int | None:
        """Number of the process; None where there is none."""
        return None if self._process is None else self._process.pid

    def deliver_all(self, *beginnings: str) -> bool:
        """Send what waits, and deliver what has come; return whether either is left.

        With `beginnings` of topics, others wait for the next call without, which also finds out
        whether the process was killed."""
        killed = False
        self._flush()
        try:
            while self._answers is not None and self._answers.poll():
                head = pickle.loads(self._answers.recv_bytes())
                self._come.append((*head, self._answers.recv_bytes()))
                self._is_up = True
        except (EOFError, OSError):
            killed = True
        for each in [each for each in self._come if each[1].startswith(beginnings or "")]:
            self._come.remove(each)  # before: who takes it may raise
            self._deliver(*each)
        if killed and not beginnings:
            self._ask_again()
        return bool(self._awaited) or (self._writer is not None and self._writer.is_waiting)

    def stop(self) -> None:
        """Drop everything, and end the process."""
        self._awaited.clear()
        self._come.clear()
        if self._process is not None:
            self._end_process(END_S if self._is_up else 0.0)

    def _deliver(self, number: int, topic: str, kind: str, data: bytes) -> None:
        waiting = self._awaited.get(topic, [])
        each = next((each for each in waiting if each.number == number), None)
        if each is None:  # dropped
            return
        try:
            content = unpacked(data, each.shared.__getitem__)
        except Exception as error:  # too little memory for it
            kind = FAILED
            content = error
        if kind == STEP:
            if each.step is not None:
                each.step(content)
            return
        later = [other for other in waiting if other.number > number]
        if later:
            self._awaited[topic] = later
        else:
            del self._awaited[topic]
        (each.fail if kind == FAILED else each.deliver)(content)

    def _ask_again(self) -> None:
        """The process was killed: start another, and ask it what this one was asked last."""
        self._end_process(END_S)
        for topic, waiting in list(self._awaited.items()):
            latest = waiting[-1]
            if latest.again:
                del self._awaited[topic]
                latest.fail(EngineEnded("one ended twice"))
            else:
                latest.again = True
                self._awaited[topic] = [latest]
                self._send_request(topic, latest)
                for _ in range(latest.cancels):
                    self._send((CANCEL, (topic, False)))

    def _end_process(self, patience_s: float) -> None:
        self._writer.close()  # for the process the sign to end
        self._answers.close()
        self._process.join(patience_s)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._process = self._answers = self._writer = None

    def _send_request(self, topic: str, each: _Awaited) -> None:
        try:
            self.begin()
            call, new = self._shared.call(each)
        except Exception as error:
            del self._awaited[topic]  # of what was asked before nothing is wanted any more
            each.fail(error)
            return
        self._send(Request(each.number, topic, each.lane, call, shared=new))
        if numbers := self._shared.forgotten():
            self._send((FORGET, numbers))

    def _send(self, message: object) -> None:
        # Where the process was killed, `deliver_all` finds that out.
        with suppress(OSError), pipe_errors():
            self._writer.put(message)

    def _flush(self) -> None:
        if self._writer is not None and self._writer.is_waiting:
            with suppress(OSError), pipe_errors():
                self._writer.flush(SEND_S)

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._shared = _SharedObjects(self._shared_types())
        self._set_up = None
        self._is_up = False
        own = [(name, sys.modules[name].__path__[0]) for name in self._packages]
        module = f"{__package__}.server"
        code = beginning(module, "serve", [*packages_around(), *own])
        requests, writing = context.Pipe(duplex=False)
        reading, answers = context.Pipe(duplex=False)
        with requests, answers:
            process = context.Process(target=exec, args=(code, {"arguments": (requests, answers)}))
            try:
                with without_main(), starting_processes(), pipe_errors():
                    process.start()
            except BaseException:
                writing.close()
                reading.close()
                raise
        self._process = process
        self._answers = reading
        self._writer = Writer(writing)


def call_here(
    function: Callable[..., Any],
    arguments: tuple[Any, ...],
    deliver: Take,
    fail: Take,
    step: Take | None = None,
) -> None:
    """Call a function here and now, as the engine's process would."""
    try:
        for kind, found in steps_of(function(*arguments)):
            if kind == STEP and step is not None:
                step(found)
    except Exception as error:  # whatever it is, `fail` has to know
        fail(error)
    else:
        deliver(found)
