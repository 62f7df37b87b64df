"""A controller outside the bench: readings in, commands out."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Iterator
from typing import Any

from ._root import WhirlError
from .messages import ControlCommand, Readings

#: How long to look for readings without a rest: a rest costs some 60 microseconds and more.
_SPIN = 0.0005


class Controller:
    """The one controller outside that a bench can have. Its place is free again when it is closed, or its process ends.

    >>> with bench.controller() as controller:          # doctest: +SKIP
    ...     for readings in controller.readings():
    ...         y, z, vy, vz = readings.readings[0]
    ...         controller.command(readings, [(-0.5 * y - 0.4 * vy, -0.5 * z - 0.4 * vz)])
    """

    def __init__(self, builder: Any, opened: Any, is_alive: Callable[[], bool], bench: str) -> None:
        self._is_alive = is_alive
        readings = builder("reading").publish_subscribe(Readings)
        commands = opened(lambda: builder("control").publish_subscribe(ControlCommand).open())
        try:
            self._commands: Any = commands.publisher_builder().create()
        except Exception as error:
            if "Exceeds" in f"{type(error).__name__}: {error}":
                raise WhirlError(f"bench '{bench}' is controlled from outside already") from error
            raise
        self._readings: Any = opened(lambda: readings.open().subscriber_builder().create())
        self._command = ControlCommand()

    def __enter__(self) -> Controller:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Gives its place free; the law of the bench takes over."""
        self._commands = self._readings = None

    def readings(self, timeout: float | None = None) -> Iterator[Readings]:
        """Readings as they come, to be answered by :meth:`command`; of several that wait the newest, as the others would be answered too
        late. Ends when the bench does.

        :param timeout: seconds without readings after which it ends too.
        """
        heard = looked = time.monotonic()
        while True:
            newest = None
            while (sample := self._readings.receive()) is not None:
                newest = Readings.from_buffer_copy(sample.payload().contents)
            if newest is not None:
                yield newest
                heard = looked = time.monotonic()
                continue
            now = time.monotonic()
            if now - heard > _SPIN:
                time.sleep(0.00002)
            if timeout is not None and now - heard > timeout:
                return
            if now - looked > 0.5:
                looked = now
                if not self._is_alive():
                    return

    def command(self, readings: Readings, commands: list[tuple[float, float]]) -> None:
        """Answers readings with the control ``(uy, uz)`` at every control bearing, in w0^2 e_t."""
        answer = self._command
        answer.run_id, answer.number, answer.wall_ns = readings.run_id, readings.number, time.time_ns()
        for place, (uy, uz) in zip(answer.command, commands):
            place[0], place[1] = uy, uz
        loan = self._commands.loan_uninit()
        ctypes.memmove(loan.payload_ptr, ctypes.byref(answer), ctypes.sizeof(answer))
        loan.assume_init().send()
