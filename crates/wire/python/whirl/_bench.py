"""A running bench: its steps, its settings, what happens on it, and changes that are asked of it."""

from __future__ import annotations

import ctypes
import os
import time
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import iceoryx2
import numpy as np

from . import _settings
from ._block import Block
from ._control import Controller
from ._root import NoBench, Root, WhirlError, fnv
from .messages import SCHEMA, SCHEMA_ATTRIBUTE, Answer as _AnswerMessage
from .messages import BenchStatus, DocumentHead, MAX_DOCUMENT, Request
from .messages import Event as _EventMessage

#: How long to sleep where nothing has come: a bench wakes up once a millisecond at most.
_NAP = 0.001
#: How often to look whether the bench is still there.
_LOOK = 0.5
#: How long what a bench makes when it starts is waited for.
_STARTING = 1.0
#: What has happened, by the number of its kind.
KINDS = (
    "", "started", "settings", "refused", "impulse", "restarted", "tripped", "late", "note", "ended", "excited", "excitation over",
)  # fmt: skip


class Refused(WhirlError):
    """The bench did not accept a change; the reason is the text."""


@dataclass(frozen=True)
class Answer:
    """What became of a change that was accepted."""

    #: The revision of the settings now in force.
    revision: int
    #: The first step made with it.
    step: int
    #: Time of the rotor then.
    tau: float


@dataclass(frozen=True)
class Event:
    """One thing that has happened."""

    #: Number in its run: 1 is the start.
    number: int
    #: ``settings``, ``tripped``, ``note`` ...; ``kind N`` of one that this version does not know.
    kind: str
    #: The step, and the time of the rotor.
    step: int
    tau: float
    who: str
    why: str
    #: What a note says, why something was refused, the tones of an excitation.
    text: str
    #: Revision of the settings in force after it.
    revision: int
    run_id: int


def attach(bench: str = "default", root: Root | str | os.PathLike[str] | None = None, patience: float = 1.0) -> Bench:
    """Attaches to a running bench, which may be just starting.

    :param bench: its name.
    :param root: where benches live, if not where the environment says: see :class:`Root`.
    :param patience: seconds to wait for it.
    :raises WhirlError: no such bench, another version, or no room for another reader.
    """
    found = root if isinstance(root, Root) else Root(root)
    end = time.monotonic() + patience
    while True:
        try:
            return Bench(bench, found)
        except NoBench:
            if time.monotonic() >= end:
                raise
        time.sleep(0.02)


