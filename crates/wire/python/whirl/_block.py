"""Steps as NumPy arrays that lie where the bench wrote them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .messages import CHANNELS, FLAGS, WORDS, Channel

_BY_NAME = {channel.name: channel for channel in CHANNELS}
_FLAGS_PLACE = _BY_NAME["flags"].place


class Block:
    """Steps that were sent together, a row each.

    Its arrays are views: nothing is copied, and what the bench wrote stays in place as long as one of them is kept. Two blocks can be kept
    at once; of what shall stay longer, take a :meth:`copy`.

    A channel of which there is one has one number a step; one of masses, sensors or further control bearings has a row a step and a
    column for each, counted from 0.
    """

    def __init__(self, words: NDArray[np.uint64], lost: int = 0) -> None:
        told = int(words[_FLAGS_PLACE])
        #: How many masses, sensors and control bearings there are.
        self.masses, self.sensors, self.bearings = told >> 32 & 0xFFFF, told >> 48 & 0xFF, (told >> 56) + 1
        self._counts = {"once": 1, "mass": self.masses, "sensor": self.sensors, "further": self.bearings - 1}
        self._first: dict[str, int] = {}
        width = 0
        for scope, count in self._counts.items():
            self._first[scope] = width
            width += WORDS[scope] * count
        rows = len(words) // width
        #: The words, a row a step.
        self.words: NDArray[np.uint64] = words[: rows * width].reshape(rows, width)
        self._numbers: NDArray[np.float64] = self.words.view(np.float64)
        #: Steps between the block before and this one that this reader has missed.
        self.lost = lost

    def __len__(self) -> int:
        return len(self.words)

    def __repr__(self) -> str:
        return f"Block({len(self)} steps from {self.seq[0]} on, {self.masses} masses, lost {self.lost})"

    def copy(self) -> Block:
        """The same, in memory of its own."""
        return Block(self.words.reshape(-1).copy(), self.lost)

    def channel(self, name: str) -> NDArray[Any]:
        """A channel by its name in `docs/book/src/protocol.md`: ``tau``, ``y``, ``uy_commanded`` ..."""
        try:
            row: Channel = _BY_NAME[name]
        except KeyError:
            raise KeyError(f"no channel {name!r}: there are {', '.join(_BY_NAME)}") from None
        source: NDArray[Any] = self._numbers if row.is_number else self.words
        first, each = self._first[row.scope] + row.place, WORDS[row.scope]
        if row.scope == "once":
            return source[:, first]
        return source[:, first : first + each * self._counts[row.scope] : each]

    def columns(self) -> dict[str, NDArray[Any]]:
        """Every channel under its name in files, ``y1`` and so on: what a data frame can be made of. Views, as all arrays here."""
        made: dict[str, NDArray[Any]] = {}
        for row in CHANNELS:
            data = self.channel(row.name)
            if row.scope == "once":
                made[row.name] = data
                continue
            offset = 2 if row.scope == "further" else 1
            for index in range(self._counts[row.scope]):
                made[f"{row.name}{index + offset}"] = data[:, index]
        return made

    def has(self, flag: str) -> NDArray[np.bool_]:
        """Whether a flag is set, step by step: ``tripped``, ``late``, ``saturated``, ``external``, ``held``."""
        found: NDArray[np.bool_] = (self.words[:, _FLAGS_PLACE] & np.uint64(FLAGS[flag])) != 0
        return found

    def contact(self, mass: int) -> NDArray[np.bool_]:
        """Whether a mass, counted from 0, presses on its bearing."""
        found: NDArray[np.bool_] = (self.words[:, _FLAGS_PLACE] >> np.uint64(mass) & np.uint64(1)) != 0
        return found

    @property
    def run_id(self) -> NDArray[np.uint64]:
        """Which run of which process."""
        return self.channel("run_id")

    @property
    def seq(self) -> NDArray[np.uint64]:
        """Number of the step since the process started."""
        return self.channel("seq")

    @property
    def wall_ns(self) -> NDArray[np.uint64]:
        """Wall clock when the step was due, nanoseconds since 1970."""
        return self.channel("wall_ns")

    @property
    def revision(self) -> NDArray[np.uint64]:
        """Revision of the settings that the step was made with."""
        return self.channel("revision")

    @property
    def tau(self) -> NDArray[np.float64]:
        """Dimensionless time."""
        return self.channel("tau")

    @property
    def angle(self) -> NDArray[np.float64]:
        """Spin angle in radians, unwrapped."""
        return self.channel("angle")

    @property
    def speed(self) -> NDArray[np.float64]:
        """Spin speed R."""
        return self.channel("speed")

    @property
    def y(self) -> NDArray[np.float64]:
        """Displacement along y, a column a mass, in e_t."""
        return self.channel("y")

    @property
    def z(self) -> NDArray[np.float64]:
        """Displacement along z, a column a mass, in e_t."""
        return self.channel("z")

    @property
    def vy(self) -> NDArray[np.float64]:
        """Velocity along y, a column a mass, in w0 e_t."""
        return self.channel("vy")

    @property
    def vz(self) -> NDArray[np.float64]:
        """Velocity along z, a column a mass, in w0 e_t."""
        return self.channel("vz")

    @property
    def uy(self) -> NDArray[np.float64]:
        """Control that the first control bearing delivers along y, in w0^2 e_t."""
        return self.channel("uy")

    @property
    def uz(self) -> NDArray[np.float64]:
        """Control that the first control bearing delivers along z, in w0^2 e_t."""
        return self.channel("uz")
