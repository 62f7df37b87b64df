"""Where benches are: the folder, and the prefix of the names of their shared memory."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

# The longest path that iceoryx2 can be given: see crates/wire/src/short_path.rs.
_LONGEST = 107 - 1 - 23 - 39 - 6
_PLAIN = set(b"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+@")


class WhirlError(Exception):
    """What can go wrong between a program and a bench, in words."""


class NoBench(WhirlError):
    """Nobody simulates under this name."""


def fnv(data: bytes) -> int:
    """FNV-1a, 64 bits: the name of a document, and of a root."""
    value = 0xCBF29CE484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value


class Root:
    """The folder under which one user's benches live.

    :param path: the folder; without one, that of the environment: ``WHIRL_ROOT``, or ``whirl`` in ``XDG_RUNTIME_DIR``, or
        ``whirl-UID`` in the temporary folder (``TMPDIR``, else ``/tmp``).
    """

    def __init__(self, path: str | os.PathLike[str] | None = None) -> None:
        found = Path(path) if path is not None else _from_environment()
        if not found.is_absolute():
            raise WhirlError(f"{found}: expected an absolute path")
        #: The folder, links followed to their end.
        self.path = Path(os.path.realpath(found))
        value = fnv(os.fsencode(self.path))
        #: What the names of its shared memory begin with.
        self.prefix = f"whirl_{value:016x}_"
        self._value = value

    @property
    def iceoryx2(self) -> Path:
        """The folder that iceoryx2 is given as its root: of a root whose path is too long, by way of a link that benches make.

        :raises NoBench: there is no such link, and so no bench.
        """
        return _short(self.path, self._value) / "iceoryx2"

    def __repr__(self) -> str:
        return f"Root({str(self.path)!r})"


def _from_environment() -> Path:
    named = os.environ.get("WHIRL_ROOT")
    if named:
        return Path(named)
    runtime = os.environ.get("XDG_RUNTIME_DIR")
    if runtime and Path(runtime).is_dir():
        return Path(runtime) / "whirl"
    return Path(tempfile.gettempdir()) / f"whirl-{os.geteuid()}"


def _is_plain(path: Path) -> bool:
    name = os.fsencode(path)
    return len(name) <= _LONGEST and set(name) <= _PLAIN


def _short(root: Path, value: int) -> Path:
    """The name of a root that iceoryx2 can use: itself, or the link that a bench has made for it."""
    if _is_plain(root / "iceoryx2"):
        return root
    user = f"whirl-{os.geteuid()}"
    for folder in (Path("/tmp") / user, Path(tempfile.gettempdir()) / user):
        for turn in range(1000):
            link = folder / f"{(value + turn) & 0xFFFFFF:06x}"
            if not link.is_symlink():
                break
            if os.readlink(link) == str(root):
                return link
    raise NoBench(f"no bench is running under {root}: its short name is missing")