class Bench:
    """A running bench. Its ports belong to the thread that made it; close it, or use it in a ``with``."""

    def __init__(self, name: str, root: Root) -> None:
        #: Its name.
        self.name = name
        #: Where it lives.
        self.root = root
        config = iceoryx2.config.default()
        config.global_cfg.root_path = iceoryx2.Path.new(str(root.iceoryx2))
        config.global_cfg.prefix = iceoryx2.FileName.new(root.prefix)
        builder = iceoryx2.NodeBuilder.new().name(iceoryx2.NodeName.new("python")).config(config)
        # The signals of this process are its own.
        builder = builder.signal_handling_mode(iceoryx2.SignalHandlingMode.Disabled)
        self._node: Any = builder.create(iceoryx2.ServiceType.Ipc)
        verifier = iceoryx2.AttributeVerifier.new().require(
            iceoryx2.AttributeKey.new(SCHEMA_ATTRIBUTE), iceoryx2.AttributeValue.new(str(SCHEMA))
        )
        states = self._builder("state").publish_subscribe(iceoryx2.Slice[ctypes.c_uint64])
        self._states: Any = self._opened(lambda: states.open_with_attributes(verifier))
        if not self.is_alive():
            raise self._no_bench()
        documents = self._builder("document").publish_subscribe(iceoryx2.Slice[ctypes.c_uint8]).user_header(DocumentHead)
        # Before the statuses that name them.
        self._documents: Any = self._opened(lambda: documents.open().subscriber_builder().create())
        status = self._builder("status").publish_subscribe(BenchStatus)
        self._statuses: Any = self._opened(lambda: status.open().subscriber_builder().create())
        self._texts: dict[int, str] = {}
        self._status: BenchStatus | None = None
        self._newest: Any = None
        self._last: Block | None = None
        self._events: Any = None
        self._client: Any = None
        self._bell: Any = None

    def _no_bench(self) -> NoBench:
        return NoBench(f"no bench '{self.name}' is running under {self.root.path}")

    def _builder(self, topic: str) -> Any:
        return self._node.service_builder(iceoryx2.ServiceName.new(f"whirl/{self.name}/{topic}"))

    def _opened(self, open_it: Any) -> Any:
        """Opens something, with iceoryx2's refusals in our words. What a bench that is just starting has not made yet is waited for."""
        end = time.monotonic() + _STARTING
        while True:
            try:
                return open_it()
            except Exception as error:
                told = f"{type(error).__name__}: {error}"
                is_in_flux = any(word in told for word in ("DoesNotExist", "Hangs", "MarkedForDestruction", "Corrupted"))
                if not is_in_flux or time.monotonic() > end:
                    raise self._told(told) from error
            time.sleep(0.01)

    def _told(self, told: str) -> WhirlError:
        """A refusal of iceoryx2 in our words."""
        if "DoesNotExist" in told:
            return self._no_bench()
        if "Exceeds" in told:
            return WhirlError(f"bench '{self.name}' is full: `whirl status` lists who is attached")
        if any(word in told for word in ("IncompatibleAttributes", "VersionMismatch", "Corrupted", "IncompatibleTypes")):
            return WhirlError(
                f"bench '{self.name}' was started by another version of whirl or of iceoryx2 ({told}): this package speaks "
                f"schema {SCHEMA} over iceoryx2 0.10"
            )
        return WhirlError(f"bench '{self.name}': {told}")

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Leaves the bench. Blocks that are kept stay readable."""
        for port in ("_newest", "_events", "_client", "_bell", "_documents", "_statuses", "_states", "_node"):
            setattr(self, port, None)

    def is_alive(self) -> bool:
        """Whether its process lives. Takes up to a millisecond."""
        for state in self._states.nodes:
            if isinstance(state, iceoryx2.NodeState.Alive):
                details = state[0].details
                if details is not None and details.name.as_str() == "sim":
                    return True
        return False

    def steps(self, timeout: float | None = None) -> Iterator[Block]:
        """Every step from now on, block by block, in order and without a gap as long as they are taken in time: two seconds' worth wait.

        :attr:`Block.lost` says how many steps were missed before a block, where that happened. Ends when the bench does.

        :param timeout: seconds without a step after which it ends too; ``None`` for never.
        """
        port = self._opened(lambda: self._states.subscriber_builder().create())
        return self._iterate(port, timeout)

    def _iterate(self, port: Any, timeout: float | None) -> Iterator[Block]:
        last: tuple[int, int] | None = None
        heard = looked = time.monotonic()
        while True:
            block = _received(port)
            if block is None:
                now = time.monotonic()
                if now - looked > _LOOK:
                    looked = now
                    if not self.is_alive() and not port.has_samples():
                        return
                if timeout is not None and now - heard > timeout:
                    return
                time.sleep(_NAP)
                continue
            run, first = int(block.run_id[0]), int(block.seq[0])
            block.lost = first - last[1] - 1 if last is not None and last[0] == run else 0
            last = (run, int(block.seq[-1]))
            yield block
            # So that a loop variable that is not kept does not keep the next one away.
            del block
            heard = time.monotonic()

    def latest(self, timeout: float = 3.0) -> Block:
        """The newest step, in memory of its own.

        :raises WhirlError: none comes in so many seconds.
        """
        if self._newest is None:
            builder = self._states.subscriber_builder().buffer_size(1)
            self._newest = self._opened(lambda: builder.create())
        end = time.monotonic() + timeout
        while True:
            block = _received(self._newest)
            if block is not None:
                self._last = Block(block.words[-1].copy())
                return self._last
            if self._last is not None and self.is_alive():
                # Nothing newer since the last call: a bench that stands, in lockstep or by the grace of its scheduler.
                return self._last
            if time.monotonic() > end:
                raise WhirlError(f"bench '{self.name}' sends nothing")
            time.sleep(_NAP)

    def _read_documents(self) -> None:
        while (sample := self._documents.receive()) is not None:
            head = sample.user_header().contents
            text = bytes(sample.payload().as_memory_view()).decode()
            self._texts[int(head.hash)] = text
            while len(self._texts) > 512:
                self._texts.pop(next(iter(self._texts)))

    @property
    def status(self) -> BenchStatus:
        """How the bench stands, as it told last: pace, poles, trip. All fields: `docs/book/src/protocol.md`."""
        end = time.monotonic() + 3.0
        while True:
            self._read_documents()
            while (sample := self._statuses.receive()) is not None:
                self._status = BenchStatus.from_buffer_copy(sample.payload().contents)
            if self._status is not None:
                return self._status
            if time.monotonic() > end:
                raise WhirlError(f"bench '{self.name}' does not tell how it stands: it may be stopped or overloaded")
            time.sleep(_NAP)

    def _document(self, name: int) -> str:
        end = time.monotonic() + 3.0
        while name not in self._texts:
            self._read_documents()
            if time.monotonic() > end:
                raise WhirlError(f"bench '{self.name}': the document {name:016x} does not come")
            time.sleep(_NAP)
        return self._texts[name]

    @property
    def settings(self) -> dict[str, Any]:
        """The settings in force: ``speed``, ``trip``, ``ramp``, ``deadband`` a mass, and ``feedback`` as its file says it."""
        return _settings.read(self._document(self.status.settings))

    @property
    def rotor(self) -> dict[str, Any]:
        """The rotor, as its file says it."""
        return tomllib.loads(self._document(self.status.rotor))

    def events(self, follow: bool = False) -> Iterator[Event]:
        """What has happened, the last 64 things first.

        :param follow: whether to go on with what happens from now on, until the bench ends.
        """
        if self._events is None:
            events = self._builder("event").publish_subscribe(_EventMessage)
            self._events = self._opened(lambda: events.open().subscriber_builder().create())
        # What happened before comes within a tenth of a second.
        settle, looked = time.monotonic() + 0.3, time.monotonic()
        while True:
            sample = self._events.receive()
            if sample is not None:
                yield _event(sample.payload().contents)
                continue
            now = time.monotonic()
            if not follow and now > settle:
                return
            if now - looked > _LOOK:
                looked = now
                if not self.is_alive():
                    return
            time.sleep(0.01)

    def set(self, why: str = "", who: str | None = None, timeout: float = 5.0, **values: object) -> Answer:
        """Changes settings, all or none: ``bench.set(speed=3, kd=0.1, delay="off", why="bearing test")``.

        Keys are those of ``whirl set``; one with an index or a name, such as ``kd.2``, goes in ``**{"kd.2": 0.1}``. Values are dimensionless. Where
        somebody else changes something meanwhile, the change is made anew upon that.

        :raises Refused: the bench does not accept it, and says why. Nothing has changed then.
        :raises ValueError: no such key, or no such value.
        """
        while True:
            status = self.status
            text = _settings.changed(self._document(status.settings), values)
            request = Request(kind=1, base_revision=status.revision, settings=fnv(text.encode()))
            answer = self._ask(request, text.encode(), why, who, timeout)
            if not answer.outdated:
                return _accepted(answer)
            self._wait_for_revision(answer.revision, timeout)

    def _wait_for_revision(self, revision: int, timeout: float) -> None:
        end = time.monotonic() + timeout
        while self.status.revision < revision:
            if time.monotonic() > end:
                raise WhirlError(f"bench '{self.name}' does not tell its settings")
            time.sleep(_NAP)

    def note(self, text: str, timeout: float = 5.0) -> Answer:
        """Marks the present step with a note."""
        return _accepted(self._ask(Request(kind=4, text=_fitting(text, 240)), b"", "", None, timeout))

    def impulse(self, mass: int, vy: float = 0.0, vz: float = 0.0, why: str = "", timeout: float = 5.0) -> Answer:
        """Changes the velocity of a mass, counted from 0, at once."""
        request = Request(kind=2, mass=mass)
        request.impulse[0], request.impulse[1] = vy, vz
        return _accepted(self._ask(request, b"", why, None, timeout))

    def restart(self, why: str = "", timeout: float = 5.0) -> Answer:
        """Back to rest at tau = 0; a trip is over."""
        return _accepted(self._ask(Request(kind=3), b"", why, None, timeout))

    def _ask(self, request: Request, document: bytes, why: str, who: str | None, timeout: float) -> _AnswerMessage:
        if len(document) > MAX_DOCUMENT:
            raise ValueError(f"settings of {len(document)} bytes: expected at most {MAX_DOCUMENT}")
        if self._client is None:
            builder = self._builder("command").request_response(iceoryx2.Slice[ctypes.c_uint8], _AnswerMessage)
            service = self._opened(lambda: builder.request_header(Request).open())
            self._client = self._opened(lambda: service.client_builder().initial_max_slice_len(MAX_DOCUMENT).create())
            bell = self._opened(lambda: self._builder("wake").event().open())
            self._bell = self._opened(lambda: bell.notifier_builder().create())
        request.who = _fitting(who or f"python:{os.getpid()}", 32)
        request.why = _fitting(why, 120)
        loan = self._client.loan_slice_uninit(len(document))
        ctypes.memmove(loan.user_header_ptr, ctypes.byref(request), ctypes.sizeof(request))
        if document:
            ctypes.memmove(loan.payload_ptr, document, len(document))
        pending = loan.assume_init().send()
        self._bell.notify()
        end = time.monotonic() + timeout
        while True:
            response = pending.receive()
            if response is not None:
                return _AnswerMessage.from_buffer_copy(response.payload().contents)
            if time.monotonic() > end:
                raise WhirlError(f"bench '{self.name}' did not answer: it may be stopped or overloaded")
            time.sleep(0.0002)

    def controller(self) -> Controller:
        """Takes the place of the one controller outside that a bench can have: its settings have ``external`` then."""
        return Controller(self._builder, self._opened, self.is_alive, self.name)


def _received(port: Any) -> Block | None:
    """The next message of steps, as views of where it lies."""
    try:
        sample = port.receive()
    except Exception as error:
        if "ExceedsMaxBorrow" in f"{type(error).__name__}: {error}":
            raise WhirlError("two blocks are kept already: take a copy() of what shall stay longer") from error
        raise
    if sample is None:
        return None
    # iceoryx2's Python counts the bytes of a slice of a type of its own, and the elements of a plain one.
    count = sample.header.number_of_elements
    place = (ctypes.c_uint64 * count).from_address(sample.payload_ptr)
    # The sample goes back to the bench when the last view of it has gone.
    place._sample = sample
    return Block(np.frombuffer(place, dtype=np.uint64))


def _fitting(text: str, size: int) -> bytes:
    """As much of a text as fits, cut at a character."""
    return text.encode()[:size].decode(errors="ignore").encode()


def _text(raw: bytes) -> str:
    return raw.decode(errors="replace")


def _event(message: Any) -> Event:
    kind = KINDS[message.kind] if 0 < message.kind < len(KINDS) else f"kind {message.kind}"
    return Event(
        number=message.number,
        kind=kind,
        step=message.seq,
        tau=message.tau,
        who=_text(message.who),
        why=_text(message.why),
        text=_text(message.text),
        revision=message.revision,
        run_id=message.run_id,
    )


def _accepted(answer: _AnswerMessage) -> Answer:
    if not answer.accepted:
        raise Refused(_text(answer.reason))
    return Answer(revision=answer.revision, step=answer.applied_at_step, tau=answer.tau)
